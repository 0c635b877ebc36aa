#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Everything from a bare Debian 12+ or Ubuntu 24.04+ machine, in one command:
#
#   ./dev.sh demo    installs what is missing, builds, runs the main job on the built-in implant (runs/demo)
#   ./dev.sh test    installs what is missing, builds, lints and runs every test
#   ./dev.sh build   installs what is missing and builds
#   ./dev.sh bench   builds and runs the benchmarks (they print their own tables)
#
# Every step is skipped when nothing that it depends on has changed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
ROOT=$PWD
VENV=$ROOT/.venv
CACHE=$ROOT/.cache
# The CPU build by its exact version: a plain `torch` may bring gigabytes of CUDA libraries.
TORCH_VERSION=2.13.0
SYSTEM_PACKAGES=(build-essential ccache libcgal-dev libeigen3-dev doctest-dev libcli11-dev libpugixml-dev nlohmann-json3-dev
  python3-dev python3-venv valgrind)

say() { printf '\033[1m▸ %s\033[0m\n' "$*"; }

as_root() { if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi; }

install_system_packages() {
  local missing=()
  for package in "${SYSTEM_PACKAGES[@]}"; do
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return
  say "installing ${missing[*]}"
  as_root apt-get update -qq
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}

# onnxruntime's C++ headers: the system's package where there is one; else the package of the next release of the same
# distribution, through the system's own mirror and keyring, unpacked into .cache (headers only, nothing is installed).
fetch_onnxruntime_headers() {
  local header=onnxruntime_cxx_api.h
  [ -n "$(find /usr/include/onnxruntime "$CACHE/onnxruntime" -name $header -print -quit 2>/dev/null)" ] && return
  if apt-cache show libonnxruntime-dev >/dev/null 2>&1; then
    say "installing libonnxruntime-dev"
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends libonnxruntime-dev >/dev/null
    return
  fi
  local distribution suite keyring uri work component=main
  distribution=$(. /etc/os-release && echo "$ID")
  case $distribution in
    ubuntu) suite=resolute; keyring=/usr/share/keyrings/ubuntu-archive-keyring.gpg; component=universe ;;
    *) suite=trixie; keyring=/usr/share/keyrings/debian-archive-keyring.gpg ;;
  esac
  uri=$(apt-get indextargets --format '$(REPO_URI) $(ORIGIN)' 2>/dev/null | grep -i " $distribution\$" |
    grep -v -i security | head -n 1 | cut -d ' ' -f 1)
  [ -n "$uri" ] || { echo "dev.sh: no $distribution mirror in apt's sources to take libonnxruntime-dev from" >&2; exit 1; }
  say "fetching onnxruntime's headers ($suite) into .cache"
  work=$(mktemp -d)
  chmod 755 "$work"
  mkdir -p "$work"/{parts,lists/partial,cache/archives/partial}
  printf 'Types: deb\nURIs: %s\nSuites: %s\nComponents: %s\nSigned-By: %s\n' \
    "$uri" "$suite" "$component" "$keyring" >"$work/parts/next.sources"
  local apt=(apt-get -qq -o Dir::Etc::sourcelist=/dev/null -o "Dir::Etc::sourceparts=$work/parts"
    -o "Dir::State::lists=$work/lists" -o "Dir::Cache=$work/cache" -o APT::Sandbox::User=root)
  "${apt[@]}" update
  (cd "$work" && "${apt[@]}" download libonnxruntime-dev)
  mkdir -p "$CACHE/onnxruntime"
  dpkg-deb -x "$work"/libonnxruntime-dev_*.deb "$CACHE/onnxruntime"
  rm -rf "$work"
}

# Runs "$@" unless the files listed on standard input have the same content as when it last succeeded.
once_per_content() {
  local name=$1 digest
  shift
  digest=$(sort -u | tr '\n' '\0' | xargs -0 sha256sum | sha256sum | cut -d ' ' -f 1)
  [ "$(cat "$CACHE/stamps/$name" 2>/dev/null)" = "$digest" ] && return
  "$@"
  mkdir -p "$CACHE/stamps"
  echo "$digest" >"$CACHE/stamps/$name"
}

