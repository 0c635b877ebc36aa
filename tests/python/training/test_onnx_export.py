# SPDX-License-Identifier: Apache-2.0
"""The ONNX contract: shapes, metadata, numbers, determinism, refusals."""

import dataclasses
import json

import numpy as np
import onnx
import onnxruntime
import pytest
import torch

from condyle.errors import InputDataError
from condyle.training import (
    SurrogateMetadata,
    TwoStageSurrogate,
    check_parity,
    export_float32_onnx,
    export_onnx,
    export_wrench_only_onnx,
)

SHAPES = {
    "wrench": ["N", 2, 6],
    "stiffness": ["N", 2, 6, 6],
    "error": ["N", 2, 6],
    "trust": ["N"],
}


@pytest.fixture(scope="module")
def files(trained, metadata, tmp_path_factory):
    folder = tmp_path_factory.mktemp("onnx")
    full, wrench_only = folder / "surrogate.onnx", folder / "surrogate_wrench.onnx"
    export_onnx(full, trained.surrogate, trained.trust, metadata)
    export_wrench_only_onnx(wrench_only, trained.surrogate, trained.trust, metadata)
    return full, wrench_only


def _run(path, poses):
    session = onnxruntime.InferenceSession(str(path), providers=["CPUExecutionProvider"])
    names = [output.name for output in session.get_outputs()]
    return dict(zip(names, session.run(names, {"pose": poses}), strict=True))


def _signature(values):
    return {
        value.name: [d.dim_param or d.dim_value for d in value.type.tensor_type.shape.dim]
        for value in values
    }


def test_inputs_and_outputs_are_those_of_the_contract(files):
    for path, names in zip(files, (tuple(SHAPES), ("wrench",)), strict=True):
        model = onnx.load(path)
        onnx.checker.check_model(model, full_check=True)
        assert _signature(model.graph.input) == {"pose": ["N", 6]}
        assert _signature(model.graph.output) == {name: SHAPES[name] for name in names}
        for value in (*model.graph.input, *model.graph.output):
            assert value.type.tensor_type.elem_type == onnx.TensorProto.DOUBLE
        # onnxruntime 1.17 reads opset 20 and IR 9 at most; standard operators only.
        assert [(o.domain, o.version) for o in model.opset_import] == [("", 17)]
        assert model.ir_version <= 9
        assert {node.domain for node in model.graph.node} == {""}


def test_torch_onnxruntime_and_the_reference_give_the_same_numbers(files, trained):
    for path in files:
        report = check_parity(path, trained.surrogate, trained.test.poses, trained.trust)
        assert report.agrees, report
        assert report.n_poses + report.n_on_gate == len(trained.test.poses)
        assert report.n_poses > 0.99 * len(trained.test.poses)
        assert set(report.excess) == {"onnxruntime", "onnx.reference"}


def test_parity_notices_a_changed_weight(files, trained, tmp_path):
    model = onnx.load(files[0])
    tensor = next(t for t in model.graph.initializer if t.name == "net_II_III.weight_2")
    values = onnx.numpy_helper.to_array(tensor).copy()
    # The largest weight of net II: off by 1e-6 of itself.
    values[np.unravel_index(np.abs(values).argmax(), values.shape)] *= 1 + 1e-6
    tensor.CopyFrom(onnx.numpy_helper.from_array(values, tensor.name))
    path = tmp_path / "changed.onnx"
    onnx.save(model, path)
    assert not check_parity(path, trained.surrogate, trained.test.poses).agrees


@pytest.mark.parametrize("n", [1, 7, 300])
def test_rows_do_not_depend_on_the_batch(files, trained, n):
    whole = _run(files[0], trained.test.poses)
    part = _run(files[0], trained.test.poses[:n])
    for name in SHAPES:
        # Another blocking of the sums: rounding only.
        scale = np.abs(whole[name]).max()
        np.testing.assert_allclose(part[name], whole[name][:n], rtol=1e-11, atol=1e-12 * scale)


def test_lifted_sides_are_exactly_zero_and_nan_stays_nan(files, trained):
    outputs = _run(files[0], trained.test.poses)
    lifted = trained.surrogate.ungated_fy(trained.test.poses) < -1e-6
    assert lifted.any()
    assert (outputs["wrench"][lifted] == 0).all() and (outputs["stiffness"][lifted] == 0).all()
    assert not np.signbit(outputs["wrench"][lifted]).any()
    poses = trained.test.poses[:2].copy()
    poses[0, 3] = np.nan
    for path in files:
        wrench = _run(path, poses)["wrench"]
        assert np.isnan(wrench[0]).all() and np.isfinite(wrench[1]).all()


