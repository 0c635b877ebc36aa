# SPDX-License-Identifier: Apache-2.0
"""Shared by the training tests: the synthetic contact, samples of it, and one small surrogate."""

import importlib.util
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from numpy.typing import NDArray

pytest.importorskip("torch", reason="the train extra is not installed")
pytest.importorskip("onnxruntime", reason="onnxruntime is not installed")

from condyle.training import (
    SurrogateMetadata,
    TrainingRecord,
    TrainingSettings,
    TrustModel,
    TwoStageSurrogate,
    train_two_stage,
)


@dataclass(frozen=True)
class Samples:
    poses: NDArray[np.float64]
    wrenches: NDArray[np.float64]


@dataclass(frozen=True)
class Trained:
    surrogate: TwoStageSurrogate
    record: TrainingRecord
    trust: TrustModel
    train: Samples
    held_out: Samples
    test: Samples


@pytest.fixture(scope="session")
def contact() -> ModuleType:
    """The module synthetic_contact.py beside this file."""
    path = Path(__file__).with_name("synthetic_contact.py")
    spec = importlib.util.spec_from_file_location("synthetic_contact", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def trained(contact: ModuleType) -> Trained:
    """A surrogate with small networks, good enough for laws that must hold of any."""

    def samples(n: int, seed: int) -> Samples:
        poses = contact.sample(n, seed)
        return Samples(poses, contact.wrench(poses))

    train, held_out, test = samples(2000, 11), samples(1500, 12), samples(1500, 13)
    settings = TrainingSettings(hidden_layers=2, neurons=14, max_epochs=70, patience=0, seed=3)
    surrogate, record = train_two_stage(train.poses, train.wrenches, settings)
    trust = TrustModel.calibrate(
        surrogate, train.poses, train.wrenches, held_out.poses, held_out.wrenches
    )
    return Trained(surrogate, record, trust, train, held_out, test)


@pytest.fixture(scope="session")
def metadata(trained: Trained) -> SurrogateMetadata:
    return SurrogateMetadata(
        side_of_body="right",
        implant={"femur": {"name": "spheres", "sha256": "0" * 64}},
        contact_law={"law": "power", "stiffness": 1.6e9, "exponent": 2},
        training=trained.record.to_dict(history=False),
    )
