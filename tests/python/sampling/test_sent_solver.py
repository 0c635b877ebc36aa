# SPDX-License-Identifier: Apache-2.0
"""A solver in other processes: pickled, made again once, and proved to give the same bits."""

import dataclasses
import multiprocessing
import pickle
from collections import OrderedDict
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from rocking_knee import SIX_DOMAINS, rocking_contact, rocking_curves

from condyle.contact import ContactModel
from condyle.errors import CondyleError, InputDataError
from condyle.fdk import StaticEquilibriumSettings
from condyle.sampling import DomainTarget, Prescribed, sample, sent_solver
from condyle.sampling.evaluate import ContactSolver, equilibrium_solver
from condyle.sampling.same_results import check_environment, environment, environment_of
from condyle.sampling.sent_solver import SentSolver, settings_from, values_of

PRESCRIBED = Prescribed(
    x=np.array([0.001, -0.0013, 0.0004]),
    Fy=np.array([310.0, 95.0, 720.0]),
    z=np.array([0.0004, -0.0002, 0.0]),
    Mx=np.array([1.1, -0.4, 2.3]),
    theta_y=np.array([0.01, -0.02, 0.015]),
    theta_z=np.array([-0.3, -0.55, -0.12]),
)


@pytest.fixture(scope="module")
def solver() -> ContactSolver:
    return equilibrium_solver(rocking_contact(), max_depth=2e-3, threads=2)


def test_a_sent_solver_answers_with_the_same_bits(solver: ContactSolver) -> None:
    sent = pickle.loads(pickle.dumps(solver))
    assert isinstance(sent, SentSolver)
    here, there = solver(PRESCRIBED), sent(PRESCRIBED)
    assert set(here.status.tolist()) == {"converged"}
    assert np.array_equal(here.poses, there.poses)
    assert np.array_equal(here.wrenches, there.wrenches)
    assert np.array_equal(here.evaluations, there.evaluations)


def test_a_process_makes_a_solver_once_however_often_it_is_sent(solver: ContactSolver) -> None:
    content = pickle.dumps(solver)
    made = [pickle.loads(content)._solver() for _ in range(3)]
    assert made[0] is made[1] is made[2] is not solver


def test_a_process_keeps_two_solvers(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[str] = []

    def make(self: SentSolver) -> object:
        made.append(self.content.decode())
        return object()

    monkeypatch.setattr(SentSolver, "_make", make)
    monkeypatch.setattr(sent_solver, "_made", OrderedDict())
    for name in ("a", "b", "a", "c", "c", "b", "a"):
        SentSolver(name.encode(), {})._solver()
    assert made == ["a", "b", "c", "a"]


def test_settings_travel(solver: ContactSolver) -> None:
    settings = StaticEquilibriumSettings()
    settings.max_iterations = 7
    settings.moment_tolerance = 3.7e-4
    settings.touch.light_load = 4.3
    again = settings_from(values_of(settings))
    assert (again.max_iterations, again.moment_tolerance) == (7, 3.7e-4)
    assert again.touch.light_load == 4.3
    assert values_of(again) == values_of(settings) != values_of(StaticEquilibriumSettings())
    # And they have their effect there.
    strict = StaticEquilibriumSettings()
    strict.force_tolerance = strict.moment_tolerance = 1e-9
    strict.force_relative_tolerance = strict.moment_relative_tolerance = 1e-9
    there = pickle.loads(pickle.dumps(ContactSolver(rocking_contact(), settings=strict, threads=1)))
    assert np.all(there(PRESCRIBED).evaluations > solver(PRESCRIBED).evaluations)


def test_processes_give_the_bytes_of_this_one(
    solver: ContactSolver, tmp_path: Path, content
) -> None:
    plan = dataclasses.replace(SIX_DOMAINS, targets=(DomainTarget(4, 17, 3), DomainTarget(6, 8, 2)))
    sample(plan, rocking_curves(), solver, tmp_path / "here", {})
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(2, mp_context=spawn) as pool:
        sample(plan, rocking_curves(), solver, tmp_path / "pool", {}, executor=pool)
    assert content(tmp_path / "pool") == content(tmp_path / "here")


def test_a_model_that_cannot_travel_is_named() -> None:
    class Local(ContactModel):
        pass

    with pytest.raises(InputDataError, match="the contact model Local cannot be sent to another"):
        sent_solver.packed(Local.__new__(Local), None)


def test_other_versions_and_other_digits_are_refused_by_name(solver: ContactSolver) -> None:
    found = environment_of(solver)
    check_environment(found, found, "worker a")
    check_environment(environment(), found, "worker a")  # not asked yet what the solver answers
    message = (
        r"^worker a: numpy is 1\.0, 2\.0 where sampling was started; .*install numpy 2\.0 there"
    )
    with pytest.raises(CondyleError, match=message):
        check_environment({**found, "numpy": "1.0"}, {**found, "numpy": "2.0"}, "worker a")
    for name, what in (("arithmetic", "NumPy"), ("solver", "the contact model")):
        with pytest.raises(CondyleError, match=f"worker a: {what} gives other last digits"):
            check_environment({**found, name: "f00"}, found, "worker a")


def test_a_worker_of_another_version_refuses_before_its_first_chunk(solver: ContactSolver) -> None:
    arrived = pickle.loads(pickle.dumps(solver))
    other = SentSolver(arrived.content + b"other", {**arrived.environment, "condyle": "99.1"})
    with pytest.raises(CondyleError, match=r"worker process \d+ on .*: condyle is .*, 99\.1 where"):
        other(PRESCRIBED)


def test_the_digest_of_answers_knows_one_model_from_another(solver: ContactSolver) -> None:
    stiffer = ContactSolver(rocking_contact(integration="femur"), threads=1)
    assert environment_of(stiffer)["solver"] != environment_of(solver)["solver"]
    again = ContactSolver(rocking_contact(), threads=1)
    assert environment_of(again) == environment_of(solver)
