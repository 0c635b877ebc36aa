# SPDX-License-Identifier: Apache-2.0
"""Writes ``tiny_surrogate.onnx`` and ``tiny_surrogate_wrench.onnx``: contract 1, known answers.

Per side s, with p the pose:  u = DIRECTION[s] · p + OFFSET[s],  v = max(u, 0) [-],

    wrench_i = SCALE[s][i] · v²      stiffness_ij = 2 · SCALE[s][i] · v · DIRECTION[s][j]
    error_i  = ERROR[s][i]           trust = 1 − clip(max_j |p_j − CENTRE_j| / HALF_WIDTH_j − 1, 0,
    1)

so every output is a closed form that a test in any language can state again. A left knee.
Run it in this folder to write the files again; they are the same bytes every time.
"""

import json
from pathlib import Path

import numpy as np
import numpy.typing as npt
import onnx
from onnx import TensorProto, helper, numpy_helper

Array = npt.NDArray[np.float64]

DIRECTION = np.array(
    [[3.5, -210.0, 12.5, 4.25, -0.375, 0.625], [-7.5, -190.0, -6.5, -5.75, 0.875, 0.3125]]
)
OFFSET = np.array([8.75, 7.8125])
SCALE = np.array(
    [[-13.5, 421.0, 36.5, 10.25, 1.125, -2.75], [17.25, 383.0, -42.5, -9.125, -0.625, -3.375]]
)
ERROR = np.array([[1.25, 6.5, 2.75, 0.11, 0.05, 0.07], [1.75, 5.5, 3.25, 0.13, 0.03, 0.09]])
CENTRE = np.array([0.0025, 0.0405, -0.0005, 0.01, 0.02, -0.55])
HALF_WIDTH = np.array([0.0125, 0.0025, 0.0035, 0.06, 0.17, 0.65])

COLUMNS = ("x", "y", "z", "theta_x", "theta_y", "theta_z")
METADATA = {
    "condyle.contract_version": "1",
    "condyle.pose_columns": ",".join(COLUMNS),
    "condyle.load_columns": "Fx,Fy,Fz,Mx,My,Mz",
    "condyle.sides": "medial,lateral",
    "condyle.units": "m,rad,N,Nm",
    "condyle.side_of_body": "left",
    "condyle.frames": json.dumps(
        {"pose": "F in T", "wrench": "on the femur, at Fo, expressed in T"}
    ),
    "condyle.implant": json.dumps({"name": "two gated springs"}),
    "condyle.contact_law": json.dumps({"name": "square of a linear overlap"}),
    "condyle.domain_bounds": json.dumps(
        {
            "pose_min": dict(zip(COLUMNS, (CENTRE - HALF_WIDTH).tolist(), strict=True)),
            "pose_max": dict(zip(COLUMNS, (CENTRE + HALF_WIDTH).tolist(), strict=True)),
        }
    ),
    "condyle.error_table": json.dumps({}),
    "condyle.training": json.dumps({"note": "written by hand for tests"}),
    "condyle.architecture": "closed form",
}


def _constant(name: str, values: Array | npt.NDArray[np.int64]) -> TensorProto:
    return numpy_helper.from_array(values, name)


def _wrench_graph() -> tuple[list[onnx.NodeProto], list[TensorProto]]:
    nodes = [
        helper.make_node("MatMul", ["pose", "direction_T"], ["projected"]),
        helper.make_node("Add", ["projected", "offset"], ["overlap"]),
        helper.make_node("Relu", ["overlap"], ["depth"]),
        helper.make_node("Unsqueeze", ["depth", "axis_2"], ["depth_column"]),  # (N, 2, 1)
        helper.make_node("Mul", ["depth_column", "depth_column"], ["squared"]),
        helper.make_node("Mul", ["squared", "scale"], ["wrench"]),
    ]
    constants = [
        _constant("direction_T", np.ascontiguousarray(DIRECTION.T)),
        _constant("offset", OFFSET),
        _constant("axis_2", np.array([2])),
        _constant("scale", SCALE),
    ]
    return nodes, constants


def _remaining_graph() -> tuple[list[onnx.NodeProto], list[TensorProto]]:
    nodes = [
        helper.make_node("Unsqueeze", ["depth_column", "axis_2"], ["depth_matrix"]),  # (N, 2, 1, 1)
        helper.make_node("Mul", ["depth_matrix", "twice_scale_direction"], ["stiffness"]),
        helper.make_node("Mul", ["squared", "zero"], ["nothing"]),  # gives `error` its N
        helper.make_node("Add", ["nothing", "bound"], ["error"]),
        helper.make_node("Sub", ["pose", "centre"], ["from_centre"]),
        helper.make_node("Abs", ["from_centre"], ["distance"]),
        helper.make_node("Div", ["distance", "half_width"], ["relative"]),
        helper.make_node("ReduceMax", ["relative"], ["farthest"], axes=[1], keepdims=0),
        helper.make_node("Sub", ["farthest", "one"], ["outside"]),
        helper.make_node("Clip", ["outside", "zero", "one"], ["distrust"]),
        helper.make_node("Sub", ["one", "distrust"], ["trust"]),
    ]
    constants = [
        _constant("twice_scale_direction", 2.0 * SCALE[:, :, None] * DIRECTION[:, None, :]),
        _constant("bound", ERROR),
        _constant("centre", CENTRE),
        _constant("half_width", HALF_WIDTH),
        _constant("zero", np.array(0.0)),
        _constant("one", np.array(1.0)),
    ]
    return nodes, constants


def tiny_surrogate(*, wrench_only: bool = False) -> onnx.ModelProto:
    """The model; with ``wrench_only`` the variant whose one output is ``wrench``."""
    nodes, constants = _wrench_graph()
    shapes: dict[str, list[str | int]] = {"wrench": ["N", 2, 6]}
    if not wrench_only:
        more_nodes, more_constants = _remaining_graph()
        nodes += more_nodes
        constants += more_constants
        shapes |= {"stiffness": ["N", 2, 6, 6], "error": ["N", 2, 6], "trust": ["N"]}
    graph = helper.make_graph(
        nodes,
        "condyle_surrogate",
        [helper.make_tensor_value_info("pose", TensorProto.DOUBLE, ["N", 6])],
        [
            helper.make_tensor_value_info(name, TensorProto.DOUBLE, shape)
            for name, shape in shapes.items()
        ],
        constants,
    )
    model = helper.make_model(
        graph, producer_name="condyle", opset_imports=[helper.make_opsetid("", 17)], ir_version=8
    )
    helper.set_model_props(model, METADATA)
    onnx.checker.check_model(model)
    return model


def write(folder: Path) -> None:
    """Writes both files into ``folder``."""
    for name, wrench_only in (("tiny_surrogate", False), ("tiny_surrogate_wrench", True)):
        text = tiny_surrogate(wrench_only=wrench_only).SerializeToString(deterministic=True)
        (folder / f"{name}.onnx").write_bytes(text)


if __name__ == "__main__":
    write(Path(__file__).parent)
