# SPDX-License-Identifier: Apache-2.0
"""The installed libcondyle from C and ctypes: what the page docs/c_abi.md tells, run as told."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
FILE = ROOT / "tests" / "data" / "tiny_two_stage.onnx"
POSE = ["0.0041", "0.0398", "0.0006", "-0.013", "0.037", "-0.41"]


def _builds() -> list[Path]:
    """Build trees that may hold the library, the newest first."""
    named = os.environ.get("CONDYLE_BUILD")
    folders = [Path(named)] if named else [p for p in (ROOT / "build").glob("*") if p.is_dir()]
    found = [f for f in folders if (f / "core" / "libcondyle.so").exists()]
    return sorted(found, key=lambda f: (f / "core" / "libcondyle.so").stat().st_mtime, reverse=True)


@pytest.fixture(scope="module")
def prefix(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with libcondyle installed, laid out as ``cmake --install`` does it."""
    builds = _builds()
    if not builds:
        pytest.skip("no build tree with libcondyle (set CONDYLE_BUILD, or ./dev.sh build)")
    folder = tmp_path_factory.mktemp("prefix")
    script = builds[0] / "core" / "condyle" / "capi" / "cmake_install.cmake"
    cmake = Path(sys.executable).parent / "cmake"
    command = [str(cmake) if cmake.exists() else "cmake", f"-DCMAKE_INSTALL_PREFIX={folder}"]
    subprocess.run([*command, "-P", str(script)], check=True, capture_output=True)
    return folder


def _library(prefix: Path) -> Path:
    found = sorted(prefix.rglob("libcondyle.so"))
    assert len(found) == 1
    return found[0]


@pytest.fixture(scope="module")
def program(prefix: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The C example, built by the system's C compiler against what is installed."""
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler")
    made = tmp_path_factory.mktemp("c") / "evaluate"
    folder = _library(prefix).parent
    header = next(prefix.rglob("condyle.h")).parent
    warnings = ["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror"]
    source = ROOT / "docs" / "examples" / "c" / "evaluate.c"
    paths = [f"-I{header}", f"-L{folder}", "-lcondyle", f"-Wl,-rpath,{folder}"]
    subprocess.run([compiler, *warnings, str(source), *paths, "-o", str(made)], check=True)
    return made


def _run(*command: object) -> str:
    answer = subprocess.run([str(c) for c in command], check=True, capture_output=True, text=True)
    assert answer.stderr == ""
    return answer.stdout


def test_the_library_shows_its_c_functions_and_nothing_else(prefix: Path) -> None:
    if shutil.which("nm") is None:
        pytest.skip("no nm")
    symbols = _run("nm", "-D", "--defined-only", _library(prefix)).splitlines()
    shown = {line.split()[-1] for line in symbols}
    header = next(prefix.rglob("condyle.h")).read_text(encoding="utf-8")
    declared = set(re.findall(r"\b(condyle_\w+)\(", header))
    assert shown == declared
    assert len(shown) >= 9


def test_the_library_needs_neither_cgal_nor_python(prefix: Path) -> None:
    if shutil.which("ldd") is None:
        pytest.skip("no ldd")
    needed = _run("ldd", _library(prefix)).lower()
    assert "libstdc++" in needed
    for unwanted in ("cgal", "gmp", "mpfr", "python", "onnxruntime", "boost"):
        assert unwanted not in needed


def test_the_c_example_runs(program: Path) -> None:
    text = _run(program, FILE, *POSE)
    assert "trust 1.000" in text
    assert "lowered by 0.4 mm" in text
    assert "hybrid: Fy 20000.0 N by the reference, called 1 time(s)" in text


def test_the_c_example_is_clean_under_valgrind(program: Path) -> None:
    if shutil.which("valgrind") is None:
        pytest.skip("no valgrind")
    options = ["-q", "--error-exitcode=9", "--leak-check=full", "--errors-for-leak-kinds=all"]
    assert "hybrid: Fy" in _run("valgrind", *options, program, FILE, *POSE)


def test_the_ctypes_example_runs(prefix: Path, program: Path) -> None:
    script = ROOT / "docs" / "examples" / "evaluate_ctypes.py"
    text = _run(sys.executable, "-I", script, _library(prefix), FILE, *POSE)
    assert "fused, right knee" in text
    assert "hybrid: Fy 20000.0 N by the reference, 1 call(s)" in text
    # The same numbers as from C.
    from_c = re.search(r"Fy \[N\]\s+(\S+) ", _run(program, FILE, *POSE))
    from_python = re.search(r"Fy  medial\s+(\S+)", text)
    assert from_c is not None
    assert from_python is not None
    assert from_c[1] == from_python[1]


def test_pkg_config_finds_it(prefix: Path) -> None:
    if shutil.which("pkg-config") is None:
        pytest.skip("no pkg-config")
    descriptions = sorted(prefix.rglob("condyle.pc"))
    if not descriptions:
        pytest.skip("a wheel's layout: no pkg-config file")
    environment = {**os.environ, "PKG_CONFIG_PATH": str(descriptions[0].parent)}
    flags = subprocess.run(
        ["pkg-config", "--cflags", "--libs", "condyle"],
        check=True,
        capture_output=True,
        text=True,
        env=environment,
    ).stdout
    assert "-lcondyle" in flags
    assert Path(re.findall(r"-I(\S+)", flags)[0], "condyle.h").exists()
