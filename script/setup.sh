# Sourced by script/test, demo, docs, nightly, .ci/run and .ci/stages/consumer: Debian packages, quiet builds with a log.
# shellcheck shell=bash disable=SC2034
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
mkdir -p build

# Packages for building, testing and drawing.
packages=(g++ cmake ninja-build ccache libeigen3-dev libboost-dev libfmt-dev doctest-dev
  nlohmann-json3-dev graphviz gnuplot-nox)

# Installs the named Debian packages that are missing; says nothing where all are there.
need() {
  local missing=() package
  for package in "$@"; do
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q '^install ok installed' ||
      missing+=("$package")
  done
  ((${#missing[@]})) || return 0
  if ! command -v apt-get >/dev/null; then
    echo "these Debian 12 packages (or your system's like) must be installed: ${missing[*]}" >&2
    exit 1
  fi
  local root=()
  if ((EUID)); then
    if ! command -v sudo >/dev/null || ! { [[ -t 0 ]] || sudo -n true 2>/dev/null; }; then
      echo "packages are missing, and only root can install them; as root, run" >&2
      echo "  apt-get update && apt-get install --no-install-recommends ${missing[*]}" >&2
      exit 1
    fi
    root=(sudo)
  fi
  echo "installing ${missing[*]}"
  local apt=("${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq)
  logged build/apt.log "${apt[@]}" update
  logged build/apt.log "${apt[@]}" install -y --no-install-recommends "${missing[@]}"
}

# logged LOG COMMAND...: the output goes to LOG; only where the command fails its end is shown,
# without ninja's lines of progress.
logged() {
  local log=$1
  shift
  if ! "$@" >"$log" 2>&1; then
    sed '/^\[[0-9]*\/[0-9]*\] /d' "$log" | tail -n 200 >&2
    echo "failed: $* (log: $log)" >&2
    exit 1
  fi
}

# build PRESET [TARGET...]: configures and builds. On a terminal ninja's own line shows progress;
# elsewhere the output goes to a log, which is shown where the build fails.
build() {
  local preset=$1 targets=() begin=$SECONDS
  shift
  (($# == 0)) || targets=(--target "$@")
  logged "build/$preset-configure.log" cmake --preset "$preset" -DTITOP_CI="${TITOP_CI:-OFF}" \
    ${TITOP_WERROR:+"-DTITOP_WERROR=$TITOP_WERROR"} ${TITOP_PYTHON:+"-DTITOP_PYTHON=$TITOP_PYTHON"} \
    ${TITOP_MPI:+"-DTITOP_MPI=$TITOP_MPI"}
  local ninja=(cmake --build --preset "$preset" -j "${JOBS:-$(nproc)}" "${targets[@]}" -- -k 0)
  if [[ -t 1 ]]; then
    "${ninja[@]}"
  else
    echo "building build/$preset (a few minutes the first time; build/$preset-build.log grows)"
    logged "build/$preset-build.log" "${ninja[@]}"
    echo "built build/$preset in $((SECONDS - begin)) s"
  fi
}
