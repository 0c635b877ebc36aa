# SPDX-License-Identifier: Apache-2.0
"""Surrogate files through the C++ core: numbers, refusals, and what a file says of itself."""

import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import onnx
import pytest

from condyle.contact import ContactModel, Derivatives
from condyle.errors import CondyleError, InputDataError
from condyle.surrogate import (
    HybridContactModel,
    OnnxContactModel,
    Runtime,
    describe,
    load_surrogate,
    onnxruntime_library,
    onnxruntime_version,
)
from condyle.surrogate.library import wheel_library

# u is a sum of seven terms of up to ~10, rounded each (1.6e-14); the wrench is 421·u² with u ≤ 3,
# its derivative 2·421·210·u.
WRENCH_ROUNDING = 1e-10
STIFFNESS_ROUNDING = 1e-8


def test_the_files_in_the_tree_are_what_their_script_makes(
    tiny: ModuleType, tmp_path: Path
) -> None:
    tiny.write(tmp_path)
    for name in ("tiny_surrogate.onnx", "tiny_surrogate_wrench.onnx"):
        kept = Path(tiny.__file__).with_name(name).read_bytes()
        assert (tmp_path / name).read_bytes() == kept
        assert len(kept) < 20_000


def test_loads_are_the_closed_forms(tiny: ModuleType, tiny_file: Path, poses: np.ndarray) -> None:
    model = load_surrogate(tiny_file)
    assert isinstance(model, OnnxContactModel)
    assert isinstance(model, ContactModel)
    assert model.side_of_body.name == "left"
    assert Path(model.file) == tiny_file
    loads = model.evaluate(poses, Derivatives.stiffness, 1)
    depth = np.maximum(poses @ tiny.DIRECTION.T + tiny.OFFSET, 0)
    assert 0.2 < np.mean(depth > 0) < 0.8
    wrench = depth[:, :, None] ** 2 * tiny.SCALE
    stiffness = 2 * depth[:, :, None, None] * tiny.SCALE[:, :, None] * tiny.DIRECTION[:, None, :]
    outside = np.max(np.abs(poses - tiny.CENTRE) / tiny.HALF_WIDTH, axis=1) - 1
    np.testing.assert_allclose(loads.wrench, wrench, rtol=0, atol=WRENCH_ROUNDING)
    np.testing.assert_allclose(loads.stiffness, stiffness, rtol=0, atol=STIFFNESS_ROUNDING)
    np.testing.assert_array_equal(loads.error, np.broadcast_to(tiny.ERROR, (len(poses), 2, 6)))
    np.testing.assert_allclose(loads.trust, 1 - np.clip(outside, 0, 1), rtol=0, atol=1e-14)
    assert not loads.implausible_depth.any()
    assert model.evaluate(poses, Derivatives.none, 1).stiffness is None


def test_threads_do_not_change_a_byte(exported: tuple[Path, Path], poses: np.ndarray) -> None:
    model = load_surrogate(exported[0])
    many = np.tile(poses, (11, 1))  # 3300: three pieces and a bit
    one = model.evaluate(many, Derivatives.stiffness, 1)
    for threads in (0, 2, 3):
        other = model.evaluate(many, Derivatives.stiffness, threads)
        for name in ("wrench", "stiffness", "error", "trust"):
            assert getattr(one, name).tobytes() == getattr(other, name).tobytes()


def test_stiffness_of_an_exported_file_is_its_derivative(
    exported: tuple[Path, Path], tiny: ModuleType
) -> None:
    model = load_surrogate(exported[0])
    rng = np.random.default_rng(5)
    points = tiny.CENTRE + rng.uniform(-0.9, 0.9, (40, 6)) * tiny.HALF_WIDTH
    loads = model.evaluate(points, Derivatives.stiffness, 1)
    step = 1e-5 * tiny.HALF_WIDTH
    compared = 0
    for j in range(6):
        shift = np.eye(6)[j] * step[j]
        after = model.evaluate(points + shift, Derivatives.none, 1).wrench
        before = model.evaluate(points - shift, Derivatives.none, 1).wrench
        # The gate jumps: compare where it stays open on both sides of the step.
        loaded = (after[:, :, 1] > 0) & (before[:, :, 1] > 0)
        difference = ((after - before) / (2 * step[j]))[loaded]
        exact = loads.stiffness[:, :, :, j][loaded]
        # Truncation h²/6·f''' of tanh nets over a unit box, h = 1e-5: ~1e-9 of the derivative's
        # size; rounding ε·|f|/h: ~1e-10 of it.
        scale = np.abs(exact).max(axis=0)
        assert (scale > 0).all()
        assert (np.abs(exact - difference) <= 1e-6 * scale).all()
        assert (exact != difference).any()
        compared += int(loaded.sum())
    assert compared > 100


