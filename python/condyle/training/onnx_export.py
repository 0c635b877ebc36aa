# SPDX-License-Identifier: Apache-2.0
"""Export of a surrogate as an ONNX file by contract version 1.

    input   pose       float64 [N, 6]        x, y, z [m], theta_x, theta_y, theta_z [rad]
    output  wrench     float64 [N, 2, 6]     (medial, lateral) × (Fx, Fy, Fz [N], Mx, My, Mz [Nm]),
                                             on the femur at Fo in T
    output  stiffness  float64 [N, 2, 6, 6]  ∂wrench_i/∂pose_j
    output  error      float64 [N, 2, 6]     calibrated 95 % bound on each load [N, Nm]
    output  trust      float64 [N]           1 well inside the sampled domains, 0 outside; below 0.5
                                             do not use

SI in, SI out; standard operators of opset 17 (onnxruntime 1.17 and newer); N is free. The
wrench-only file has the first output alone and the same metadata. A pose with NaN gives NaN, never
zero. The float32 file computes in float32 between a float64 input and float64 outputs.

Metadata (``metadata_props``), all required:

| key | value |
|---|---|
| condyle.contract_version | ``1`` |
| condyle.pose_columns | ``x,y,z,theta_x,theta_y,theta_z`` |
| condyle.load_columns | ``Fx,Fy,Fz,Mx,My,Mz`` |
| condyle.sides | ``medial,lateral`` |
| condyle.units | ``m,rad,N,Nm`` (length, angle, force, moment) |
| condyle.side_of_body | ``left`` or ``right`` |
| condyle.architecture | ``two_stage`` or ``potential`` |
| condyle.frames | JSON: axes, rotation, where and on what the wrench acts |
| condyle.implant | JSON: the caller's; names and SHA-256 of the meshes |
| condyle.contact_law | JSON: the caller's; law and parameters |
| condyle.domain_bounds | JSON: ``TrustModel.domain_bounds()`` and, under "sampling", the caller's |
| condyle.error_table | JSON: ``TrustModel.error_table()`` |
| condyle.training | JSON: the caller's; ``TrainingRecord.to_dict(history=False)`` |

JSON texts have sorted keys and no NaN; the same inputs give the same bytes.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import onnx
from onnx import TensorProto, helper

from condyle.conventions import LOAD_COLUMNS, POSE_COLUMNS, SIDES, SideOfBody
from condyle.errors import InputDataError
from condyle.training.onnx_graph import GraphBuilder
from condyle.training.onnx_potential import add_potential
from condyle.training.onnx_trust import add_trust
from condyle.training.onnx_two_stage import add_two_stage
from condyle.training.potential import PotentialSurrogate
from condyle.training.trust import TrustModel
from condyle.training.two_stage import TwoStageSurrogate
from condyle.whole_files import write_whole

#: What can be exported.
Surrogate = TwoStageSurrogate | PotentialSurrogate

CONTRACT_VERSION = "1"
OPSET = 17
IR_VERSION = 8

#: Outputs of the contract: shape after N, and what it is.
_OUTPUTS: dict[str, tuple[tuple[int, ...], str]] = {
    "wrench": (
        (2, 6),
        "(medial, lateral) x (Fx, Fy, Fz [N], Mx, My, Mz [Nm]) on the femur at Fo in T",
    ),
    "stiffness": ((2, 6, 6), "d wrench_i / d pose_j [N/m, N/rad, Nm/m, Nm/rad]"),
    "error": ((2, 6), "calibrated 95 % bound on the error of each load [N, Nm]"),
    "trust": ((), "1 well inside the sampled domains, 0 outside; below 0.5 do not use"),
}
_FRAMES = {
    "axes": "x anterior, y superior, z to the subject's right, in F (femoral) and T (tibial)",
    "pose": "F in T: (x, y, z) is Fo in T, R_TF = Rx(-theta_x) Ry(-theta_y) Rz(-theta_z)",
    "wrench": "on the femur, at Fo, expressed in T; compression is Fy > 0",
}


@dataclass(frozen=True)
class SurrogateMetadata:
    """What the exporter cannot know of a surrogate. The mappings must be JSON-able.

    Attributes:
        side_of_body: "left" or "right".
        implant: Names and SHA-256 of the meshes.
        contact_law: Law and parameters.
        training: ``TrainingRecord.to_dict(history=False)``, and whatever names the samples.
        sampling: Bounds of the sampled domains, if known.
    """

    side_of_body: SideOfBody
    implant: Mapping[str, Any]
    contact_law: Mapping[str, Any]
    training: Mapping[str, Any]
    sampling: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Refuses a side of body that is neither."""
        if self.side_of_body not in ("left", "right"):
            raise InputDataError(
                f"side_of_body is {self.side_of_body!r}; it must be 'left' or 'right'"
            )


def export_onnx(
    path: str | os.PathLike[str],
    surrogate: Surrogate,
    trust: TrustModel,
    metadata: SurrogateMetadata,
) -> None:
    """Writes the full contract: wrench, stiffness, error and trust.

    Args:
        path: File to write, whole or not at all.
        surrogate: The networks.
        trust: Calibrated on samples that ``surrogate`` has not seen.
        metadata: See :class:`SurrogateMetadata`.

    Raises:
        InputDataError: Weights that are not finite, or metadata that is not JSON.
    """
    _export_full(path, GraphBuilder(), surrogate, trust, metadata)


