# SPDX-License-Identifier: Apache-2.0
"""The ONNX contract of a potential surrogate: numbers, conservation, lift-off."""

from itertools import pairwise

import numpy as np
import onnx
import onnxruntime
import pytest
import torch

from condyle.errors import InputDataError
from condyle.training import (
    TrainingSettings,
    TrustModel,
    check_parity,
    export_float32_onnx,
    export_onnx,
    export_wrench_only_onnx,
)
from condyle.training.potential import PotentialSurrogate
from condyle.training.potential_network import n_terms
from condyle.training.train_potential import train_potential


@pytest.fixture(scope="module")
def potential(trained):
    """A small potential of the synthetic contact, and its trust."""
    settings = TrainingSettings(hidden_layers=2, neurons=8, max_epochs=20, power=3.0)
    train, held_out = trained.train, trained.held_out
    surrogate, _ = train_potential(train.poses, train.wrenches, settings)
    trust = TrustModel.calibrate(
        surrogate, train.poses, train.wrenches, held_out.poses, held_out.wrenches
    )
    return surrogate, trust


@pytest.fixture(scope="module")
def files(potential, metadata, tmp_path_factory):
    folder = tmp_path_factory.mktemp("onnx_potential")
    paths = [folder / f"surrogate{kind}.onnx" for kind in ("", "_wrench", "_float32")]
    exports = (export_onnx, export_wrench_only_onnx, export_float32_onnx)
    for export, path in zip(exports, paths, strict=True):
        export(path, *potential, metadata)
    return paths


def test_the_bound_does_not_shrink_where_an_energy_pulls(potential, metadata, trained, tmp_path):
    surrogate, trust = potential
    # The same energies upside down in y: Fy < 0, as a network's may be far from its samples.
    sides = []
    for side in surrogate.sides:
        values = side.to_dict()
        values["network"]["input_half_range"] = values["network"]["input_half_range"].clone()
        values["network"]["input_half_range"][1] *= -1
        sides.append(type(side).from_dict(values))
    pulling = PotentialSurrogate((sides[0], sides[1]))
    path = tmp_path / "pulling.onnx"
    export_onnx(path, pulling, trust, metadata)
    poses = trained.held_out.poses
    assert (pulling.wrench(poses)[:, :, 1] < -1.0).sum() > 100
    report = check_parity(path, pulling, poses, trust)
    assert report.agrees, report.excess
    session = onnxruntime.InferenceSession(str(path), providers=["CPUExecutionProvider"])
    (error,) = session.run(["error"], {"pose": poses})
    assert (error >= trust.error_offset * (1 - 1e-12)).all()


def _run(path, poses):
    session = onnxruntime.InferenceSession(str(path), providers=["CPUExecutionProvider"])
    names = [output.name for output in session.get_outputs()]
    return dict(zip(names, session.run(names, {"pose": poses}), strict=True))


def _relative(a, b):
    """Largest difference of each component over its RMS."""
    over = (0, 1) if b.ndim > 1 else (0,)
    return (np.abs(a - b).max(axis=over) / np.sqrt((b**2).mean(axis=over))).max()


def test_torch_onnxruntime_and_the_reference_give_the_same_numbers(files, potential, trained):
    surrogate, trust = potential
    for path in files[:2]:
        report = check_parity(path, surrogate, trained.test.poses, trust)
        assert report.agrees, report
        assert report.n_poses > 0.99 * len(trained.test.poses)
        assert set(report.excess) == {"onnxruntime", "onnx.reference"}
        model = onnx.load(path)
        assert {node.domain for node in model.graph.node} == {""}
        props = {prop.key: prop.value for prop in model.metadata_props}
        assert props["condyle.architecture"] == "potential"
    assert not check_parity(files[2], surrogate, trained.test.poses, trust).agrees


def test_float32_is_as_close_as_its_documentation_says(files, trained):
    exact, rough = _run(files[0], trained.test.poses), _run(files[2], trained.test.poses)
    for name, limit in {"wrench": 5e-5, "stiffness": 1e-4, "error": 5e-5, "trust": 1e-4}.items():
        assert 1e-8 < _relative(rough[name], exact[name]) < limit, name


def test_stiffness_is_the_derivative_of_the_wrench(files, trained):
    poses = trained.test.poses[:200]
    found = _run(files[0], poses)["stiffness"]
    for column in range(6):
        step = np.zeros(6)
        step[column] = 1e-7 if column < 3 else 1e-5
        after, before = (_run(files[1], poses + sign * step)["wrench"] for sign in (1, -1))
        difference = (after - before) / (2 * step[column])
        # Rounding of 1e-12 of the loads over the step; truncation step² times a third derivative,
        # bounded away from lift-off only in the mean: 1e-6 of the column's RMS.
        assert _relative(found[..., column], difference) < 1e-6


def test_lifted_sides_are_exactly_zero_and_nan_stays_nan(files, potential, trained):
    surrogate, _ = potential
    with torch.no_grad():
        pose = torch.from_numpy(trained.test.poses)
        depth = np.stack([side.network.value(pose).numpy() for side in surrogate.sides], axis=1)
    outputs = _run(files[0], trained.test.poses)
    lifted = depth < -1e-9
    assert 20 < lifted.sum() < lifted.size - 20
    for name in ("wrench", "stiffness"):
        assert (outputs[name][lifted] == 0).all()
        assert not np.signbit(outputs[name][lifted]).any()
    assert (outputs["wrench"][depth > 1e-3, 1] != 0).all()
    for column in range(6):
        poses = trained.test.poses[:2].copy()
        poses[0, column] = np.nan
        for path in files:
            wrench = _run(path, poses)["wrench"]
            assert np.isnan(wrench[0]).all() and np.isfinite(wrench[1]).all()


@pytest.mark.parametrize("hidden", [(5,), (7, 4, 6)])
def test_any_depth_and_width_is_exported(hidden, potential, trained, metadata, tmp_path):
    rng = np.random.default_rng(8)
    values = potential[0].to_dict()
    for power, name in zip((2.5, 3.2), ("medial", "lateral"), strict=True):
        network = values["sides"][name]["network"]
        widths = [6, *hidden, 1]
        n = sum((a + 1) * b for a, b in pairwise(widths))
        quadratic = network["parameters"][-n_terms(6) :]
        weights = torch.from_numpy(rng.uniform(-0.4, 0.4, n))
        network |= {"hidden": list(hidden), "parameters": torch.cat([weights, quadratic])}
        values["sides"][name]["power"] = power
    surrogate = PotentialSurrogate.from_dict(values)
    path = tmp_path / "other.onnx"
    export_onnx(path, surrogate, potential[1], metadata)
    report = check_parity(path, surrogate, trained.test.poses, potential[1])
    assert report.agrees, report


def test_weights_that_are_not_finite_are_refused(potential, metadata, tmp_path):
    surrogate = PotentialSurrogate.from_dict(potential[0].to_dict())
    surrogate.sides[1].network.parameters[9] = float("nan")
    with pytest.raises(InputDataError, match=r"energy\.weight_1 is not finite"):
        export_onnx(tmp_path / "broken.onnx", surrogate, potential[1], metadata)
    assert not list(tmp_path.iterdir())
