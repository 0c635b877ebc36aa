# SPDX-License-Identifier: Apache-2.0
"""Models built through OpenSim's interface: what the core makes of them beside OpenSim's own library."""

import sys
from pathlib import Path

import numpy as np
import pytest
from dm_trials import OpenSimPosture

from condyle.model import MusculoskeletalModel, analyse_trial, make_trial

# The models are those that the import is tested on.
sys.path.append(str(Path(__file__).parents[1] / "opensim"))
NAMES = ("chain_of_plain_joints", "leg")
#: OpenSim's speeds at free and ball joints are angular velocities, ours rates of angles: the same where the
#: angles are zero and at rest.
ANGLES = ("free_joint_coord_0", "free_joint_coord_1", "free_joint_coord_2",
          "ball_joint_coord_0", "ball_joint_coord_1", "ball_joint_coord_2")  # fmt: skip
#: The one coordinate that turns two axes of its joint: while it moves, OpenSim's inverse dynamics has a term
#: too many (test_dm_oracles.py: test_energy_says_who_is_right_about_knee_l).
TWO_AXES = "knee_flex"


@pytest.fixture(scope="module", params=NAMES)
def pair(request, osim, tmp_path_factory):
    """A model of ours, read back from its file, and OpenSim's."""
    import osim_models

    from condyle.opensim import import_model, write_model

    folder = tmp_path_factory.mktemp(request.param)
    file = getattr(osim_models, request.param)(osim, folder / "model.osim")
    write_model(folder / "model.json", import_model(file))
    model = MusculoskeletalModel.read(folder / "model.json")
    posture = OpenSimPosture(osim, file, model.coordinate_names)
    for coordinate in posture.model.getCoordinateSet():
        coordinate.setLocked(posture.state, False)
    return model, posture


def motion(model, rng, frames):
    """Coordinates, rates and accelerations in general, within what both engines define alike."""
    shape = (frames, len(model.coordinate_names))
    q, qd, qdd = rng.uniform(-0.3, 1.2, shape), rng.normal(0, 2, shape), rng.normal(0, 20, shape)
    for name in model.coordinate_names:
        if name in ANGLES:
            q[:, model.coordinate(name)] = qd[:, model.coordinate(name)] = 0.0
    return q, qd, qdd


def follow(model, q):
    """Coupled coordinates where the core puts them."""
    from condyle._core.model import Kinematics

    return np.array([Kinematics(model.core, row).q for row in q])


def test_bodies_stand_where_opensim_puts_them(pair):
    model, posture = pair
    q = np.random.default_rng(61).uniform(-0.3, 1.2, (8, len(model.coordinate_names)))
    q = follow(model, q)
    found = analyse_trial(
        model, make_trial(model, np.arange(8.0), q), recruitment=False, muscles=False
    )
    for row in range(8):
        posture.set(q[row])
        for index, name in enumerate(model.body_names):
            there = posture.model.getBodySet().get(name).getTransformInGround(posture.state)
            p = [there.p().get(i) for i in range(3)]
            R = [[there.R().get(i, j) for j in range(3)] for i in range(3)]
            np.testing.assert_allclose(found.positions[row, index], p, rtol=0, atol=1e-10)
            np.testing.assert_allclose(found.rotations[row, index], R, rtol=0, atol=1e-10)


def test_inverse_dynamics_is_opensims(pair):
    model, posture = pair
    q, qd, qdd = motion(model, np.random.default_rng(62), 8)
    if TWO_AXES in model.coordinate_names:
        qd[:, model.coordinate(TWO_AXES)] = 0.0
    q = follow(model, q)
    coupled = [model.coordinate(name) for name in model.core.coupled_coordinates]
    # Ours give a coupled coordinate's load to the one that it follows; OpenSim's solver knows no coupling. Where
    # neither moves the loads of the others are the same.
    leading = [model.coordinate(TWO_AXES)] if coupled else []
    qd[:, coupled] = qdd[:, coupled] = 0.0
    qdd[:, leading] = 0.0
    ours = analyse_trial(
        model,
        make_trial(model, np.arange(8.0), q, qd, qdd),
        recruitment=False,
        muscles=False,
        ligaments=False,
    ).generalised_forces
    rest = np.setdiff1d(np.arange(q.shape[1]), [*coupled, *leading])
    assert len(rest) >= 3
    for row in range(8):
        theirs = posture.inverse_dynamics(q[row], qd[row], qdd[row])
        scale = np.abs(theirs).max()
        np.testing.assert_allclose(ours[row, rest], theirs[rest], rtol=0, atol=1e-8 * scale)
        if leading:
            slope = _slope(model, q[row], leading[0], coupled[0])
            together = theirs[leading[0]] + slope * theirs[coupled[0]]
            assert ours[row, leading[0]] == pytest.approx(together, abs=1e-6 * scale)


def _slope(model, q, leading, coupled):
    """d coupled / d leading, by central difference: exact to h² times a third derivative of some units."""
    h = 1e-4
    ends = []
    for step in (h, -h):
        shifted = q.copy()
        shifted[leading] += step
        ends.append(follow(model, shifted[None])[0, coupled])
    return (ends[0] - ends[1]) / (2 * h)


@pytest.mark.parametrize("pair", ["leg"], indirect=True)
def test_paths_without_wraps_have_opensims_lengths(pair):
    model, posture = pair
    q = follow(model, motion(model, np.random.default_rng(63), 12)[0])
    found = analyse_trial(
        model, make_trial(model, np.arange(12.0), q), recruitment=False, dynamics=False
    )
    forces = posture.model.getForceSet()
    compared = 0
    for names, lengths in (
        (model.muscle_names, found.muscle_lengths),
        (model.ligament_names, found.ligament_lengths),
    ):
        for index, name in enumerate(names):
            path = _path(posture, forces.get(name))
            if path.getWrapSet().getSize() > 0:
                continue
            for row in range(12):
                posture.set(q[row])
                assert lengths[row, index] == pytest.approx(path.getLength(posture.state), abs=1e-9)
                compared += 1
    assert compared >= 48
    assert any("over_ball" in text for text in found.wraps_ignored)


def _path(posture, force):
    kind = getattr(posture._osim, force.getConcreteClassName())
    return kind.safeDownCast(force).getGeometryPath()
