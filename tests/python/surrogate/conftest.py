# SPDX-License-Identifier: Apache-2.0
"""Surrogate files for the tests: closed forms, and exported networks of random weights."""

import importlib.util
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

DATA = Path(__file__).parents[2] / "data"


@pytest.fixture(scope="session")
def tiny() -> ModuleType:
    """The script that makes the closed-form files, as a module."""
    spec = importlib.util.spec_from_file_location(
        "make_tiny_surrogate", DATA / "make_tiny_surrogate.py"
    )
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def tiny_file() -> Path:
    return DATA / "tiny_surrogate.onnx"


@pytest.fixture(scope="session")
def wrench_only_file() -> Path:
    return DATA / "tiny_surrogate_wrench.onnx"


@pytest.fixture(scope="session")
def poses(tiny: ModuleType) -> np.ndarray:
    """(300, 6) about the closed-form file's domain, in and out of contact."""
    draw = np.random.default_rng(17).uniform(-2.1, 2.1, (300, 6))
    return tiny.CENTRE + draw * tiny.HALF_WIDTH


@pytest.fixture(scope="session")
def exported(tiny: ModuleType, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """(full, wrench-only) files of a two-stage surrogate of the paper's size."""
    torch = pytest.importorskip("torch")
    from condyle.training.networks import MinMaxMap, TanhMlp
    from condyle.training.two_stage import TwoStageSurrogate

    torch.manual_seed(3)

    def net(centre: list[float], half_range: list[float], out: list[float]) -> TanhMlp:
        scale = torch.tensor(out, dtype=torch.float64)
        maps = (
            MinMaxMap(torch.tensor(centre), torch.tensor(half_range)),
            MinMaxMap(0 * scale, scale),
        )
        made = TanhMlp(*maps, hidden=(30, 30, 30))
        with torch.no_grad():  # spread the outputs about zero: gates open and closed
            for layer in made.layers:
                layer.weight *= 3
            made.layers[-1].bias.fill_(0.05)
        return made

    pose = (tiny.CENTRE.tolist(), tiny.HALF_WIDTH.tolist())
    first = net(*pose, [2100.0, 35.0, 1900.0, 32.0])
    second = net(pose[0] + [900.0, 3.0], pose[1] + [900.0, 30.0], [160.0, 75.0, 6.0, 11.0])
    third = net(pose[0] + [700.0, 2.0], pose[1] + [700.0, 25.0], [140.0, 65.0, 5.0, 9.0])
    surrogate = TwoStageSurrogate(first, (second, third))

    return _export(surrogate, tiny, tmp_path_factory.mktemp("exported"))


@pytest.fixture(scope="session")
def exported_potential(
    tiny: ModuleType, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, Path]:
    """(full, wrench-only) files of a potential surrogate of 3 x 30 neurons a side."""
    torch = pytest.importorskip("torch")
    from condyle.training.networks import MinMaxMap
    from condyle.training.potential import PotentialSurrogate, SideEnergy
    from condyle.training.potential_network import PotentialNetwork

    rng = np.random.default_rng(31)
    maps = MinMaxMap(torch.tensor(tiny.CENTRE), torch.tensor(tiny.HALF_WIDTH))

    def energy(scale: float, power: float) -> SideEnergy:
        parameters = torch.tensor(
            rng.uniform(-0.3, 0.3, PotentialNetwork(maps, (30, 30, 30)).n_parameters)
        )
        network = PotentialNetwork(maps, (30, 30, 30), parameters)
        network.split(parameters)[1][1] -= 0.8  # N falls as the femur rises
        return SideEnergy(network, scale, power)

    surrogate = PotentialSurrogate((energy(2.75, 3.0), energy(2.25, 2.5)))
    return _export(surrogate, tiny, tmp_path_factory.mktemp("exported_potential"))


def _export(surrogate: Any, tiny: ModuleType, folder: Path) -> tuple[Path, Path]:
    from condyle.training.onnx_export import (
        SurrogateMetadata,
        export_onnx,
        export_wrench_only_onnx,
    )
    from condyle.training.trust import TrustModel

    rng = np.random.default_rng(29)
    samples = tiny.CENTRE + rng.uniform(-1, 1, (800, 6)) * tiny.HALF_WIDTH
    wrenches = surrogate.wrench(samples)
    known = wrenches + 0.01 * np.abs(wrenches) * rng.standard_normal(wrenches.shape)
    trust = TrustModel.calibrate(surrogate, samples[:500], known[:500], samples[500:], known[500:])
    metadata = SurrogateMetadata(
        side_of_body="right",
        implant={"name": "none, random weights"},
        contact_law={"name": "none"},
        training={"seed": 3},
    )
    files = (folder / "surrogate.onnx", folder / "surrogate_wrench.onnx")
    export_onnx(files[0], surrogate, trust, metadata)
    export_wrench_only_onnx(files[1], surrogate, trust, metadata)
    return files