def test_a_wrench_only_file_has_the_same_wrench_and_unknown_trust(
    exported: tuple[Path, Path], poses: np.ndarray
) -> None:
    full, wrench_only = (load_surrogate(file) for file in exported)
    assert full.has_stiffness
    assert not wrench_only.has_stiffness
    expected = full.evaluate(poses, Derivatives.none, 1)
    loads = wrench_only.evaluate(poses, Derivatives.none, 1)
    rms = np.sqrt(np.mean(expected.wrench**2, axis=(0, 1)))
    assert (np.abs(loads.wrench - expected.wrench) <= 1e-9 * (np.abs(expected.wrench) + rms)).all()
    assert np.isnan(loads.trust).all()
    assert np.isnan(loads.error).all()
    assert np.isfinite(expected.trust).all()
    with pytest.raises(
        ValueError, match=r"stiffness was asked of a file that has the output wrench alone"
    ):
        wrench_only.evaluate(poses, Derivatives.stiffness, 1)


def test_a_pose_that_is_not_finite_is_refused_by_row(tiny_file: Path, poses: np.ndarray) -> None:
    bad = poses.copy()
    bad[37, 4] = np.nan
    with pytest.raises(ValueError, match=r"^row 37: pose: theta_y is nan: must be finite$"):
        load_surrogate(tiny_file).evaluate(bad, Derivatives.none, 1)


def test_an_exported_file_is_fused_unless_told_otherwise(
    exported: tuple[Path, Path], tiny_file: Path
) -> None:
    model = load_surrogate(exported[0])
    assert model.runtime == Runtime.fused
    assert model.fused_refusal == ""
    assert model.instruction_set in ("baseline", "avx2", "avx512")
    assert load_surrogate(exported[0], runtime="onnxruntime").runtime == Runtime.onnxruntime
    assert describe(exported[0])["runtime"] == "fused"
    other = load_surrogate(tiny_file)
    assert other.runtime == Runtime.onnxruntime
    assert "net_I" in other.fused_refusal
    assert describe(tiny_file)["runtime"].startswith("onnxruntime (not fused: ")
    with pytest.raises(InputDataError, match="the fused runtime does not know its graph"):
        load_surrogate(tiny_file, runtime="fused")
    with pytest.raises(InputDataError, match="must be auto, fused or onnxruntime"):
        load_surrogate(tiny_file, runtime="gpu")


def test_a_fused_surrogate_needs_no_onnxruntime(exported: tuple[Path, Path]) -> None:
    code = (
        "from condyle.surrogate import load_surrogate; "
        f"print(load_surrogate({str(exported[0])!r}).runtime.name)"
    )
    assert _run(code, CONDYLE_ONNXRUNTIME="/nowhere/lib.so") == "fused"


def test_weights_that_are_no_numbers_are_refused_by_name(
    exported: tuple[Path, Path], tmp_path: Path
) -> None:
    model = onnx.load(exported[0])
    weights = {tensor.name: tensor for tensor in model.graph.initializer}["net_I.weight_2"]
    values = onnx.numpy_helper.to_array(weights).copy()
    values[3, 5] = np.nan
    weights.CopyFrom(onnx.numpy_helper.from_array(values, weights.name))
    onnx.save(model, tmp_path / "damaged.onnx")
    with pytest.raises(InputDataError, match=r"constant net_I\.weight_2 is not finite"):
        load_surrogate(tmp_path / "damaged.onnx")


def test_a_hybrid_takes_the_reference_where_trust_is_low(
    exported: tuple[Path, Path], poses: np.ndarray
) -> None:
    surrogate = load_surrogate(exported[0])
    reference = load_surrogate(exported[0], runtime="onnxruntime")
    hybrid = HybridContactModel(surrogate, reference)
    loads = hybrid.evaluate(poses, Derivatives.none, 1)
    known = surrogate.evaluate(poses, Derivatives.none, 1)
    called, alone = known.trust < 0.75, known.trust < 0.5  # blended in between
    assert 0 < alone.sum() <= called.sum() < len(poses)
    assert hybrid.reference_calls == called.sum()
    logged, trust = hybrid.log
    np.testing.assert_array_equal(logged, poses[called])
    np.testing.assert_array_equal(trust, known.trust[called])
    reference_loads = reference.evaluate(poses, Derivatives.none, 1)
    np.testing.assert_array_equal(loads.wrench[alone], reference_loads.wrench[alone])
    np.testing.assert_array_equal(loads.wrench[~called], known.wrench[~called])


