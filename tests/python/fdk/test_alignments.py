# SPDX-License-Identifier: Apache-2.0
"""Alignments of an implant: what their words mean in both knees, and many of them simulated at once."""

import dataclasses
import math
import sys

import numpy as np
import pytest
from leg_model import write_leg

from condyle._core.common import clinical_kinematics, pose_from_transform, side_of_body
from condyle.errors import InputDataError
from condyle.fdk import (
    Alignment,
    TrialSimulationSettings,
    aligned_contacts,
    alignment_grid,
    alignments,
    simulate_alignments,
    simulate_trial,
    tibiofemoral_contact,
)
from condyle.model import (
    MuscleSettings,
    MusculoskeletalModel,
    joint_surfaces,
    read_trial,
    surface_files,
)

MUSCLES = MuscleSettings(reserve_moment=7.3)
SIDES = ("right", "left")
FLEXION, ADDUCTION, EXTERNAL, ANTERIOR, DISTRACTION, LATERAL = range(6)


class Leg:
    """A leg's files, read, and its knee's contact."""

    def __init__(self, folder, side):
        leg = write_leg(folder, side, frames=4)
        self.side, self.model = side, MusculoskeletalModel.read(leg.model)
        self.trial = read_trial(self.model, leg.motion, external_loads=leg.loads)
        surfaces = surface_files(self.model, [leg.model])
        joint = joint_surfaces(self.model)
        self.contact = tibiofemoral_contact(surfaces, joint, side, "exact", pressures=False).contact

    def run(self, placements, **options):
        return simulate_alignments(
            self.model, self.trial, [self.contact], placements, MUSCLES, **options
        )


@pytest.fixture(scope="module")
def legs(tmp_path_factory):
    return {side: Leg(tmp_path_factory.mktemp(side), side) for side in SIDES}


def bone_kinematics(alignment, side):
    """Of bones whose frames their components had, while the components stay together as they were."""
    X = alignment.tibial_motion(side) @ np.linalg.inv(alignment.femoral_motion(side))
    pose = pose_from_transform(np.ascontiguousarray(X[:3, :3]), np.ascontiguousarray(X[:3, 3]))
    return np.asarray(clinical_kinematics(pose[None], side_of_body(side)))[0]


#: What the bones do when a component is put elsewhere and the components stay together.
MEANINGS = {
    "femoral_varus_deg": (ADDUCTION, +1),
    "femoral_flexion_deg": (FLEXION, +1),
    # The femoral component faces outwards, and takes the tibia with it.
    "femoral_external_rotation_deg": (EXTERNAL, +1),
    "tibial_varus_deg": (ADDUCTION, +1),
    # The tibial component faces outwards on its bone: mated, the bone is left behind inwards.
    "tibial_external_rotation_deg": (EXTERNAL, -1),
    # The back of the insert is lower: mated, the bone's back comes up to the condyles.
    "tibial_posterior_slope_deg": (FLEXION, +1),
    "femoral_anterior_mm": (ANTERIOR, +1),
    "tibial_anterior_mm": (ANTERIOR, -1),
    "femoral_proximal_mm": (DISTRACTION, -1),
    "tibial_proximal_mm": (DISTRACTION, +1),
    "femoral_lateral_mm": (LATERAL, +1),
    "tibial_lateral_mm": (LATERAL, -1),
}


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("name", MEANINGS)
def test_words_mean_what_surgeons_mean_in_both_knees(name, side):
    which, sign = MEANINGS[name]
    moved = bone_kinematics(Alignment(**{name: 3.0}), side)
    amount = math.radians(3.0) if name.endswith("_deg") else 3e-3
    expected = np.zeros(6)
    expected[which] = sign * amount
    np.testing.assert_allclose(moved, expected, rtol=0, atol=1e-12)


def test_every_attribute_has_a_meaning_above():
    assert set(MEANINGS) == {field.name for field in dataclasses.fields(Alignment)}


