# SPDX-License-Identifier: Apache-2.0
"""Writes tiny_potential.onnx and tiny_potential_wrench.onnx: two energies, made small.

Networks of seeded weights, 7 and 5 neurons wide, one side's power 3, the other's 2.5, exported as
any surrogate is. They describe no knee; they give a C++ test a graph of the exporter's. Needs the
training packages:

    PYTHONPATH=python python tests/data/make_tiny_potential.py
"""

from pathlib import Path

import numpy as np
import torch

from condyle.training.networks import MinMaxMap
from condyle.training.onnx_export import SurrogateMetadata, export_onnx, export_wrench_only_onnx
from condyle.training.potential import PotentialSurrogate, SideEnergy
from condyle.training.potential_network import PotentialNetwork
from condyle.training.trust import TrustModel

CENTRE = [0.0025, 0.0405, -0.0005, 0.01, 0.02, -0.55]
HALF_WIDTH = [0.0125, 0.0025, 0.0035, 0.06, 0.17, 0.65]
HIDDEN = (7, 5)
#: Slope of N by the mapped y: it falls as the femur rises.
STEEPNESS = -0.8


def energy(rng: np.random.Generator, scale: float, power: float) -> SideEnergy:
    """An energy whose N spreads about zero: a side that presses and one that does not."""
    maps = MinMaxMap(
        torch.tensor(CENTRE, dtype=torch.float64) * rng.uniform(0.9, 1.1),
        torch.tensor(HALF_WIDTH, dtype=torch.float64),
    )
    network = PotentialNetwork(maps, HIDDEN)
    parameters = torch.tensor(rng.uniform(-0.6, 0.6, network.n_parameters))
    layers, coefficients = network.split(parameters)
    layers[-1][0, -1] = -0.1
    coefficients *= 0.1
    coefficients[1] += STEEPNESS
    return SideEnergy(PotentialNetwork(maps, HIDDEN, parameters), scale, power)


def write(folder: Path) -> None:
    """Writes both files into ``folder``."""
    rng = np.random.default_rng(43)
    surrogate = PotentialSurrogate((energy(rng, 2.75, 3.0), energy(rng, 2.25, 2.5)))
    poses = np.array(CENTRE) + rng.uniform(-1, 1, (1200, 6)) * np.array(HALF_WIDTH)
    wrenches = surrogate.wrench(poses)
    known = wrenches + 0.01 * np.abs(wrenches) * rng.standard_normal(wrenches.shape)
    trust = TrustModel.calibrate(surrogate, poses[:700], known[:700], poses[700:], known[700:])
    metadata = SurrogateMetadata(
        side_of_body="right",
        implant={"name": "none, seeded weights"},
        contact_law={"name": "none"},
        training={"seed": 43},
    )
    export_onnx(folder / "tiny_potential.onnx", surrogate, trust, metadata)
    export_wrench_only_onnx(folder / "tiny_potential_wrench.onnx", surrogate, trust, metadata)


if __name__ == "__main__":
    write(Path(__file__).parent)
