# SPDX-License-Identifier: Apache-2.0
"""The command on a model of two bars in a file: what it writes, and what it says of mistakes."""

import importlib.util
import json

import numpy as np
import pytest

HAS_OPENSIM = importlib.util.find_spec("opensim") is not None
needs_opensim = pytest.mark.skipif(not HAS_OPENSIM, reason="the package opensim is not installed")


def body(name):
    return (
        f'<Body name="{name}"><mass>1.5</mass><mass_center>0 -0.2 0</mass_center>'
        "<inertia>0.1 0.02 0.1 0 0 0</inertia></Body>"
    )


def pin(name, parent, child, coordinate):
    return f"""<PinJoint name="{name}">
 <socket_parent_frame>up</socket_parent_frame><socket_child_frame>down</socket_child_frame>
 <coordinates><Coordinate name="{coordinate}"><default_value>0.1</default_value></Coordinate></coordinates>
 <frames>
  <PhysicalOffsetFrame name="up"><socket_parent>{parent}</socket_parent>
   <translation>0.1 -0.4 0</translation></PhysicalOffsetFrame>
  <PhysicalOffsetFrame name="down"><socket_parent>{child}</socket_parent>
   <translation>0 0.1 0.02</translation></PhysicalOffsetFrame>
 </frames></PinJoint>"""


def marker(name, frame, at):
    return (
        f'<Marker name="{name}"><socket_parent_frame>{frame}</socket_parent_frame>'
        f"<location>{at}</location></Marker>"
    )


MODEL = f"""<?xml version="1.0" encoding="UTF-8"?>
<OpenSimDocument Version="40000"><Model name="bars"><gravity>0 -9.81 0</gravity>
<BodySet name="bodyset"><objects>{body("upper")}{body("lower")}</objects></BodySet>
<JointSet name="jointset"><objects>
{pin("shoulder", "/ground", "/bodyset/upper", "swing")}{pin("elbow", "/bodyset/upper", "/bodyset/lower", "bend")}
</objects></JointSet>
<ForceSet name="forceset"><objects>
 <CoordinateActuator name="motor"><coordinate>swing</coordinate></CoordinateActuator>
</objects></ForceSet>
<MarkerSet name="markerset"><objects>
{marker("A", "/bodyset/upper", "0.1 0 0")}{marker("B", "/bodyset/upper", "0 -0.3 0.1")}
{marker("C", "/bodyset/lower", "0.1 -0.1 0")}{marker("D", "/bodyset/lower", "0 -0.3 0")}
</objects></MarkerSet></Model></OpenSimDocument>
"""


@pytest.fixture
def bars(tmp_path):
    file = tmp_path / "bars.osim"
    file.write_text(MODEL, encoding="utf-8")
    return file


def write_trc(file, names):
    """Five time frames of markers at rest, not where the model has them."""
    lines = [
        "PathFileType\t4\t(X/Y/Z)\tmarkers.trc",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits",
        f"100\t100\t5\t{len(names)}\tmm",
        "Frame#\tTime\t" + "\t\t\t".join(names),
        "",
    ]
    for i in range(5):
        cells = [f"{100 + 40 * k}\t{-300 - 100 * k}\t{10 * k}" for k in range(len(names))]
        lines.append("\t".join([str(i + 1), f"{0.01 * i}", *cells]))
    file.write_text("\n".join(lines), encoding="utf-8")
    return file


@needs_opensim
def test_import_writes_a_model_and_says_what_is_left_out(condyle, bars, tmp_path):
    done = condyle(
        "opensim", "import", bars, "--force-dependent", "be*", "--muscles", "swing", folder=tmp_path
    )
    assert done.returncode == 0, done.stderr
    assert "bars.json: 2 bodies, 2 joints, 2 coordinates" in done.stdout
    assert "force-dependent: bend" in done.stdout
    assert "balanced by muscles: swing" in done.stdout
    assert "forces of class CoordinateActuator: motor" in done.stdout
    model = json.loads((tmp_path / "bars.json").read_text(encoding="utf-8"))
    assert [c["role"] for c in model["coordinates"]] == ["driven", "force_dependent"]
    assert not (tmp_path / "opensim.log").exists()


@needs_opensim
def test_ik_and_paths_follow_each_other(condyle, bars, tmp_path):
    markers = write_trc(tmp_path / "rest.trc", ["A", "B", "C", "wand"])
    done = condyle("opensim", "ik", bars, markers, "-o", tmp_path / "q.sto", "--weight", "A=3")
    assert done.returncode == 0, done.stderr
    for words in (
        "5 time frames, 2 coordinates",
        "low-pass 6 Hz, zero-lag 4th-order Butterworth",
        "marker RMS before filtering: mean ",
        "in the file, not in the model: wand",
        "in the model, not measured: D",
    ):
        assert words in done.stdout
    values = np.loadtxt((tmp_path / "q.sto").read_text().split("endheader\n")[1].splitlines()[1:])
    assert values.shape == (5, 3)
    done = condyle("opensim", "paths", bars, tmp_path / "q.sto", "-o", tmp_path / "p.json")
    assert done.returncode == 0, done.stderr
    assert "0 paths at 5 time frames" in done.stdout


@needs_opensim
@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["import", "none.osim"], "none.osim: cannot be read: No such file"),
        (["import", "text.osim"], "text.osim: not an OpenSim model: it is no XML"),
        (["import", "loose.osim"], "loose.osim: body lower: the child of no joint"),
        (["import", "bars.osim", "--muscles", "knee*"], "'knee*' fits none of the model's coordinates: swing, bend"),
        (["ik", "bars.osim", "other.trc"], "none of its markers (X, Y) is in bars.osim (which has A, B, C, D)"),
        (["ik", "bars.osim", "none.trc"], "none.trc: no such file"),
        (["ik", "bars.osim", "good.trc", "--weight", "A"], "--weight A: must be NAME=WEIGHT"),
        (["ik", "bars.osim", "good.trc", "--filter-hz", "60"], "below half the sampling rate, 50 Hz"),
        (["paths", "bars.osim", "none.sto"], "none.sto: cannot be read"),
    ],
)  # fmt: skip
def test_mistakes_end_in_one_line(condyle, bars, tmp_path, arguments, words):
    (tmp_path / "text.osim").write_text("hello", encoding="utf-8")
    elbow = MODEL.index('<PinJoint name="elbow"')
    end = MODEL.index("</PinJoint>", elbow) + len("</PinJoint>")
    (tmp_path / "loose.osim").write_text(MODEL[:elbow] + MODEL[end:], encoding="utf-8")
    write_trc(tmp_path / "other.trc", ["X", "Y"])
    write_trc(tmp_path / "good.trc", ["A", "B", "C", "D"])
    done = condyle("opensim", *arguments, folder=tmp_path)
    assert done.returncode == 2
    assert words in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1


def test_without_the_package_the_command_says_how_to_install_it(
    condyle, bars, tmp_path, monkeypatch
):
    # Stands before any installed package of that name.
    (tmp_path / "opensim.py").write_text("raise ImportError(\"No module named 'opensim'\")\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=":")
    done = condyle("opensim", "import", bars)
    assert done.returncode == 2
    assert "needs the package opensim" in done.stderr
    assert "pip install 'condyle[opensim]'" in done.stderr
