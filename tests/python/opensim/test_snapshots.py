# SPDX-License-Identifier: Apache-2.0
import json

import numpy as np
import pytest
from forward_kinematics import placements, point_in_ground

from condyle.errors import InputDataError
from condyle.opensim import import_model, path_snapshots, write_snapshots
from condyle.opensim.library import load_model


def snapshot_length(entry, bodies, placed):
    points = [point_in_ground(placed, bodies[index], xyz) for index, *xyz in entry["points"]]
    return np.linalg.norm(np.diff(points, axis=0), axis=1).sum() + entry["arc_excess"]


@pytest.fixture
def motion(tmp_path, rng):
    """Twelve postures of the leg; pf_flex follows, knee_rot is locked and moved all the same."""
    names = ("hip_flex", "knee_flex", "knee_rot", "knee_shift")
    values = rng.uniform((-0.3, -0.3, -0.2, -0.02), (1.2, 1.4, 0.2, 0.02), (12, 4))
    file = tmp_path / "motion.csv"
    rows = np.column_stack([0.1 * np.arange(12), values])
    np.savetxt(
        file, rows, delimiter=",", header="time," + ",".join(names), comments="", fmt="%.17g"
    )
    return file, [dict(zip(names, row, strict=True)) for row in values]


def test_lengths_are_those_of_opensim(osim, models, motion):
    file, postures = motion
    snapshots = path_snapshots(models["leg"], file, which="all")
    model, loaded = import_model(models["leg"]), load_model(models["leg"])
    assert set(snapshots["paths"]) == {f["name"] for f in [*model["muscles"], *model["ligaments"]]}
    defaults = {c["name"]: c["default"] for c in model["coordinates"]}
    wrapped = 0
    for frame, posture in enumerate(postures):
        q = defaults | posture
        placed = placements(model, q)
        set_posture(osim, loaded, q)
        for name, entries in snapshots["paths"].items():
            force = loaded.model.getForceSet().get(name)
            path = getattr(osim, force.getConcreteClassName()).safeDownCast(force).getGeometryPath()
            length = snapshot_length(entries[frame], snapshots["bodies"], placed)
            # Sums of distances below a metre in double precision, over points that are held to bodies.
            assert length == pytest.approx(path.getLength(loaded.state), abs=1e-9), (name, frame)
            assert entries[frame]["arc_excess"] >= 0.0
            wrapped += entries[frame]["arc_excess"] > 1e-6
    assert wrapped > 10, "no path lay on a surface: the test says nothing of arcs"


def set_posture(osim, loaded, q):
    for coordinate in loaded.model.getCoordinateSet():
        coordinate.setLocked(loaded.state, False)
        if coordinate.getName() != "pf_flex":
            coordinate.setValue(loaded.state, q[coordinate.getName()], False)
    coupler = osim.CoordinateCouplerConstraint.safeDownCast(loaded.model.getConstraintSet().get(0))
    follows = 1.1 * coupler.getFunction().calcValue(osim.Vector(1, q["knee_flex"]))
    loaded.model.getCoordinateSet().get("pf_flex").setValue(loaded.state, follows, False)
    loaded.model.realizePosition(loaded.state)


def test_which_paths_are_taken(models, motion):
    file, _ = motion
    assert sorted(path_snapshots(models["leg"], file)["paths"]) == [
        "around",
        "over_ball",
        "through_ring",
    ]
    wrapped = path_snapshots(models["leg"], file, which="wrapped")["paths"]
    assert sorted(wrapped) == ["around", "over_ball", "over_post", "through_ring"]


def test_a_snapshot_is_stationary(models, motion):
    """Wrap points held to their bodies give dL/dq of the wrapped path: that is what snapshots are for."""
    file, postures = motion
    model = import_model(models["leg"])
    snapshots = path_snapshots(models["leg"], file)
    h, arms = 1e-3, []
    defaults = {c["name"]: c["default"] for c in model["coordinates"]}
    for frame, posture in enumerate(postures):
        entry = snapshots["paths"]["over_ball"][frame]
        if entry["arc_excess"] < 1e-6:
            continue
        moved = [defaults | posture | {"hip_flex": posture["hip_flex"] + s * h} for s in (-1, 0, 1)]
        held = [snapshot_length(entry, snapshots["bodies"], placements(model, q)) for q in moved]
        again = opensim_lengths(
            models["leg"], "over_ball", moved, file.with_name("moved.csv"), model
        )
        if abs(again[0] - 2 * again[1] + again[2]) > 10 * h**2:
            continue  # OpenSim's path jumps there: it has no derivative
        # Central differences: h²/6·L''' is 2e-7·O(1 m); OpenSim's wrap of a sphere is exact to 1e-7 m / h.
        arms.append((held[2] - held[0]) / (2 * h))
        assert arms[-1] == pytest.approx((again[2] - again[0]) / (2 * h), abs=2e-4)
    assert len(arms) > 3
    assert max(map(abs, arms)) > 0.01


