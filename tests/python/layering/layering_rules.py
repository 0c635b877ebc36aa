# SPDX-License-Identifier: Apache-2.0
"""Which part of Condyle may know which: the rules, and checks of a source tree.

    common → numerics → geometry → contact → surrogate → model → fdk → io → apps, capi, bindings →
    python

A folder includes only what stands to its left, and only what it needs of that. Each check returns
one line a violation, so an empty list is a tree in order.
"""

import ast
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

#: What each folder of core/condyle may include besides itself: folders, or single headers.
CORE_EDGES: dict[str, set[str]] = {
    "common": set(),
    "numerics": {"common"},
    "geometry": {"common"},
    "contact": {"common", "geometry"},
    "surrogate": {"common", "contact/contact_model.hpp"},
    "model": {"common", "numerics"},
    "recruitment": {"common", "numerics"},
    "fdk": {"common", "numerics", "model", "recruitment", "contact/contact_model.hpp"},
    # A load case is a plain struct of columns; reading one needs nothing else of fdk.
    "io": {"common", "numerics", "model", "geometry", "fdk/load_case.hpp"},
    "capi": {"common", "numerics", "contact/contact_model.hpp", "surrogate", "model", "fdk"},
}
#: Part of condyle::core although its folder is not: the interface that all contact models share.
CONTACT_MODEL = ("contact/contact_model.hpp", "contact/contact_model.cpp")
#: Folders whose sources are compiled into a library.
LIBRARY_OF = {
    "common": "condyle_core",
    "numerics": "condyle_core",
    "surrogate": "condyle_core",
    "model": "condyle_core",
    "recruitment": "condyle_core",
    "fdk": "condyle_core",
    "geometry": "condyle_contact",
    "contact": "condyle_contact",
    "io": "condyle_io",
    "capi": "condyle_capi",
}
#: What each library may link (besides flags, threads and dl); CGAL is GPL and belongs to
#: condyle_contact alone.
LINK_EDGES: dict[str, set[str]] = {
    "condyle_core": {"Eigen3::Eigen", "condyle_onnxruntime_headers"},
    "condyle_contact": {"condyle::core", "CGAL::CGAL"},
    "condyle_io": {"condyle::core", "condyle::contact", "pugixml::pugixml"},
    "condyle_capi": {"condyle::core"},
}
LINK_ALWAYS = {
    "PUBLIC",
    "PRIVATE",
    "INTERFACE",
    "Threads::Threads",
    "${CMAKE_DL_LIBS}",
    "condyle_flags",
}
#: Headers of other projects, by how their include begins, and where they may be included.
THIRD_PARTY: dict[str, str] = {
    "CGAL/": r"core/condyle/geometry/[^/]+\.cpp",
    "boost/": r"core/condyle/geometry/[^/]+\.cpp",
    "onnxruntime": r"core/condyle/surrogate/[^/]+\.cpp",
    "CLI/": r"core/apps/.*",
    "nanobind/": r"bindings/.*",
    "doctest/": r"tests/cpp/.*",
    "pugixml": r"core/condyle/io/[^/]+\.cpp",
    "nlohmann/": r"(core/.*|tests/cpp/.*)\.cpp",
}
#: Public headers that need no test of their own, and why.
HEADERS_WITHOUT_TEST = {
    "common/types.hpp": "names of types only",
    "model/model_description.hpp": "plain data",
    "contact/fast_kernel_body.hpp": "the body of the kernels, tested as such",
    "contact/fast_points.hpp": "as fast_field.hpp",
    "contact/fast_field.hpp": "the field within the kernels, tested against DistanceField through them",
    "contact/fast_vector.hpp": "the vectors of the kernels, tested with them",
    "contact/fast_vector_avx2.hpp": "as fast_vector.hpp",
    "contact/fast_vector_avx512.hpp": "as fast_vector.hpp",
    "contact/fast_vector_baseline.hpp": "as fast_vector.hpp",
    "surrogate/dense_kernel_body.hpp": "the body of the kernels, tested as dense_kernels.hpp",
    "surrogate/dense_vector.hpp": "the vectors of the kernels, tested with them",
    "surrogate/wrench_networks.hpp": "an interface; what implements it is tested",
}
#: Python packages from the bottom up; a package imports those above it in this list never, those on
#: its line freely.
PYTHON_RANKS: list[set[str]] = [
    {"conventions", "errors", "markdown", "whole_files"},
    {"implants", "contact", "activities", "fdk", "model", "opensim", "recruitment", "surrogate"},
    {"sampling", "training"},
    {"evaluation"},
    {"report"},
    {"study"},
    {"cli"},
]
#: The thin wrappers: the only ones to import the C++ extension.
CORE_WRAPPERS = {"contact", "fdk", "model", "recruitment", "surrogate", "activities"}
#: Modules of other projects, and the only packages that may import them.
PYTHON_THIRD_PARTY: dict[str, set[str]] = {
    "torch": {"training"},
    "markdown_it": {"report"},
    "matplotlib": {"report"},
    "vtkmodules": {"report"},
    "vtk": {"report"},
    "typer": {"cli"},
    "opensim": {"opensim"},
    "distributed": {"sampling"},
}

_INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)
_CPP = {".hpp", ".cpp", ".h", ".cc", ".inc"}


def cpp_files(root: Path) -> Iterator[Path]:
    """Every C++ file of the project, in a fixed order."""
    for folder in ("core", "bindings", "tests"):
        yield from (p for p in sorted((root / folder).rglob("*")) if p.suffix in _CPP)


def includes(file: Path) -> list[str]:
    """What a C++ file includes, as written."""
    return _INCLUDE.findall(file.read_text(encoding="utf-8"))


def check_core_includes(root: Path) -> list[str]:
    """Edges between the folders of core/condyle."""
    found = []
    for file in cpp_files(root):
        parts = file.relative_to(root).parts
        if parts[:2] != ("core", "condyle"):
            continue
        folder, name = parts[2], "/".join(parts[2:])
        if folder not in CORE_EDGES:
            found.append(f"core/condyle/{folder}: a folder that the layering does not know")
            continue
        allowed = CORE_EDGES[folder] | {folder}
        if name in CONTACT_MODEL:
            allowed = {"common", *CONTACT_MODEL}
        for include in includes(file):
            if not include.startswith("condyle/"):
                if file.parent.joinpath(include).exists():
                    found.append(f"core/condyle/{name}: includes {include} by a relative path")
                continue
            target = include.removeprefix("condyle/")
            if target not in allowed and target.split("/")[0] not in allowed:
                found.append(f"core/condyle/{name}: must not include {include}")
    return found


def check_third_party_includes(root: Path) -> list[str]:
    """CGAL in geometry's .cpp files only, onnxruntime in exactly one .cpp, and so on."""
    found, onnxruntime_files = [], []
    for file in cpp_files(root):
        name = file.relative_to(root).as_posix()
        for include in includes(file):
            for begin, where in THIRD_PARTY.items():
                if include.startswith(begin) and not re.fullmatch(where, name):
                    found.append(f"{name}: must not include {include}")
            if include.startswith("onnxruntime"):
                onnxruntime_files.append(name)
    if len(set(onnxruntime_files)) != 1:
        found.append(
            f"onnxruntime is included by {sorted(set(onnxruntime_files))}: must be one .cpp"
        )
    return found


def cmake_commands(root: Path, command: str) -> Iterator[tuple[Path, list[str]]]:
    """(file, words) of each call of a CMake command, comments taken out."""
    for file in sorted([*root.rglob("CMakeLists.txt"), *root.glob("cmake/*.cmake")]):
        if {".venv", "build", ".cache"} & set(file.relative_to(root).parts):
            continue
        text = re.sub(r"#.*", "", file.read_text(encoding="utf-8"))
        for body in re.findall(rf"\b{command}\s*\(([^)]*)\)", text):
            yield file, body.split()