def _changed(file: Path, tmp_path: Path, key: str, value: str | None) -> Path:
    model = onnx.load(file)
    metadata = {p.key: p.value for p in model.metadata_props} | {key: value}
    onnx.helper.set_model_props(model, {k: v for k, v in metadata.items() if v is not None})
    changed = tmp_path / "changed.onnx"
    onnx.save(model, changed)
    return changed


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("condyle.contract_version", "2", "metadata condyle.contract_version is '2': must be '1'"),
        (
            "condyle.units",
            "mm,rad,N,Nm",
            "metadata condyle.units is 'mm,rad,N,Nm': must be 'm,rad,N,Nm'",
        ),
        (
            "condyle.side_of_body",
            "both",
            "metadata condyle.side_of_body is 'both': must be 'left' or 'right'",
        ),
        ("condyle.frames", None, "metadata condyle.frames is missing"),
    ],
)
def test_metadata_that_does_not_match_is_refused_by_key(
    exported: tuple[Path, Path], tmp_path: Path, key: str, value: str | None, message: str
) -> None:
    file = _changed(exported[0], tmp_path, key, value)
    with pytest.raises(InputDataError) as caught:
        load_surrogate(file)
    assert str(caught.value).startswith(f"{file}: {message}")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 0.999])
def test_a_truncated_file_is_refused_by_name(
    exported: tuple[Path, Path], tmp_path: Path, share: float
) -> None:
    whole = exported[0].read_bytes()
    file = tmp_path / "truncated.onnx"
    file.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(InputDataError) as caught:
        load_surrogate(file)
    assert str(caught.value).startswith(f"{file}: ")
    assert "\n" not in str(caught.value)


def test_a_missing_file_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(InputDataError, match=r"nowhere\.onnx: cannot be opened for reading$"):
        load_surrogate(tmp_path / "nowhere.onnx")


def test_describe_gives_the_metadata_parsed(exported: tuple[Path, Path], tiny_file: Path) -> None:
    said = describe(exported[0])
    assert list(said)[:5] == ["file", "outputs", "contract_version", "side_of_body", "architecture"]
    assert said["file"] == str(exported[0])
    assert said["outputs"] == ["wrench", "stiffness", "error", "trust"]
    assert said["contract_version"] == "1"
    assert said["architecture"] == "two_stage"
    assert said["training"] == {"seed": 3}
    assert set(said["domain_bounds"]["pose_min"]) == {
        "x",
        "y",
        "z",
        "theta_x",
        "theta_y",
        "theta_z",
    }
    assert describe(exported[1])["outputs"] == ["wrench"]
    assert describe(tiny_file)["implant"] == {"name": "two gated springs"}


def test_the_library_is_the_wheels() -> None:
    assert wheel_library() is not None
    assert onnxruntime_version().startswith("1.")
    assert "onnxruntime" in Path(onnxruntime_library()).name


def _run(code: str, **environment: str) -> str:
    answer = subprocess.run(
        [sys.executable, "-c", code],
        check=True,
        capture_output=True,
        text=True,
        env={**os.environ, **environment},
    )
    assert answer.stderr == ""
    return answer.stdout.strip()


def test_a_surrogate_needs_neither_torch_nor_onnxruntimes_python(tiny_file: Path) -> None:
    code = (
        "import sys; from condyle.surrogate import load_surrogate; "
        f"load_surrogate({str(tiny_file)!r}); "
        "print([m for m in ('torch', 'onnxruntime', 'onnx') if m in sys.modules])"
    )
    assert _run(code) == "[]"


def test_the_core_works_beside_onnxruntimes_python(tiny_file: Path) -> None:
    code = (
        "import onnxruntime; from condyle.surrogate import load_surrogate; import numpy as np; "
        f"from condyle.contact import Derivatives; f = {str(tiny_file)!r}; "
        "p = np.array([[0.0, 0.03, 0, 0, 0, 0]]); "
        "a = load_surrogate(f).evaluate(p, Derivatives.none, 1).wrench; "
        "b = onnxruntime.InferenceSession(f).run(['wrench'], {'pose': p})[0]; "
        "print(abs(a - b).max() < 1e-9, a.any())"
    )
    assert _run(code) == "True True"


def test_an_environment_variable_that_names_nothing_is_an_error(tiny_file: Path) -> None:
    code = (
        "from condyle.surrogate import load_surrogate\n"
        f"try:\n    load_surrogate({str(tiny_file)!r})\n"
        "except ValueError as error:\n    print(error)\n"
    )
    assert _run(code, CONDYLE_ONNXRUNTIME="/nowhere/lib.so") == (
        "CONDYLE_ONNXRUNTIME is '/nowhere/lib.so': no onnxruntime library there"
    )


def test_a_library_that_cannot_be_opened_is_an_error(tiny_file: Path, tmp_path: Path) -> None:
    fake = tmp_path / "libonnxruntime.so.1.99.0"
    fake.write_text("no library\n")
    code = (
        "from condyle.surrogate import load_surrogate\n"
        "from condyle.errors import CondyleError\n"
        f"try:\n    load_surrogate({str(tiny_file)!r})\n"
        "except CondyleError as error:\n    print(error)\n"
    )
    message = _run(code, CONDYLE_ONNXRUNTIME=str(tmp_path))
    assert message.startswith(f"onnxruntime: {fake} cannot be used: ")
    assert message.endswith("set CONDYLE_ONNXRUNTIME to a libonnxruntime.so.1.x.y")
    assert issubclass(InputDataError, CondyleError)
