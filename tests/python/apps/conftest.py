# SPDX-License-Identifier: Apache-2.0
"""condyle-sim, and a coarse implant for it."""

import importlib.util
import os
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[3]
DATA = ROOT / "tests" / "data"
TINY = DATA / "tiny_surrogate.onnx"

Run = Callable[..., subprocess.CompletedProcess[str]]


def _find_program() -> Path | None:
    """CONDYLE_SIM, else the installed package's, else the newest of the build folders."""
    if named := os.environ.get("CONDYLE_SIM"):
        return Path(named)
    spec = importlib.util.find_spec("condyle")
    folders = [Path(f) for f in (spec.submodule_search_locations or [])] if spec else []
    installed = [folder / "bin" / "condyle-sim" for folder in folders]
    built = sorted(
        ROOT.glob("build/**/core/apps/condyle-sim"), key=lambda p: p.stat().st_mtime, reverse=True
    )
    return next((p for p in [*installed, *built] if p.is_file()), None)


@pytest.fixture(scope="session")
def program() -> Path:
    """The executable."""
    found = _find_program()
    if found is None:
        pytest.skip("no condyle-sim: build it, or name it in CONDYLE_SIM")
    return found


@pytest.fixture
def run(program: Path, tmp_path: Path) -> Run:
    """Runs condyle-sim in a folder of its own, without the environment's choice of a library."""

    def call(*arguments: object) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [program, *map(str, arguments)], cwd=tmp_path, env={}, capture_output=True, text=True
        )

    return call


@pytest.fixture(scope="session")
def implant(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a coarse right implant: femur.stl, insert.stl and its two halves [m]."""
    from condyle.implants import generate, preset, write_implant

    folder = tmp_path_factory.mktemp("implant")
    write_implant(folder, generate(replace(preset("curved"), mesh_edge_length=2e-3)))
    return folder


@pytest.fixture
def untrusted(tmp_path: Path) -> Path:
    """The closed-form surrogate, of a right knee and to be trusted nowhere."""
    onnx = pytest.importorskip("onnx")
    model = onnx.load(TINY)
    for node in model.graph.node:
        for i, name in enumerate(node.output):
            if name == "trust":
                node.output[i] = "trust_before"
    model.graph.initializer.append(onnx.numpy_helper.from_array(np.array(0.0), "no_trust"))
    model.graph.node.append(onnx.helper.make_node("Mul", ["trust_before", "no_trust"], ["trust"]))
    metadata = {p.key: p.value for p in model.metadata_props}
    onnx.helper.set_model_props(model, metadata | {"condyle.side_of_body": "right"})
    onnx.save(model, tmp_path / "untrusted.onnx")
    return tmp_path / "untrusted.onnx"
