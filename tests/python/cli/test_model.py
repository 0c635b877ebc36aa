# SPDX-License-Identifier: Apache-2.0
"""``condyle model`` on the example in the documentation: what it prints, what it writes, what it refuses."""

import json
from pathlib import Path

import numpy as np
import pytest

from condyle._core import io

EXAMPLE = Path(__file__).parents[3] / "docs" / "examples" / "pendulum.json"
TIMES = 0.02 * np.arange(26)
LOADS = """<OpenSimDocument Version="40000"><ExternalLoads><objects>
<ExternalForce name="pull"><applied_to_body>lower</applied_to_body>
<force_identifier>f_v</force_identifier><point_identifier>f_p</point_identifier>
</ExternalForce></objects><datafile>pull.sto</datafile></ExternalLoads></OpenSimDocument>"""


@pytest.fixture
def swing(tmp_path):
    """A motion of the example, in degrees: the elbow held near 60, the shoulder swings."""
    data = np.stack([20 + 15 * np.sin(6 * TIMES), 60 + 5 * np.cos(5 * TIMES)], axis=1)
    names = ["shoulder_flexion", "elbow_flexion"]
    io.write_motion(io.make_motion("swing", names, TIMES, data, True), tmp_path / "swing.sto")
    return tmp_path / "swing.sto"


@pytest.fixture
def pull(tmp_path):
    """A load on the forearm that no muscle holds after half of the time."""
    data = np.zeros((len(TIMES), 6))
    data[:, 1] = np.where(TIMES > 0.25, -4000.0, -10.0)
    data[:, 3:] = [0.3, 0.8, 0.0]
    names = [f"f_{kind}{axis}" for kind in "vp" for axis in "xyz"]
    io.write_motion(io.make_motion("pull", names, TIMES, data, None), tmp_path / "pull.sto")
    (tmp_path / "pull.xml").write_text(LOADS, encoding="utf-8")
    return tmp_path / "pull.xml"


def table(file):
    """Columns by name, without time."""
    motion = io.read_motion(file, False)
    return dict(zip(motion.names, np.asarray(motion.data).T, strict=True))


