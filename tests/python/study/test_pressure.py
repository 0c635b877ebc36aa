# SPDX-License-Identifier: Apache-2.0
"""A law for pressures alone: the same load, carried by another law."""

from pathlib import Path

import numpy as np
import pytest

from condyle.contact import Derivatives
from condyle.errors import CondyleError
from condyle.study import Study
from condyle.study.context import StudyContext
from condyle.study.pressure import pressure_pose
from condyle.study.reporter import SilentReporter
from condyle.study.run_directory import RunDirectory
from condyle.study.stages import implant

#: A pose with some of everything, pressed in.
POSE = np.array([0.0071, 0.0404, 0.0003, 0.002, 0.01, -0.1])
POLYETHYLENE = {
    "kind": "thin_layer_logarithmic",
    "youngs_modulus_MPa": 463.0,
    "poissons_ratio": 0.46,
    "thickness_mm": 9.0,
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made: Path = tmp_path_factory.mktemp("runs") / "pressure"
    implant.run(context(made))
    return made


def context(folder: Path, **contact: object) -> StudyContext:
    study = Study.model_validate(
        {
            "name": "pressure",
            "implant": {"preset": "curved", "mesh_edge_mm": 1.0},
            "contact": {"evaluation": "exact", **contact},
        }
    )
    return StudyContext(study, RunDirectory(folder), 1, SilentReporter())


def test_without_a_law_for_pressures_nothing_moves(folder: Path) -> None:
    plain = context(folder)
    wrench = plain.reference.evaluate(POSE[None], Derivatives.none, 1).wrench[0]
    assert plain.pressure_contact is plain.reference
    assert pressure_pose(plain, POSE, wrench) is POSE


def test_a_law_for_pressures_carries_the_load_of_the_reference(folder: Path) -> None:
    both = context(folder, pressure_law=POLYETHYLENE)
    assert both.reference.law_name() == "linear_volume"
    assert both.pressure_contact.law_name() == "thin_layer_logarithmic"
    wrench = both.reference.evaluate(POSE[None], Derivatives.none, 1).wrench[0]
    load = wrench.sum(axis=0)
    assert load[1] > 500.0
    pose = pressure_pose(both, POSE, wrench)
    np.testing.assert_array_equal(pose[[0, 2, 4, 5]], POSE[[0, 2, 4, 5]])
    carried = both.pressure_contact.evaluate(pose[None], Derivatives.none, 1).wrench[0].sum(axis=0)
    # Tolerances of the static equilibrium.
    assert abs(carried[1] - load[1]) <= 1e-3 * load[1] + 0.01
    assert abs(carried[3] - load[3]) <= 1e-3 * abs(load[3]) + 0.0005
    # 25 times as stiff: the femur stands higher and presses harder on less.
    assert pose[1] > POSE[1] + 1e-4
    soft, hard = (
        np.concatenate(contact.face_pressures(at))
        for contact, at in ((both.reference, POSE), (both.pressure_contact, pose))
    )
    assert hard.max() > 2.0 * soft.max()
    assert (hard > 0).sum() < (soft > 0).sum()


def test_a_law_that_cannot_carry_the_load_is_named(folder: Path) -> None:
    soft = context(folder, pressure_law={"kind": "power", "coefficient": 1e5, "exponent": 1.0})
    wrench = soft.reference.evaluate(POSE[None], Derivatives.none, 1).wrench[0]
    with pytest.raises(
        CondyleError, match=r"contact.pressure_law \(power\): no pose carries \d+ N"
    ):
        pressure_pose(soft, POSE, wrench)
