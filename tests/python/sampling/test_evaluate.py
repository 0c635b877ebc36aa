# SPDX-License-Identifier: Apache-2.0
"""Sampling a real contact: a cylinder (the femur) on two flat compartments of a right knee."""

from pathlib import Path

import numpy as np
import pytest
from rocking_knee import SIX_DOMAINS, rocking_contact, rocking_curves

from condyle.contact import Derivatives, MeshContact
from condyle.errors import InputDataError
from condyle.sampling import (
    Dataset,
    DomainTarget,
    Prescribed,
    ReferenceCurves,
    SamplingPlan,
    sample,
)
from condyle.sampling.equilibrium_protocol import check_solved
from condyle.sampling.evaluate import equilibrium_solver

PLAN = SamplingPlan((DomainTarget(2, 30, 5), DomainTarget(4, 17, 3)), seed=5, pilot=32)


@pytest.fixture(scope="module")
def contact() -> MeshContact:
    return rocking_contact()


@pytest.fixture(scope="module")
def curves() -> ReferenceCurves:
    return rocking_curves()


def test_samples_of_a_mesh_contact_carry_what_was_prescribed(
    contact: MeshContact, curves: ReferenceCurves, tmp_path: Path
) -> None:
    solver = equilibrium_solver(contact, max_depth=PLAN.max_depth, threads=1)
    report = sample(PLAN, curves, solver, tmp_path, contact.mesh_hashes())
    data = Dataset.read(tmp_path, identity=contact.mesh_hashes())
    assert report.samples == len(data) == 55
    wrenches = np.asarray(contact.evaluate(data.poses, Derivatives.none, 1).wrench)
    # The same code on the same poses; with stiffness its sums may run in another order.
    np.testing.assert_allclose(data.wrenches, wrenches, rtol=1e-9, atol=1e-9)
    off = np.abs(wrenches.sum(axis=1)[:, [1, 3]] - data.prescribed_loads)
    assert np.all(off <= 1e-3 * np.abs(data.prescribed_loads) + [0.01, 0.0005])
    # An independent bound of statics: the resultant of pressing sides lies between their edges.
    arm = np.abs(data.prescribed_loads[:, 1] / data.prescribed_loads[:, 0])
    assert 0.005 < arm.max() < 0.0213 + 0.009 + 0.003
    assert report.domains[1].rejected["no_equilibrium"] > 0
    assert all(1 < row.evaluations_per_accepted < 20 for row in report.domains)


def test_any_number_of_threads_gives_the_same_bytes_in_all_six_domains(
    contact: MeshContact, curves: ReferenceCurves, tmp_path: Path, content
) -> None:
    for threads in (1, 2, 4):
        solver = equilibrium_solver(contact, max_depth=SIX_DOMAINS.max_depth, threads=threads)
        sample(SIX_DOMAINS, curves, solver, tmp_path / str(threads), contact.mesh_hashes())
        assert content(tmp_path / str(threads)) == content(tmp_path / "1")


def test_an_answer_keeps_to_the_protocol_and_names_what_is_off(contact: MeshContact) -> None:
    prescribed = Prescribed(
        x=np.array([0.001, 0.001, 0.2]),
        Fy=np.array([300.0, 300.0, 300.0]),
        z=np.array([0.0004, 0.0004, 0.0004]),
        Mx=np.array([1.1, 25.0, 1.1]),
        theta_y=np.array([0.01, 0.01, 0.01]),
        theta_z=np.array([-0.3, -0.3, -0.3]),
    )
    solved = equilibrium_solver(contact, max_depth=2e-3)(prescribed)
    check_solved(solved, 3)
    assert solved.status.tolist() == ["converged", "no_equilibrium", "off_insert"]


def test_another_depth_limit_than_the_models_is_refused(contact: MeshContact) -> None:
    message = r"plausible_depth is 0\.002 m, the sampling plan's max_depth 0\.0015 m"
    with pytest.raises(InputDataError, match=message):
        equilibrium_solver(contact, max_depth=1.5e-3)