def test_check_says_what_a_model_holds(condyle, tmp_path):
    model = json.loads(EXAMPLE.read_text(encoding="utf-8"))
    frame = {"body": "upper"}
    model["wraps"].append({"name": "egg", "kind": "sphere", "frame": frame, "radius": 0.01})
    model["muscles"][0]["path"]["wraps"].append({"wrap": "egg"})
    model["contact_surfaces"] = [{"name": "cup", "frame": frame, "mesh": "cup.stl"}]
    model["not_supported"] = ["controllers: a, b, c, d, e, f, g, h, i, j"]
    model["coordinates"][0] |= {"locked": True}
    (tmp_path / "arm.json").write_text(json.dumps(model), encoding="utf-8")
    done = condyle("model", "check", "arm.json", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == [
        "arm.json: model 'double pendulum' from written by hand: an upper arm and a forearm in the plane z = 0, "
        "one muscle over both joints",
        "2 bodies, 2 joints, 2 coordinates, 1 springs, 1 muscles, 2 wrapping surfaces, 1 contact surfaces; 3.1 kg",
        "balanced by muscles: elbow_flexion",
        "force-dependent: none",
        "locked: shoulder_flexion",
        "past surfaces that need path snapshots (condyle opensim paths): 1 paths: flexor",
        "contact surfaces without their file here: cup",
        "left out or changed when it was made:",
        "  - controllers: a, b, c, d, e, f, g, h and 2 more",
    ]
    told = json.loads(condyle("model", "check", "arm.json", "--json", folder=tmp_path).stdout)
    assert told["counts"]["muscles"] == 1
    assert told["total_mass"] == pytest.approx(3.1)


def test_check_finds_what_recruitment_would_trip_over(condyle, tmp_path):
    model = json.loads(EXAMPLE.read_text(encoding="utf-8"))
    model["coordinates"][0] |= {"balanced_by": "muscles"}
    model["muscles"][0]["path"]["points"][0] = {"body": "upper", "location": [0.03, 0, 0]}
    model["muscles"][0]["tendon_slack_length"] = 0.5
    (tmp_path / "arm.json").write_text(json.dumps(model), encoding="utf-8")
    done = condyle("model", "check", "arm.json", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-2:] == [
        "look at: balanced by muscles, but none has a moment arm: shoulder_flexion",
        "look at: muscles without strength (fibres too short or too long): flexor",
    ]


def test_analyse_writes_tables_and_where_they_come_from(condyle, swing, tmp_path):
    run = ("model", "analyse", EXAMPLE, swing, "--from", "0.1", "--to", "0.4", "-o")
    done = condyle(*run, "out", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    out = tmp_path / "out"
    assert sorted(file.name for file in out.iterdir()) == [
        "activities.sto", "generalised_forces.sto", "muscle_forces.sto", "muscle_lengths.sto",
        "residuals.sto", "summary.json",
    ]  # fmt: skip
    forces, muscles = table(out / "generalised_forces.sto"), table(out / "muscle_forces.sto")
    assert list(forces) == ["shoulder_flexion_moment", "elbow_flexion_moment"]
    assert len(muscles["flexor"]) == 16
    assert (muscles["flexor"] > 0).all()
    # The forearm is held up against gravity: m g l sin of some 75 degrees, and a little inertia.
    assert 0.5 < forces["elbow_flexion_moment"].mean() < 1.3 * 9.81 * 0.12 * 1.3
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert summary["status"] == {"converged": 16}
    assert summary["failed"] == []
    assert summary["inputs"]["motion"]["name"] == "swing.sto"
    assert len(summary["inputs"]["model"]["sha256"]) == 64
    assert summary["settings"]["criterion"] == 3.0
    assert str(tmp_path) not in (out / "summary.json").read_text(encoding="utf-8")
    again = condyle(*run, "b", "--threads", "1", folder=tmp_path)
    assert again.returncode == 0
    for file in out.iterdir():
        assert file.read_bytes() == (tmp_path / "b" / file.name).read_bytes()


def test_loads_out_of_reach_are_loud(condyle, swing, pull, tmp_path):
    run = ("model", "analyse", EXAMPLE, swing, "--loads", pull, "-o", tmp_path / "out")
    done = condyle(*run)
    assert done.returncode == 1
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    bad = summary["status"]["infeasible"]
    assert bad == len(summary["failed"])
    assert 10 <= bad < 26
    assert "elbow_flexion" in summary["failed"][0]["message"]
    assert f"muscle forces were not found at {bad} of 26 time frames:" in done.stderr
    assert f"and {bad - 8} more" in done.stderr
    assert summary["inputs"]["external_loads_table"]["name"] == "pull.sto"
    done = condyle(*run, "--reserve", "5000", "--criterion", "min_max", "--strength", "constant")
    assert done.returncode == 0, done.stderr
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert summary["status"] == {"converged": 26}
    assert summary["largest_reserve"]["name"] == "elbow_flexion"
    assert list(table(tmp_path / "out" / "reserves.sto")) == ["elbow_flexion_moment"]


def test_a_picture_of_a_posture_and_of_a_motion(condyle, swing, pull, tmp_path):
    done = condyle("model", "picture", EXAMPLE, "-o", "still.png", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    done = condyle("model", "picture", EXAMPLE, swing, "--at", "0.2", "--loads", pull, folder=tmp_path)  # fmt: skip
    assert done.returncode == 0, done.stderr
    for name in ("still.png", "model.png"):
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["check", "none.json"], "none.json: cannot be opened for reading"),
        (["check", "broken.json"], "broken.json: muscle 'flexor': max_isometric_force is 0 N; it must be above 0"),
        (["analyse", "arm.json", "none.sto", "-o", "x"], "none.sto"),
        (["analyse", "arm.json", "swing.sto", "-o", "x", "--criterion", "cubic"], "--criterion cubic: must be a power"),
        (["analyse", "arm.json", "swing.sto", "-o", "x", "--from", "7"], "no time frame from 7 s; it has 0 to 0.5 s"),
        (["analyse", "arm.json", "rad.sto", "-o", "x"], "are these degrees, with inDegrees=no in the header?"),
        (["picture", "arm.json", "swing.sto"], "swing.sto: --at T says which time of the motion is drawn"),
        (["picture", "arm.json", "--at", "0.2"], "--at, --loads and --paths go with a MOTION.sto"),
        (["picture", "arm.json", "swing.sto", "--at", "0.7"], "no time frame at 0.7 s; the trial has 0 to 0.5 s"),
        (["picture", "arm.json", "--meshes", "nowhere"], "meshes nowhere: must be a folder, NAME=FILE"),
    ],
)  # fmt: skip
def test_mistakes_end_in_one_line(swing, tmp_path, monkeypatch, capsys, arguments, words):
    from condyle.cli import app

    text = EXAMPLE.read_text(encoding="utf-8")
    (tmp_path / "arm.json").write_text(text, encoding="utf-8")
    broken = text.replace('"max_isometric_force": 900', '"max_isometric_force": 0')
    (tmp_path / "broken.json").write_text(broken, encoding="utf-8")
    wrong = swing.read_text(encoding="utf-8").replace("inDegrees=yes", "inDegrees=no")
    (tmp_path / "rad.sto").write_text(wrong, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.argv", ["condyle", "model", *arguments])
    with pytest.raises(SystemExit) as ended:
        app.main()
    assert ended.value.code == 2
    said = capsys.readouterr().err
    assert words in said
    assert len(said.strip().splitlines()) == 1
    assert not (tmp_path / "x").exists()
