# SPDX-License-Identifier: Apache-2.0
"""What Python adds to one pose of a contact model, with output arrays of the caller's and without.

    OMP_NUM_THREADS=1 .venv/bin/python tests/benchmarks/python_overhead.py

The contact is that of two triangles on each side, far apart, so that there is next to nothing to compute; what the
model itself takes is measured as the time per row of a long batch on one thread, and taken off.
"""

import timeit
from collections.abc import Callable
from pathlib import Path

import numpy as np

from condyle.contact import Derivatives, Mesh, MeshContact
from condyle.errors import CondyleError
from condyle.surrogate import load_surrogate

ROWS = 20_000
SURROGATE = Path(__file__).parents[1] / "data" / "tiny_surrogate.onnx"


def square(height: float, z: float, half: float, *, up: bool) -> Mesh:
    """Two triangles about (0, height, z), normals up or down."""
    corners = [(x, height, z + dz) for x in (-half, half) for dz in (-half, half)]
    faces = np.array([[0, 1, 3], [0, 3, 2]], np.int32)
    return Mesh(np.array(corners), faces if up else np.ascontiguousarray(faces[:, ::-1]))


def nanoseconds(call: Callable[[], object], number: int) -> float:
    """A call's time, the quickest of nine repeats."""
    return 1e9 * min(timeit.repeat(call, number=number, repeat=9)) / number


def main() -> None:
    """Prints the table."""
    contact = MeshContact(
        square(-0.011, 0.0, 0.04, up=False),
        square(0.0073, -0.021, 0.006, up=True),
        square(0.0073, 0.021, 0.006, up=True),
        "right",
    )
    pose = np.array([0.003, 0.2, 0.001, 0.01, -0.02, -0.3])
    wrench, stiffness = np.empty((2, 6)), np.empty((2, 6, 6))
    one, many = pose[None].copy(), np.tile(pose, (ROWS, 1))
    wrenches, stiffnesses = np.empty((ROWS, 2, 6)), np.empty((ROWS, 2, 6, 6))
    model = nanoseconds(lambda: contact.evaluate_into(many, wrenches), 1) / ROWS
    both = nanoseconds(lambda: contact.evaluate_into(many, wrenches, stiffnesses), 1) / ROWS
    rows: list[tuple[str, Callable[[], object], float]] = [
        ("evaluate_into(pose, wrench)", lambda: contact.evaluate_into(pose, wrench), model),
        (
            "evaluate_into(pose, wrench, stiffness)",
            lambda: contact.evaluate_into(pose, wrench, stiffness),
            both,
        ),
        (
            "evaluate(poses, Derivatives.stiffness, 1)",
            lambda: contact.evaluate(one, Derivatives.stiffness, 1),
            both,
        ),
    ]
    print(f"{'one pose':44} {'call ns':>8} {'model ns':>9} {'Python ns':>10}")
    for name, call, inside in rows:
        took = nanoseconds(call, 20_000)
        print(f"{name:44} {took:8.0f} {inside:9.0f} {took - inside:10.0f}")
    try:
        surrogate = load_surrogate(SURROGATE)
    except CondyleError as error:
        print(f"surrogate: {error}")
        return
    for name, call in (
        ("surrogate, evaluate_into", lambda: surrogate.evaluate_into(pose, wrench, stiffness)),
        ("surrogate, evaluate", lambda: surrogate.evaluate(one, Derivatives.stiffness, 1)),
    ):
        print(f"{name:44} {nanoseconds(call, 2_000):8.0f}")


main()