def opensim_lengths(osim_file, name, postures, file, model):
    names = list(postures[0])
    rows = [[float(i), *(q[n] for n in names)] for i, q in enumerate(postures)]
    text = "\n".join(
        [",".join(["time", *names]), *(",".join(f"{v:.17g}" for v in row) for row in rows)]
    )
    file.write_text(text, encoding="utf-8")
    shots = path_snapshots(osim_file, file, which="wrapped")
    entries = shots["paths"][name]
    return [
        snapshot_length(entry, shots["bodies"], placements(model, q))
        for entry, q in zip(entries, postures, strict=True)
    ]


def test_degrees_and_paths_of_labels_are_understood(models, motion, tmp_path):
    file, postures = motion
    names = list(postures[0])
    labels = [f"/jointset/some/{n}/value" for n in names]
    turning = [1.0 if n == "knee_shift" or n != "hip_flex" else 180 / np.pi for n in names]
    rows = [
        "\t".join(repr(float(v)) for v in (0.1 * i, *np.array(list(q.values())) * turning))
        for i, q in enumerate(postures)
    ]
    head = ["motion", "version=1", "inDegrees=yes", "endheader", "\t".join(["time", *labels])]
    degrees = tmp_path / "motion.mot"
    degrees.write_text("\n".join([*head, *rows]), encoding="utf-8")
    # The knee's axes are splines, of a motion that OpenSim calls coupled and does not convert.
    found, expected = (path_snapshots(models["leg"], f)["paths"] for f in (degrees, file))
    for name, entries in expected.items():
        for a, b in zip(found[name], entries, strict=True):
            np.testing.assert_allclose(a["points"], b["points"], rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("none.sto", None, "none.sto: cannot be read"),
        ("bare.sto", "time\tknee_flex\n0\t0\n", "no line 'endheader'"),
        ("other.csv", "time,elbow\n0,0\n", "column elbow: no coordinate of leg.osim"),
        (
            "gap.csv",
            "time,knee_flex\n0,0\n0.1,\n",
            "line 3, column knee_flex: '' is not a finite number",
        ),
        ("short.csv", "time,knee_flex\n0\n", "line 2: 1 cells, must be 2"),
        ("back.csv", "time,knee_flex\n0,0\n0,1\n", "line 3: time does not ascend"),
        ("empty.csv", "time,knee_flex\n", "no table with a first column 'time'"),
    ],
)
def test_a_motion_that_does_not_fit_is_refused(models, tmp_path, name, text, words):
    if text is not None:
        (tmp_path / name).write_text(text, encoding="utf-8")
    with pytest.raises(InputDataError, match=words):
        path_snapshots(models["leg"], tmp_path / name)


def test_what_is_written_is_what_was_found(models, motion, tmp_path):
    snapshots = path_snapshots(models["leg"], motion[0])
    write_snapshots(tmp_path / "paths.json", snapshots)
    assert json.loads((tmp_path / "paths.json").read_text(encoding="utf-8")) == snapshots
    assert snapshots["times"] == pytest.approx(0.1 * np.arange(12))


def test_dm_lengths_are_those_of_the_oracle(osim, dm, tmp_path):
    oracle = dm / "oracles" / "DM_ngait_og1"
    lines = (oracle / "q.csv").read_text(encoding="utf-8").splitlines()
    rows = [1, 190, 350]
    file = tmp_path / "q.csv"
    file.write_text("\n".join([lines[0], *(lines[i] for i in rows)]), encoding="utf-8")
    shots = path_snapshots(dm / "model" / "DM.osim", file)
    assert len(shots["paths"]) == 84  # 75 strands and 9 muscles on ellipsoids
    model = import_model(dm / "model" / "DM.osim")
    lengths = {}
    for table in ("muscle_length", "ligament_length"):
        text = (oracle / f"{table}.csv").read_text(encoding="utf-8").splitlines()
        values = np.array([[float(v) for v in text[i].split(",")] for i in rows])
        lengths |= dict(zip(text[0].split(","), values.T, strict=True))
    for frame, i in enumerate(rows):
        q = dict(zip(lines[0].split(",")[1:], map(float, lines[i].split(",")[1:]), strict=True))
        placed = placements(model, q)
        for name, entries in shots["paths"].items():
            found = snapshot_length(entries[frame], shots["bodies"], placed)
            # The oracle's files carry 8 decimals; seen 5e-9.
            assert found == pytest.approx(lengths[name][frame], abs=1e-8), (name, i)
