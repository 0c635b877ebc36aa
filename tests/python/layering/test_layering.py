# SPDX-License-Identifier: Apache-2.0
"""The project keeps to its dependency rules, and each rule's check finds what breaks it."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import layering_rules as rules
import pytest

ROOT = Path(__file__).parents[3]

CHECKS: list[Callable[[Path], list[str]]] = [
    rules.check_core_includes,
    rules.check_third_party_includes,
    rules.check_links,
    rules.check_sources,
    rules.check_tests_mirror,
    rules.check_python_imports,
]


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
def test_the_project_keeps_to_the_rule(check: Callable[[Path], list[str]]) -> None:
    assert check(ROOT) == []


GOOD_TREE = {
    "core/CMakeLists.txt": "target_link_libraries(condyle_core PUBLIC Eigen3::Eigen "
    "PRIVATE condyle_flags)\n"
    "target_link_libraries(condyle_contact PUBLIC condyle::core PRIVATE CGAL::CGAL)  # (GPL)\n",
    "core/condyle/common/pose.hpp": "#include <Eigen/Core>\n",
    "core/condyle/common/CMakeLists.txt": "target_sources(condyle_core PRIVATE pose.cpp)\n",
    "core/condyle/common/pose.cpp": '#include "condyle/common/pose.hpp"\n',
    "core/condyle/contact/contact_model.hpp": '#include "condyle/common/pose.hpp"\n',
    "core/condyle/geometry/tree.hpp": '#include "condyle/common/pose.hpp"\n',
    "core/condyle/geometry/tree.cpp": '#include "condyle/geometry/tree.hpp"\n'
    "#include <CGAL/AABB_tree.h>\n",
    "core/condyle/geometry/CMakeLists.txt": "target_sources(condyle_contact PRIVATE\n  tree.cpp)\n",
    "core/condyle/surrogate/session.cpp": "#include <onnxruntime_cxx_api.h>\n"
    '#include "condyle/contact/contact_model.hpp"\n',
    "core/condyle/surrogate/CMakeLists.txt": "target_sources(condyle_core PRIVATE session.cpp)\n",
    "core/apps/main.cpp": '#include <CLI/CLI.hpp>\n#include "condyle/geometry/tree.hpp"\n',
    "tests/cpp/common/test_pose.cpp": "#include <doctest/doctest.h>\n",
    "tests/cpp/contact/test_contact_model.cpp": "",
    "tests/cpp/geometry/test_tree.cpp": "",
    "python/condyle/__init__.py": "from importlib.metadata import version\n",
    "python/condyle/errors.py": "",
    "python/condyle/contact/__init__.py": "from condyle._core import contact\n",
    "python/condyle/training/nets.py": "import torch\nfrom condyle.errors import CondyleError\n",
    "python/condyle/report/figures.py": "def f():\n    import matplotlib.pyplot\n",
    "python/condyle/cli/app.py": "import typer\nfrom condyle import report, training\n",
}

#: What is changed in the good tree, the check that must notice, and what it must say.
BREACHES: list[tuple[str, str, Callable[[Path], list[str]], str]] = [
    (
        "core/condyle/common/pose.hpp",
        '#include "condyle/geometry/tree.hpp"',
        rules.check_core_includes,
        "core/condyle/common/pose.hpp: must not include condyle/geometry/tree.hpp",
    ),
    (
        "core/condyle/contact/contact_model.hpp",
        '#include "condyle/geometry/tree.hpp"',
        rules.check_core_includes,
        "core/condyle/contact/contact_model.hpp: must not include condyle/geometry/tree.hpp",
    ),
    (
        "core/condyle/surrogate/session.cpp",
        '  #  include "condyle/contact/mesh_contact.hpp"',
        rules.check_core_includes,
        "core/condyle/surrogate/session.cpp: must not include condyle/contact/mesh_contact.hpp",
    ),
    (
        "core/condyle/model/body.hpp",
        "#include <condyle/contact/contact_model.hpp>",
        rules.check_core_includes,
        "core/condyle/model/body.hpp: must not include condyle/contact/contact_model.hpp",
    ),
    (
        "core/condyle/fdk/solver.hpp",
        '#include "condyle/io/table.hpp"',
        rules.check_core_includes,
        "core/condyle/fdk/solver.hpp: must not include condyle/io/table.hpp",
    ),
    (
        "core/condyle/io/table.cpp",
        '#include "condyle/fdk/solver.hpp"',
        rules.check_core_includes,
        "core/condyle/io/table.cpp: must not include condyle/fdk/solver.hpp",
    ),
    (
        "core/condyle/geometry/tree.cpp",
        '#include "tree.hpp"',
        rules.check_core_includes,
        "core/condyle/geometry/tree.cpp: includes tree.hpp by a relative path",
    ),
    (
        "core/condyle/misc/all.hpp",
        "",
        rules.check_core_includes,
        "core/condyle/misc: a folder that the layering does not know",
    ),
    (
        "core/condyle/geometry/tree.hpp",
        "#include <CGAL/AABB_tree.h>",
        rules.check_third_party_includes,
        "core/condyle/geometry/tree.hpp: must not include CGAL/AABB_tree.h",
    ),
    (
        "core/condyle/contact/mesh_contact.cpp",
        "#include <CGAL/Surface_mesh.h>",
        rules.check_third_party_includes,
        "core/condyle/contact/mesh_contact.cpp: must not include CGAL/Surface_mesh.h",
    ),
    (
        "core/condyle/surrogate/second.cpp",
        "#include <onnxruntime_c_api.h>",
        rules.check_third_party_includes,
        "onnxruntime is included by ['core/condyle/surrogate/second.cpp', "
        "'core/condyle/surrogate/session.cpp']: must be one .cpp",
    ),
    (
        "core/condyle/surrogate/session.hpp",
        "#include <onnxruntime_cxx_api.h>",
        rules.check_third_party_includes,
        "core/condyle/surrogate/session.hpp: must not include onnxruntime_cxx_api.h",
    ),
    (
        "core/condyle/fdk/solver.cpp",
        "#include <CLI/CLI.hpp>",
        rules.check_third_party_includes,
        "core/condyle/fdk/solver.cpp: must not include CLI/CLI.hpp",
    ),
    (
        "core/condyle/common/pose.cpp",
        "#include <nanobind/nanobind.h>",
        rules.check_third_party_includes,
        "core/condyle/common/pose.cpp: must not include nanobind/nanobind.h",
    ),
    (
        "core/CMakeLists.txt",
        "target_link_libraries(condyle_core\n  PRIVATE CGAL::CGAL)",
        rules.check_links,
        "core/CMakeLists.txt: condyle_core must not link CGAL::CGAL",
    ),
    (
        "core/CMakeLists.txt",
        "target_link_libraries(condyle_core PUBLIC condyle::contact)",
        rules.check_links,
        "core/CMakeLists.txt: condyle_core must not link condyle::contact",
    ),
    (
        "bindings/CMakeLists.txt",
        "target_link_libraries(_core PRIVATE CGAL::CGAL)",
        rules.check_links,
        "bindings/CMakeLists.txt: _core must not link CGAL::CGAL",
    ),
    (
        "core/apps/CMakeLists.txt",
        "target_link_libraries(condyle-sim PRIVATE onnxruntime)",
        rules.check_links,
        "core/apps/CMakeLists.txt: condyle-sim must not link onnxruntime: it is opened at run time",
    ),
    (
        "core/condyle/geometry/CMakeLists.txt",
        "target_sources(condyle_core PRIVATE tree.cpp)",
        rules.check_sources,
        "core/condyle/geometry/tree.cpp: is in condyle_core: must be in condyle_contact",
    ),
    (
        "core/condyle/geometry/forgotten.cpp",
        "",
        rules.check_sources,
        "core/condyle/geometry/forgotten.cpp: is in no library",
    ),
    (
        "core/condyle/geometry/untested.hpp",
        "",
        rules.check_tests_mirror,
        "core/condyle/geometry/untested.hpp: no tests/cpp/geometry/test_untested.cpp",
    ),
    (
        "python/condyle/sampling/plan.py",
        "def f():\n    import torch.nn",
        rules.check_python_imports,
        "python/condyle/sampling/plan.py: must not import torch",
    ),
    (
        "python/condyle/sampling/plan.py",
        "from matplotlib import pyplot",
        rules.check_python_imports,
        "python/condyle/sampling/plan.py: must not import matplotlib",
    ),
    (
        "python/condyle/sampling/plan.py",
        "from condyle import _core",
        rules.check_python_imports,
        "python/condyle/sampling/plan.py: must not import condyle._core: only its wrappers do",
    ),
    (
        "python/condyle/contact/table.py",
        "import condyle.cli.app",
        rules.check_python_imports,
        "python/condyle/contact/table.py: must not import condyle.cli, "
        "which stands above condyle.contact",
    ),
    (
        "python/condyle/errors.py",
        "from condyle import sampling",
        rules.check_python_imports,
        "python/condyle/errors.py: must not import condyle.sampling, "
        "which stands above condyle.errors",
    ),
    (
        "python/condyle/__init__.py",
        "from condyle.contact import MeshContact",
        rules.check_python_imports,
        "python/condyle/__init__.py: must not import condyle.contact.MeshContact: "
        "importing condyle imports nothing else",
    ),
    (
        "python/condyle/sampling/plan.py",
        "from . import domain",
        rules.check_python_imports,
        "python/condyle/sampling/plan.py: imports by a relative path",
    ),
    (
        "python/condyle/misc.py",
        "",
        rules.check_python_imports,
        "python/condyle/misc.py: a package that the layering does not know",
    ),
]


def _write(root: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        file = root / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
def test_a_tree_in_order_passes(check: Callable[[Path], list[str]], tmp_path: Path) -> None:
    _write(tmp_path, GOOD_TREE)
    assert check(tmp_path) == []


@pytest.mark.parametrize(
    ("name", "text", "check", "message"),
    BREACHES,
    ids=[f"{b[0]}-{i}" for i, b in enumerate(BREACHES)],
)
def test_a_breach_is_found(
    name: str, text: str, check: Callable[[Path], list[str]], message: str, tmp_path: Path
) -> None:
    _write(tmp_path, GOOD_TREE)
    _write(tmp_path, {name: GOOD_TREE.get(name, "") + text + "\n"})
    assert message in check(tmp_path)


def test_importing_condyle_imports_no_heavy_module() -> None:
    heavy = ("torch", "matplotlib", "onnxruntime", "onnx", "pyarrow", "pandas", "condyle._core")
    code = f"import sys, condyle; print([m for m in {heavy!r} if m in sys.modules])"
    answer = subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True
    )
    assert answer.stdout.strip() == "[]"


@pytest.mark.parametrize("package", sorted(set().union(*rules.PYTHON_RANKS) - {"training"}))
def test_only_training_imports_torch(package: str) -> None:
    place = ROOT / "python" / "condyle" / package
    if not place.is_dir() and not place.with_suffix(".py").is_file():
        pytest.fail(f"condyle.{package} is named in PYTHON_RANKS but does not exist")
    code = f"import sys, condyle.{package}; print('torch' in sys.modules)"
    answer = subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True
    )
    assert answer.stdout.strip() == "False"
