#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what is missing to build and test: Debian 12, Ubuntu 22.04 and 24.04; as root or with sudo.
# Quick when all is there. Where it cannot install, it says exactly what is wanted and exits with 1.
#   scripts/install_dependencies.sh [--tests]     --tests: the Python tools of the tests as well (into build/venv*)
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

PACKAGES=(
  g++ cmake ninja-build ccache
  libeigen3-dev libopencv-dev libyaml-cpp-dev nlohmann-json3-dev libspdlog-dev libcli11-dev
  libcurl4-openssl-dev libssl-dev libboost-dev libarchive-dev
  libgtest-dev libgmock-dev
  python3 python3-venv python3-pip
  ca-certificates
)
WANTED="g++ >= 11, CMake >= 3.22, Ninja, Eigen 3.4, OpenCV 4.5 - 4.x, yaml-cpp 0.7 - 0.8,
nlohmann-json 3.10 - 3.x, spdlog 1.9 - 1.x, CLI11 2.1 - 2.x, libcurl >= 7.81, OpenSSL 3, Boost >= 1.74 (headers), libarchive >= 3.4, GoogleTest >= 1.11,
Python 3.8 or newer with venv; ccache is optional"

# Without dpkg, whether all is there can only be told by trying.
check_without_dpkg() {
  local trial status=0
  trial=$(mktemp -d)
  if command -v cmake ninja g++ python3 >/dev/null && cmake -S "$ROOT" -B "$trial" -G Ninja >"$trial/log" 2>&1; then
    say "All dependencies are there."
  else
    printf 'error: this system has no apt, and something is missing. Wanted are\n%s.\n' "$WANTED" >&2
    printf 'On Debian and Ubuntu these are the packages\n  %s\n' "${PACKAGES[*]}" >&2
    [ -f "$trial/log" ] && sed -n '/Missing dependencies/,/^Call Stack/p' "$trial/log" | grep -v '^Call Stack' >&2
    status=1
  fi
  rm -rf "$trial"
  return "$status"
}

missing_packages() {
  local package
  for package in "${PACKAGES[@]}"; do
    if [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" != installed ]; then
      echo "$package"
    fi
  done
}

install_packages() {
  local missing sudo=()
  mapfile -t missing < <(missing_packages)
  ((${#missing[@]})) || return 0
  if [ "$(id -u)" != 0 ]; then
    if ! command -v sudo >/dev/null; then
      die "these packages are missing, and neither root nor sudo is there to install them:
  apt-get install ${missing[*]}"
    fi
    sudo=(sudo)
    sudo -v || die "these packages are missing; install them with: sudo apt-get install ${missing[*]}"
  fi
  say "Missing packages: ${missing[*]}"
  step "Updating the package list" "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update ||
    say "going on with the list that is there"
  step "Installing ${#missing[@]} packages" "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y --no-install-recommends "${missing[@]}" ||
    die "could not install. Wanted: apt-get install ${missing[*]}"
}

# install_python NAME REQUIREMENTS: an environment of its own in build/NAME, as tests/REQUIREMENTS pins it.
install_python() {
  local venv=$ROOT/build/$1 wanted=$ROOT/tests/$2 stamp=$ROOT/build/$1/requirements.txt
  cmp -s "$wanted" "$stamp" && return 0
  mkdir -p "$ROOT/build"
  if step "Creating build/$1" python3 -m venv "$venv" &&
    step "Installing the Python packages of tests/$2" "$venv/bin/python" -m pip install --disable-pip-version-check \
      --no-compile -r "$wanted"; then
    cp "$wanted" "$stamp"
  else
    say "Going on without them: the tests that need them are skipped."
  fi
}

main() {
  if command -v apt-get >/dev/null && command -v dpkg-query >/dev/null; then
    install_packages
  else
    check_without_dpkg
  fi
  # OpenVINO, the default segmentation back end; the rest builds and runs without it.
  if [ -f "$ROOT/scripts/install_openvino.sh" ]; then
    bash "$ROOT/scripts/install_openvino.sh" || say "Going on without OpenVINO: --segmenter openvino will not be there."
  fi
  if [ "${1:-}" = --tests ]; then
    install_python venv requirements.txt  # evo, clang-format
    install_python venv-kserve requirements-kserve.txt
  fi
}

case "${1:-}" in
  "" | --tests) main "$@" ;;
  -h | --help) sed -n '2,4s/^# //p' "${BASH_SOURCE[0]}" ;;
  *) die "unknown option $1 (try --help)" ;;
esac
