# SPDX-License-Identifier: Apache-2.0
"""Training of surrogates and their export: the only part of Condyle that imports torch and onnx.

    >>> surrogate, record = train_two_stage(poses, wrenches, TrainingSettings(seed=1))
    >>> trust = TrustModel.calibrate(surrogate, poses, wrenches, test_poses, test_wrenches)
    >>> export_onnx("surrogate.onnx", surrogate, trust, SurrogateMetadata("right", implant, law,
    record.to_dict()))

Needs the ``train`` extra.
"""

from condyle.training.architecture_search import (
    ArchitectureSearchSettings,
    ArchitectureTrial,
    search_architecture,
)
from condyle.training.least_squares import (
    AutogradLeastSquares,
    LeastSquaresProblem,
    NormalEquations,
)
from condyle.training.levenberg_marquardt import (
    LevenbergMarquardt,
    LevenbergMarquardtSettings,
    LevenbergMarquardtState,
    StopReason,
)
from condyle.training.mlp_least_squares import MlpLeastSquares
from condyle.training.networks import MinMaxMap, TanhMlp
from condyle.training.onnx_export import (
    SurrogateMetadata,
    export_float32_onnx,
    export_onnx,
    export_wrench_only_onnx,
)
from condyle.training.parity import ParityReport, check_parity
from condyle.training.record import NetRecord, TrainingRecord
from condyle.training.settings import TrainingSettings
from condyle.training.train import ProgressCallback, train_two_stage
from condyle.training.trust import TrustModel
from condyle.training.two_stage import TwoStageSurrogate

__all__ = [
    "ArchitectureSearchSettings",
    "ArchitectureTrial",
    "AutogradLeastSquares",
    "LeastSquaresProblem",
    "LevenbergMarquardt",
    "LevenbergMarquardtSettings",
    "LevenbergMarquardtState",
    "MinMaxMap",
    "MlpLeastSquares",
    "NetRecord",
    "NormalEquations",
    "ParityReport",
    "ProgressCallback",
    "StopReason",
    "SurrogateMetadata",
    "TanhMlp",
    "TrainingRecord",
    "TrainingSettings",
    "TrustModel",
    "TwoStageSurrogate",
    "check_parity",
    "export_float32_onnx",
    "export_onnx",
    "export_wrench_only_onnx",
    "search_architecture",
    "train_two_stage",
]
