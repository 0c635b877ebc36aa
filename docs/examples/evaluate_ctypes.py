# SPDX-License-Identifier: Apache-2.0
# ruff: noqa: T201  (an example prints)
"""Evaluates a surrogate file through libcondyle with ctypes: no package of Condyle's is needed.

    python evaluate_ctypes.py LIBCONDYLE.so SURROGATE.onnx [x y z theta_x theta_y theta_z]

The same calls serve MATLAB (loadlibrary), Julia (ccall) or a simulator that loads external DLLs.
"""

import ctypes
import json
import sys

LOADS = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
POSE = (0.006, 0.0415, 0.0, 0.0, 0.0, -0.3)  # m, rad
Reference = ctypes.CFUNCTYPE(
    ctypes.c_int,
    ctypes.c_void_p,
    ctypes.POINTER(ctypes.c_double),
    ctypes.POINTER(ctypes.c_double),
    ctypes.POINTER(ctypes.c_double),
)


def open_library(path: str) -> ctypes.CDLL:
    """The library with the types of the functions used here; ctypes cannot know them."""
    library = ctypes.CDLL(path)
    text, model, doubles = ctypes.c_char_p, ctypes.c_void_p, ctypes.POINTER(ctypes.c_double)
    library.condyle_last_error.restype = text
    library.condyle_describe.restype = text
    library.condyle_describe.argtypes = [model]
    library.condyle_create.argtypes = [text, text, ctypes.POINTER(model)]
    library.condyle_create_hybrid.argtypes = [text, text, Reference, model, ctypes.POINTER(model)]
    library.condyle_destroy.argtypes = [model]
    library.condyle_evaluate.argtypes = [model, doubles, doubles, doubles, doubles, doubles]
    library.condyle_reference_calls.argtypes = [model, ctypes.POINTER(ctypes.c_uint64)]
    return library


def check(library: ctypes.CDLL, status: int) -> None:
    """Turns a status into an exception."""
    if status != 0:
        raise RuntimeError(f"condyle: status {status}: {library.condyle_last_error().decode()}")


def evaluate(
    library: ctypes.CDLL, model: ctypes.c_void_p, pose: tuple[float, ...]
) -> tuple[list[float], float]:
    """(wrench (12,) medial then lateral [N, Nm], trust) at a pose [m, rad]."""
    wrench, trust = (ctypes.c_double * 12)(), ctypes.c_double()
    check(
        library,
        library.condyle_evaluate(
            model, (ctypes.c_double * 6)(*pose), wrench, None, None, ctypes.byref(trust)
        ),
    )
    return list(wrench), trust.value


@Reference
def spring(user_data, pose, wrench, stiffness):  # type: ignore[no-untyped-def]
    """Stands for the caller's own contact solver: a linear spring against Fo's height."""
    for i in range(12):
        wrench[i] = 0.0
    wrench[1] = wrench[7] = 1e6 * max(0.04 - pose[1], 0.0)
    if stiffness:
        for i in range(72):
            stiffness[i] = 0.0
        stiffness[6 + 1] = stiffness[36 + 6 + 1] = -1e6 if pose[1] < 0.04 else 0.0
    return 0


def main(arguments: list[str]) -> None:
    """Prints loads by the surrogate, and by the reference where it is not to be trusted."""
    library, file = open_library(arguments[0]), arguments[1].encode()
    pose = tuple(float(value) for value in arguments[2:8]) or POSE
    model = ctypes.c_void_p()
    check(library, library.condyle_create(file, None, ctypes.byref(model)))
    said = json.loads(library.condyle_describe(model))
    print(f"{said['file']}: {said['runtime']}, {said['metadata']['condyle.side_of_body']} knee")
    wrench, trust = evaluate(library, model, pose)
    for i, load in enumerate(LOADS):
        print(f"{load}  medial {wrench[i]:12.3f}  lateral {wrench[6 + i]:12.3f}")
    print(f"trust {trust:.3f}")
    library.condyle_destroy(model)

    check(library, library.condyle_create_hybrid(file, None, spring, None, ctypes.byref(model)))
    wrench, _ = evaluate(library, model, (pose[0], 0.03, *pose[2:]))
    calls = ctypes.c_uint64()
    check(library, library.condyle_reference_calls(model, ctypes.byref(calls)))
    print(f"hybrid: Fy {wrench[1] + wrench[7]:.1f} N by the reference, {calls.value} call(s)")
    library.condyle_destroy(model)


if __name__ == "__main__":
    main(sys.argv[1:])
