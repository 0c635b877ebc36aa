# SPDX-License-Identifier: Apache-2.0
"""The study's simulator bears every built-in activity on a real knee replacement."""

import os
from dataclasses import replace
from pathlib import Path

import pytest

from condyle.activities import BUILT_IN, load_case
from condyle.study import Study, StudyRun
from condyle.study.simulate import simulate


@pytest.fixture(scope="module")
def dm(tmp_path_factory: pytest.TempPathFactory) -> StudyRun:
    named = os.environ.get("CONDYLE_DATA")
    data = Path(named) if named else Path(__file__).parents[3].parent / "shared" / "data"
    folder = data / "implants" / "dm"
    if not folder.is_dir():
        pytest.skip("no implants: set CONDYLE_DATA, or put shared/data beside the project")
    study = Study.model_validate(
        {
            "name": "dm",
            "implant": {
                "side_of_body": "right",
                "femur": str(folder / "femur_contact.stl"),
                "insert": str(folder / "insert_contact.stl"),
                "units": "m",
            },
            # No distance field to build for a handful of time frames.
            "contact": {"evaluation": "exact"},
            "simulator": {"ligaments": True},
        }
    )
    run = StudyRun(study, tmp_path_factory.mktemp("runs"), threads=1)
    run.run("implant")
    return run


@pytest.mark.parametrize("name", BUILT_IN)
def test_every_built_in_activity_is_borne_with_ligaments(dm: StudyRun, name: str) -> None:
    case = load_case(name)
    rows = slice(None, None, 25)
    few = replace(
        case,
        time=case.time[rows],
        flexion=case.flexion[rows],
        axial_force=case.axial_force[rows],
        ap_force=case.ap_force[rows],
        ie_torque=case.ie_torque[rows],
    )
    result = simulate(dm.context.reference, few, dm.context)
    assert set(result.status) == {"converged"}, result.summary
    # Ligaments pull the bones together: the contact carries what is applied, and more.
    assert (result.wrenches[:, :, 1].sum(axis=1) > few.axial_force - 10.0).all()