@pytest.mark.parametrize("side", SIDES)
def test_motions_are_rigid_and_none_is_none(side):
    one = Alignment(femoral_varus_deg=2, femoral_flexion_deg=-5, tibial_varus_deg=1, tibial_lateral_mm=3,
                    tibial_external_rotation_deg=7, tibial_posterior_slope_deg=4)  # fmt: skip
    for X in (one.femoral_motion(side), one.tibial_motion(side)):
        np.testing.assert_allclose(X[:3, :3].T @ X[:3, :3], np.eye(3), rtol=0, atol=1e-14)
        assert np.linalg.det(X[:3, :3]) == pytest.approx(1.0)
        np.testing.assert_array_equal(X[3], [0, 0, 0, 1])
    np.testing.assert_array_equal(Alignment().tibial_motion(side), np.eye(4))
    np.testing.assert_array_equal(Alignment().femoral_motion(side), np.eye(4))
    assert one.sentence() == (
        "femoral varus 2°, femoral flexion -5°, tibial varus 1°, tibial external rotation 7°, tibial posterior slope "
        "4°, tibial lateral 3 mm"
    )
    assert Alignment().sentence() == "as placed"


def test_a_grid_has_every_combination_in_order():
    grid = alignment_grid(tibial_varus_deg=(-2, 0), femoral_proximal_mm=(1, 2, 3))
    assert [(a.tibial_varus_deg, a.femoral_proximal_mm) for a in grid] == [
        (-2, 1), (-2, 2), (-2, 3), (0, 1), (0, 2), (0, 3),
    ]  # fmt: skip
    with pytest.raises(
        InputDataError, match=r"alignment has no 'tibial_slope': must be one of femoral_varus_deg"
    ):
        alignment_grid(tibial_slope=(1.0,))


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"tibial_varus_deg": 20.5}, r"alignment: tibial_varus_deg is 20\.5: must be within ±20"),
        ({"femoral_lateral_mm": -31}, r"alignment: femoral_lateral_mm is -31: must be within ±20"),
        ({"femoral_flexion_deg": math.nan}, r"alignment: femoral_flexion_deg is nan: must be"),
    ],
)
def test_what_is_no_alignment_is_refused(values, said):
    with pytest.raises(InputDataError, match=said):
        Alignment(**values)


def test_the_femoral_component_moves_in_all_its_contacts_and_models_are_shared(legs):
    knee = legs["right"].contact
    trochlea = dataclasses.replace(knee, name="patellofemoral", fixed_body="hip", X_BF=np.array(
        [[0, -1, 0, 0.01], [1, 0, 0, 0.02], [0, 0, 1, -0.03], [0, 0, 0, 1]], dtype=float))  # fmt: skip
    other = dataclasses.replace(knee, name="elsewhere", moving_body="shank")
    alignment = Alignment(femoral_varus_deg=4, femoral_anterior_mm=2, tibial_posterior_slope_deg=3)
    one, two, three = aligned_contacts([knee, trochlea, other], alignment)
    assert one.model is knee.model and two.model is knee.model and three is other
    np.testing.assert_allclose(one.X_BF, knee.X_BF @ alignment.femoral_motion("right"), atol=1e-15)
    np.testing.assert_allclose(one.X_BT, knee.X_BT @ alignment.tibial_motion("right"), atol=1e-15)
    # One rigid body: what lies between two of its surfaces stays.
    np.testing.assert_allclose(
        np.linalg.inv(one.X_BF) @ two.X_BF, np.linalg.inv(knee.X_BF) @ trochlea.X_BF, atol=1e-14
    )
    np.testing.assert_array_equal(two.X_BT, trochlea.X_BT)
    with pytest.raises(
        InputDataError, match=r"no contact is called 'knee' \(there are: tibiofemoral\)"
    ):
        aligned_contacts([knee], alignment, "knee")


GRID = alignment_grid(tibial_varus_deg=(-2.0, 0.0, 2.0), tibial_posterior_slope_deg=(0.0, 4.0))


def arrays(simulation):
    return {
        field.name: value
        for field in dataclasses.fields(simulation)
        if isinstance(value := getattr(simulation, field.name), np.ndarray)
    }


