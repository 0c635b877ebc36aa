# SPDX-License-Identifier: Apache-2.0
"""Writes tiny_two_stage.onnx and tiny_two_stage_wrench.onnx: the paper's architecture, made small.

Networks of seeded weights, 7 and 5 neurons wide, exported as any surrogate is. They describe no
knee; they give a C++ test a graph of the exporter's. Needs the training packages:

    PYTHONPATH=python python tests/data/make_tiny_two_stage.py
"""

from pathlib import Path

import numpy as np
import torch

from condyle.training.networks import MinMaxMap, TanhMlp
from condyle.training.onnx_export import SurrogateMetadata, export_onnx, export_wrench_only_onnx
from condyle.training.trust import TrustModel
from condyle.training.two_stage import TwoStageSurrogate

CENTRE = [0.0025, 0.0405, -0.0005, 0.01, 0.02, -0.55]
HALF_WIDTH = [0.0125, 0.0025, 0.0035, 0.06, 0.17, 0.65]
HIDDEN = (7, 5)


def network(
    rng: np.random.Generator, centre: list[float], half_range: list[float], out: list[float]
) -> TanhMlp:
    """A network whose outputs spread about zero by ``out``: gates open and closed."""
    scale = torch.tensor(out, dtype=torch.float64)
    net = TanhMlp(
        MinMaxMap(torch.tensor(centre), torch.tensor(half_range)),
        MinMaxMap(0 * scale, scale),
        hidden=HIDDEN,
    )
    net.set_parameters(torch.tensor(rng.uniform(-1.1, 1.1, net.n_parameters)))
    return net


def write(folder: Path) -> None:
    """Writes both files into ``folder``."""
    rng = np.random.default_rng(41)
    first = network(rng, CENTRE, HALF_WIDTH, [2100.0, 35.0, 1900.0, 32.0])
    second = tuple(
        network(rng, [*CENTRE, fy, mx], [*HALF_WIDTH, fy, 10 * mx], [160.0, 75.0, 6.0, 11.0])
        for fy, mx in ((900.0, 3.0), (700.0, 2.5))
    )
    surrogate = TwoStageSurrogate(first, second)
    poses = np.array(CENTRE) + rng.uniform(-1, 1, (1200, 6)) * np.array(HALF_WIDTH)
    wrenches = surrogate.wrench(poses)
    known = wrenches + 0.01 * np.abs(wrenches) * rng.standard_normal(wrenches.shape)
    trust = TrustModel.calibrate(surrogate, poses[:700], known[:700], poses[700:], known[700:])
    metadata = SurrogateMetadata(
        side_of_body="right",
        implant={"name": "none, seeded weights"},
        contact_law={"name": "none"},
        training={"seed": 41},
    )
    export_onnx(folder / "tiny_two_stage.onnx", surrogate, trust, metadata)
    export_wrench_only_onnx(folder / "tiny_two_stage_wrench.onnx", surrogate, trust, metadata)


if __name__ == "__main__":
    write(Path(__file__).parent)