def check_links(root: Path) -> list[str]:
    """Link lines: only condyle_contact links CGAL, and nothing onnxruntime."""
    found = []
    for file, (target, *libraries) in cmake_commands(root, "target_link_libraries"):
        name = file.relative_to(root).as_posix()
        for library in libraries:
            if library in LINK_ALWAYS:
                continue
            if (target in LINK_EDGES and library not in LINK_EDGES[target]) or (
                library.lower().startswith("cgal") and target != "condyle_contact"
            ):
                found.append(f"{name}: {target} must not link {library}")
            elif library.lower().startswith("onnxruntime"):
                found.append(f"{name}: {target} must not link {library}: it is opened at run time")
    return found


def check_sources(root: Path) -> list[str]:
    """Each source is listed once, in its own folder, for the library that its folder belongs to."""
    found, listed = [], set()
    for file, (target, *sources) in cmake_commands(root, "target_sources"):
        folder = file.parent
        if folder.parent != root / "core" / "condyle":
            continue
        for source in sources:
            if source in LINK_ALWAYS:
                continue
            name = f"{folder.name}/{source}"
            listed.add(name)
            library = "condyle_core" if name in CONTACT_MODEL else LIBRARY_OF.get(folder.name)
            if target != library:
                found.append(f"core/condyle/{name}: is in {target}: must be in {library}")
    for source in sorted((root / "core" / "condyle").rglob("*.cpp")):
        name = source.relative_to(root / "core" / "condyle").as_posix()
        if name not in listed:
            found.append(f"core/condyle/{name}: is in no library")
    return found


def check_tests_mirror(root: Path) -> list[str]:
    """Every header of core/condyle has a test_<header>.cpp in the test folder of the same name."""
    found = []
    for header in sorted((root / "core" / "condyle").rglob("*.hpp")):
        name = header.relative_to(root / "core" / "condyle")
        if name.as_posix() in HEADERS_WITHOUT_TEST:
            continue
        test = root / "tests" / "cpp" / name.parent / f"test_{name.stem}.cpp"
        if not test.exists():
            found.append(f"core/condyle/{name.as_posix()}: no {test.relative_to(root).as_posix()}")
    return found


def imports(file: Path) -> set[str]:
    """Full dotted names that a Python file imports, wherever in it: `from a import b` gives a.b."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"), str(file))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            if node.level:
                names.add("(relative)")
            else:
                names |= {f"{node.module}.{alias.name}" for alias in node.names}
    return names


def _rank(package: str) -> int | None:
    return next((rank for rank, names in enumerate(PYTHON_RANKS) if package in names), None)


def check_python_imports(root: Path) -> list[str]:
    """Edges between the packages of python/condyle, and what they import of others."""
    found = []
    base = root / "python" / "condyle"
    for file in sorted(base.rglob("*.py")):
        name = file.relative_to(root).as_posix()
        package = file.relative_to(base).parts[0].removesuffix(".py")
        rank = _rank(package)
        if rank is None and package != "__init__":
            found.append(f"{name}: a package that the layering does not know")
            continue
        for imported in sorted(imports(file)):
            found += [f"{name}: {why}" for why in _import_faults(package, rank, imported)]
    return found


def _import_faults(package: str, rank: int | None, imported: str) -> Iterable[str]:
    top, *rest = imported.split(".")
    if top == "(relative)":
        yield "imports by a relative path"
    elif top in PYTHON_THIRD_PARTY and package not in PYTHON_THIRD_PARTY[top]:
        yield f"must not import {top}"
    elif top == "condyle" and rest and rest[0] == "_core":
        if package not in CORE_WRAPPERS:
            yield "must not import condyle._core: only its wrappers do"
    elif top == "condyle" and rest and rest[0] != package:
        other = _rank(rest[0])
        if rank is None:
            yield f"must not import {imported}: importing condyle imports nothing else"
        elif other is not None and other > rank:
            yield f"must not import condyle.{rest[0]}, which stands above condyle.{package}"