def test_the_same_bytes_for_any_number_of_threads_and_in_order(legs):
    leg = legs["right"]
    one, many = leg.run(GRID, threads=1), leg.run(GRID, threads=5)
    assert [found.alignment for found in many] == list(GRID)
    for a, b in zip(one, many, strict=True):
        assert a.converged and b.converged and a.failure == b.failure == ""
        for name, values in arrays(a.simulation).items():
            assert values.tobytes() == arrays(b.simulation)[name].tobytes(), name
        assert [r.history for r in a.simulation.records] == [
            r.history for r in b.simulation.records
        ]
    # As placed is the trial as it always was; another alignment is something else.
    alone = simulate_trial(leg.model, leg.trial, [leg.contact], MUSCLES)
    for name, values in arrays(alone).items():
        assert values.tobytes() == arrays(one[2].simulation)[name].tobytes(), name
    fy = [found.simulation.wrenches[:, 0, :, 1].max(axis=0) for found in one]
    assert np.abs(fy[0] - fy[2]).max() > 1.0 and np.abs(fy[3] - fy[2]).max() > 0.1


def test_a_left_leg_does_what_the_right_one_does(legs):
    both = [
        legs[side].run([Alignment(tibial_varus_deg=2, tibial_external_rotation_deg=-4, femoral_lateral_mm=1.5)])[0]
        for side in SIDES
    ]  # fmt: skip
    a, b = (found.simulation.wrenches[:, 0, :, 1] for found in both)
    # Mirrored meshes differ by their files' rounding, the solver stops within 0.01 N.
    np.testing.assert_allclose(b, a, rtol=1e-3, atol=0.1)
    placed = legs["right"].run([Alignment()])[0].simulation.wrenches[:, 0, :, 1]
    assert np.abs(a - placed).max() > 2.0


def test_raising_the_insert_stretches_the_ligaments(legs):
    """Bones keep their attachments: a thicker insert leaves them less room."""
    low, high = legs["right"].run(alignment_grid(tibial_proximal_mm=(0.0, 1.0)))
    strains = [found.simulation.ligament_strains.max(axis=1) for found in (low, high)]
    assert (strains[1] > strains[0] + 1e-3).all()
    total = [found.simulation.wrenches[:, 0, :, 1].sum(axis=1) for found in (low, high)]
    assert (total[1] > total[0] + 5.0).all()
    # The insert has gone up by 1 mm, and with it the femoral component above the shank.
    up = high.simulation.q - low.simulation.q
    assert np.abs(up[:, legs["right"].model.coordinate("ty")]).max() < 1.2e-3


def test_one_that_fails_does_not_lose_the_others(legs, monkeypatch):
    def refuse(model, trial, contacts, *rest, **options):
        if abs(contacts[0].X_BT[1, 3] - moved[0].X_BT[1, 3]) < 1e-12:
            raise InputDataError("this one does not fit")
        return simulate_trial(model, trial, contacts, *rest, **options)

    leg, bad = legs["right"], Alignment(tibial_proximal_mm=1.7)
    moved = aligned_contacts([leg.contact], bad)
    monkeypatch.setattr(sys.modules[simulate_alignments.__module__], "simulate_trial", refuse)
    found = leg.run([Alignment(), bad, Alignment(tibial_varus_deg=1)], threads=3)
    assert [one.failure for one in found] == ["", "this one does not fit", ""]
    assert [one.simulation is None for one in found] == [False, True, False]
    assert [one.converged for one in found] == [True, False, True]
    with pytest.raises(
        InputDataError,
        match=r"none of 1 alignments can be simulated; tibial proximal 1\.7 mm: this one does not fit",
    ):
        leg.run([bad])


def test_numerics_that_do_not_work_out_are_a_status_of_that_one(legs):
    settings = TrialSimulationSettings()
    settings.solver.newton.max_iterations = 1
    settings.solver.max_substeps = 1
    settings.solver.softer_contact = []
    (found,) = legs["right"].run([Alignment(tibial_varus_deg=2)], settings=settings)
    assert found.failure == "" and found.simulation is not None
    assert not found.converged and found.simulation.not_converged > 0


def test_a_simulation_has_settings_of_its_own(legs):
    settings = TrialSimulationSettings()
    settings.chunk, settings.threads, settings.extrapolation = 2, 7, 0
    settings.solver.newton.force_tolerance = 0.003
    own = alignments._own_settings(settings)
    assert own.threads == 1 and settings.threads == 7
    assert (own.chunk, own.extrapolation) == (2, 0)
    assert own.solver.newton.force_tolerance == 0.003
    own.solver.newton.force_tolerance = 0.5
    assert settings.solver.newton.force_tolerance == 0.003
    with pytest.raises(InputDataError, match="threads -1: must be at least 0"):
        legs["right"].run(GRID, threads=-1)
    assert legs["right"].run([]) == ()