def test_equal_inputs_give_equal_bytes(files, trained, metadata, tmp_path):
    again = tmp_path / "again.onnx"
    export_onnx(again, trained.surrogate, trained.trust, metadata)
    assert again.read_bytes() == files[0].read_bytes()
    assert [path.name for path in tmp_path.iterdir()] == ["again.onnx"]


def test_metadata_says_what_the_file_is(files, trained, metadata):
    for path in files:
        props = {prop.key: prop.value for prop in onnx.load(path).metadata_props}
        assert props["condyle.contract_version"] == "1"
        assert props["condyle.pose_columns"] == "x,y,z,theta_x,theta_y,theta_z"
        assert props["condyle.load_columns"] == "Fx,Fy,Fz,Mx,My,Mz"
        assert props["condyle.sides"] == "medial,lateral"
        assert props["condyle.units"] == "m,rad,N,Nm"
        assert props["condyle.side_of_body"] == "right"
        assert props["condyle.architecture"] == "two_stage"
        assert json.loads(props["condyle.implant"]) == metadata.implant
        assert json.loads(props["condyle.contact_law"]) == metadata.contact_law
        assert json.loads(props["condyle.error_table"]) == trained.trust.error_table()
        bounds = json.loads(props["condyle.domain_bounds"])
        assert bounds.pop("sampling") == {} and bounds == trained.trust.domain_bounds()
        assert json.loads(props["condyle.training"])["nets"][0]["name"] == "I"
        assert "R_TF = Rx(-theta_x)" in json.loads(props["condyle.frames"])["pose"]


def test_weights_that_are_not_finite_are_refused(trained, metadata, tmp_path):
    broken = TwoStageSurrogate.from_dict(trained.surrogate.to_dict())
    with torch.no_grad():
        broken.first.layers[1].weight[2, 3] = float("nan")
    path = tmp_path / "broken.onnx"
    with pytest.raises(InputDataError, match=r"net_I\.weight_2 is not finite"):
        export_onnx(path, broken, trained.trust, metadata)
    assert not path.exists()


def test_unfit_metadata_is_refused(trained, metadata, tmp_path):
    with pytest.raises(InputDataError, match="side_of_body is 'both'"):
        dataclasses.replace(metadata, side_of_body="both")
    for value in (float("nan"), {1, 2}):
        bad = SurrogateMetadata("left", {}, {"stiffness": value}, {})
        with pytest.raises(InputDataError, match="metadata contact_law is not JSON"):
            export_onnx(tmp_path / "bad.onnx", trained.surrogate, trained.trust, bad)


def test_float32_reads_and_gives_float64_to_its_own_precision(files, trained, metadata, tmp_path):
    path = tmp_path / "surrogate_float32.onnx"
    export_float32_onnx(path, trained.surrogate, trained.trust, metadata)
    model = onnx.load(path)
    onnx.checker.check_model(model, full_check=True)
    for value in (*model.graph.input, *model.graph.output):
        assert value.type.tensor_type.elem_type == onnx.TensorProto.DOUBLE
    in_double = [t.name for t in model.graph.initializer if t.data_type == onnx.TensorProto.DOUBLE]
    assert in_double == ["pose.origin"]
    assert path.stat().st_size < files[0].stat().st_size
    exact, rough = _run(files[0], trained.test.poses), _run(path, trained.test.poses)
    # Within 1e-4 N the gate may open on either side.
    clear = (np.abs(trained.surrogate.ungated_fy(trained.test.poses)) > 0.1).all(axis=1)
    assert clear.mean() > 0.99
    for name, limit in {"wrench": 5e-5, "stiffness": 1e-4, "error": 5e-5, "trust": 1e-4}.items():
        a, b = rough[name][clear], exact[name][clear]
        over = (0, 1) if b.ndim > 1 else (0,)
        rms = np.sqrt((b**2).mean(axis=over))
        worst = (np.abs(a - b).max(axis=over) / rms).max()
        # A few hundred roundings of 6e-8, and no more than documented.
        assert 1e-8 < worst < limit, (name, worst)