create_environment() {
  say "creating the Python environment"
  [ -x "$VENV/bin/python" ] || python3 -m venv "$VENV"
  local pip=("$VENV/bin/python" -m pip install --quiet --disable-pip-version-check)
  "${pip[@]}" --upgrade pip
  "${pip[@]}" numpy
  "${pip[@]}" "torch==$TORCH_VERSION+cpu" 2>/dev/null || "${pip[@]}" "torch==$TORCH_VERSION"
  # Everything that pyproject.toml names, without building the project yet.
  "$VENV/bin/python" - <<'PY' >"$CACHE/requirements.txt"
import tomllib

project = tomllib.load(open("pyproject.toml", "rb"))
print(*project["build-system"]["requires"], "cmake>=3.24", "ninja", sep="\n")
print(*project["project"]["dependencies"], sep="\n")
for extra in ("train", "report", "vtk", "cluster", "test", "lint"):
    print(*project["project"]["optional-dependencies"][extra], sep="\n")
PY
  "${pip[@]}" -r "$CACHE/requirements.txt"
  # Its wheels are for some Pythons only; what needs it skips where it is missing.
  "${pip[@]}" "opensim>=4.6,<4.7" "ezc3d>=1.5" || say "no opensim for this Python: its tests will be skipped"
}

build() {
  say "building the C++ core, condyle-sim, the Python extension and the C++ tests"
  PATH=$VENV/bin:$PATH CONDYLE_TESTS=ON CMAKE_BUILD_PARALLEL_LEVEL=$(nproc) CMAKE_GENERATOR=Ninja \
    "$VENV/bin/python" -m pip install --quiet --disable-pip-version-check --no-build-isolation --no-deps --editable .
  mkdir -p "$ROOT/build/bin"
  ln -sf ../python/core/apps/condyle-sim "$ROOT/build/bin/condyle-sim"
}

build_inputs() {
  find CMakeLists.txt pyproject.toml cmake core bindings tests/cpp -type f
  # A new module or data file needs no build, an editable installation sees it; a rename of the package would.
}

prepare() {
  mkdir -p "$CACHE"
  install_system_packages
  fetch_onnxruntime_headers
  [ -x "$VENV/bin/python" ] || rm -f "$CACHE/stamps/environment" "$CACHE/stamps/build"
  echo pyproject.toml | once_per_content environment create_environment
  [ -x "$ROOT/build/bin/condyle-sim" ] || rm -f "$CACHE/stamps/build"
  build_inputs | once_per_content build build
}

run_tests() {
  say "lint: ruff and mypy"
  "$VENV/bin/ruff" check --quiet .
  "$VENV/bin/mypy" --no-error-summary
  say "C++ tests"
  "$VENV/bin/ctest" --test-dir build/python --output-on-failure --parallel "$(nproc)"
  say "Python tests"
  OMP_NUM_THREADS=1 "$VENV/bin/python" -m pytest -q
}

case ${1:-} in
  build) prepare ;;
  test)
    prepare
    run_tests
    ;;
  demo)
    prepare
    shift
    "$VENV/bin/condyle" demo "$@"
    ;;
  bench)
    prepare
    PATH=$VENV/bin:$PATH cmake --preset benchmarks >/dev/null
    PATH=$VENV/bin:$PATH cmake --build --preset benchmarks
    for program in build/benchmarks/tests/benchmarks/*; do
      [ -f "$program" ] && [ -x "$program" ] || continue
      case $program in
        # Wants the files of a subject, which this makes (it sets OpenSim beside the program).
        *musculoskeletal_speed) "$VENV/bin/python" tests/benchmarks/musculoskeletal_speed.py --program "$program" ;;
        *) "$program" ;;
      esac
    done
    ;;
  *)
    sed -n '3,10s/^# \{0,1\}//p' dev.sh
    exit 2
    ;;
esac
