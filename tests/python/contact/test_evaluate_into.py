# SPDX-License-Identifier: Apache-2.0
import re
from typing import Any

import numpy as np
import pytest
from small_implant import femur, inserts

from condyle.contact import Derivatives, MeshContact


def poses() -> np.ndarray:
    """Above, at and below first touch, tilted."""
    draw = np.random.default_rng(5)
    table = draw.uniform(-1, 1, (37, 6)) * [0.002, 0.001, 0.001, 0.02, 0.1, 0.05]
    table[:, 1] += 0.0073 + 0.011
    return table


def arrays(n: int) -> dict[str, Any]:
    return {
        "wrench": np.full((n, 2, 6), np.nan),
        "stiffness": np.full((n, 2, 6, 6), np.nan),
        "error": np.full((n, 2, 6), np.nan),
        "trust": np.full(n, np.nan),
        "implausible_depth": np.ones(n, bool),
    }


@pytest.mark.parametrize("threads", [1, 3])
def test_the_callers_arrays_hold_what_evaluate_returns(contact: MeshContact, threads: int) -> None:
    table = poses()
    out = arrays(len(table))
    assert contact.evaluate_into(table, threads=threads, **out) is None
    loads = contact.evaluate(table, Derivatives.stiffness, 1)
    assert np.count_nonzero(loads.wrench[:, :, 1]) > 20
    for name, values in out.items():
        assert np.array_equal(values, getattr(loads, name)), name


def test_one_pose_fills_arrays_without_the_axis_of_poses(contact: MeshContact) -> None:
    pose = poses()[3]
    out = {name: array[0].copy() for name, array in arrays(1).items() if array.ndim > 1}
    trust = np.full((), np.nan)
    contact.evaluate_into(pose, trust=trust, **out)
    loads = contact.evaluate(pose[None].copy(), Derivatives.stiffness, 1)
    for name, values in out.items():
        assert np.array_equal(values, getattr(loads, name)[0]), name
    assert trust == 1.0


def test_stiffness_is_not_asked_for_unless_given(contact: MeshContact) -> None:
    table = poses()
    wrench = np.empty((len(table), 2, 6))
    contact.evaluate_into(table, wrench)
    assert np.array_equal(wrench, contact.evaluate(table, Derivatives.none, 1).wrench)


def test_a_view_is_written_in_place(contact: MeshContact) -> None:
    table = poses()
    whole = np.full((2 * len(table), 2, 6), -7.0)
    contact.evaluate_into(table, whole[len(table) :])
    assert np.all(whole[: len(table)] == -7.0)
    assert np.array_equal(whole[len(table) :], contact.evaluate(table, Derivatives.none, 1).wrench)


def test_what_does_not_fit_is_refused_by_name_and_nothing_is_copied(contact: MeshContact) -> None:
    table = poses()
    n = len(table)
    wrench = np.empty((n, 2, 6))
    wrong: list[tuple[str, tuple[Any, ...]]] = [
        ("wrench has another type: must be float64", (table, wrench.astype(np.float32))),
        ("wrench has shape (37, 12): must be (37, 2, 6)", (table, wrench.reshape(n, 12))),
        ("wrench has shape (36, 2, 6): must be (37, 2, 6)", (table, wrench[1:])),
        ("wrench is not C-contiguous", (table, np.asfortranarray(wrench))),
        ("wrench is not C-contiguous", (table, np.empty((n, 2, 12))[:, :, ::2])),
        ("stiffness has shape (37, 2, 6): must be (37, 2, 6, 6)", (table, wrench, wrench)),
        ("wrench has shape (1, 2, 6): must be (2, 6)", (table[0], wrench[:1])),
        ("poses has another type: must be float64", (table.astype(int), wrench)),
        ("poses is not C-contiguous", (np.asfortranarray(table), wrench)),
        ("poses has shape (37, 5): must be (37, 6)", (table[:, :5].copy(), wrench)),
        ("poses has shape (5,): must be (6,)", (table[0, :5].copy(), wrench[0])),
        ("poses has shape (1, 37, 6): must be (n, 6) or (6,)", (table[None], wrench)),
    ]
    for message, arguments in wrong:
        with pytest.raises(ValueError, match=re.escape(message)):
            contact.evaluate_into(*arguments)
    with pytest.raises(ValueError, match="implausible_depth has another type: must be bool"):
        contact.evaluate_into(table, wrench, implausible_depth=np.zeros(n, np.int8))
    frozen = wrench.copy()
    frozen.flags.writeable = False
    for arguments in ((table, frozen), (table.tolist(), wrench), (table, None)):
        with pytest.raises(TypeError):
            contact.evaluate_into(*arguments)


def test_a_pose_that_is_not_finite_is_named(contact: MeshContact) -> None:
    table = poses()
    table[11, 4] = np.nan
    with pytest.raises(ValueError, match=r"row 11: pose: theta_y is -?nan: must be finite"):
        contact.evaluate_into(table, np.empty((len(table), 2, 6)))


def test_fast_fills_the_same_arrays() -> None:
    fast = MeshContact(femur(), *inserts(), "right", evaluation="fast")
    table = poses()
    out = arrays(len(table))
    fast.evaluate_into(table, threads=2, **out)
    loads = fast.evaluate(table, Derivatives.stiffness, 1)
    for name, values in out.items():
        assert np.array_equal(values, getattr(loads, name)), name