def export_wrench_only_onnx(
    path: str | os.PathLike[str],
    surrogate: Surrogate,
    trust: TrustModel,
    metadata: SurrogateMetadata,
) -> None:
    """Writes the wrench alone, for speed; arguments and errors as :func:`export_onnx`."""
    graph = GraphBuilder()
    _add_networks(graph, surrogate, stiffness=False)
    _write(path, graph, ("wrench",), surrogate, trust, metadata)


def export_float32_onnx(
    path: str | os.PathLike[str],
    surrogate: Surrogate,
    trust: TrustModel,
    metadata: SurrogateMetadata,
) -> None:
    """Writes the full contract computed in float32, for accelerators that have little else.

    Input and outputs stay float64, so it is a contract file like the other: the pose is taken
    relative to the middle of the training poses before it is rounded, the outputs are cast back.
    Beside the float64 file, wrench and error differ by up to 5e-5 of their RMS over the samples,
    stiffness and trust by up to 1e-4 (seen: 1e-6 to 3e-5): too rough for finite differences, or for
    Newton's last steps. Arguments and errors as :func:`export_onnx`.
    """
    if isinstance(surrogate, PotentialSurrogate):
        centres = [side.network.input_map.centre for side in surrogate.sides]
    else:
        centres = [surrogate.first.input_map.centre]
    origin = np.mean([centre.numpy() for centre in centres], axis=0)
    _export_full(path, GraphBuilder.in_float32(origin), surrogate, trust, metadata)


def _export_full(
    path: str | os.PathLike[str],
    graph: GraphBuilder,
    surrogate: Surrogate,
    trust: TrustModel,
    metadata: SurrogateMetadata,
) -> None:
    _add_networks(graph, surrogate, stiffness=True)
    add_trust(graph, trust)
    _write(path, graph, tuple(_OUTPUTS), surrogate, trust, metadata)


def _add_networks(graph: GraphBuilder, surrogate: Surrogate, *, stiffness: bool) -> None:
    if isinstance(surrogate, PotentialSurrogate):
        add_potential(graph, surrogate, stiffness=stiffness)
    else:
        add_two_stage(graph, surrogate, stiffness=stiffness)


def _write(
    path: str | os.PathLike[str],
    graph: GraphBuilder,
    outputs: tuple[str, ...],
    surrogate: Surrogate,
    trust: TrustModel,
    metadata: SurrogateMetadata,
) -> None:
    graph.finish(outputs)
    for name, tensor in graph.initialisers.items():
        values = onnx.numpy_helper.to_array(tensor)
        if not (abs(values) < float("inf")).all():
            raise InputDataError(f"{path}: {name} is not finite; the surrogate cannot be exported")
    model = helper.make_model(
        helper.make_graph(
            graph.nodes,
            f"condyle_{surrogate.architecture}",
            [
                helper.make_tensor_value_info(
                    "pose",
                    TensorProto.DOUBLE,
                    ["N", len(POSE_COLUMNS)],
                    "x, y, z [m], theta_xyz [rad]",
                )
            ],
            [
                helper.make_tensor_value_info(
                    name, TensorProto.DOUBLE, ["N", *_OUTPUTS[name][0]], _OUTPUTS[name][1]
                )
                for name in outputs
            ],
            list(graph.initialisers.values()),
        ),
        opset_imports=[helper.make_opsetid("", OPSET)],
        ir_version=IR_VERSION,
        producer_name="condyle",
    )
    helper.set_model_props(model, _metadata_props(surrogate, trust, metadata))
    onnx.checker.check_model(model, full_check=True)
    write_whole(Path(path), model.SerializeToString(deterministic=True))


def _metadata_props(
    surrogate: Surrogate, trust: TrustModel, metadata: SurrogateMetadata
) -> dict[str, str]:
    bounds = {**trust.domain_bounds(), "sampling": dict(metadata.sampling)}
    return {
        "condyle.contract_version": CONTRACT_VERSION,
        "condyle.pose_columns": ",".join(POSE_COLUMNS),
        "condyle.load_columns": ",".join(LOAD_COLUMNS),
        "condyle.sides": ",".join(SIDES),
        "condyle.units": "m,rad,N,Nm",
        "condyle.side_of_body": metadata.side_of_body,
        "condyle.architecture": surrogate.architecture,
        "condyle.frames": _json("frames", _FRAMES),
        "condyle.implant": _json("implant", metadata.implant),
        "condyle.contact_law": _json("contact_law", metadata.contact_law),
        "condyle.domain_bounds": _json("sampling", bounds),
        "condyle.error_table": _json("error_table", trust.error_table()),
        "condyle.training": _json("training", metadata.training),
    }


def _json(name: str, values: Mapping[str, Any]) -> str:
    try:
        return json.dumps(dict(values), sort_keys=True, allow_nan=False, ensure_ascii=False)
    except (TypeError, ValueError) as error:
        raise InputDataError(f"metadata {name} is not JSON: {error}") from error
