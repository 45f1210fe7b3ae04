#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs the OpenVINO runtime (the PyPI wheel, pinned by version and digest, with C++ headers and CMake files) into
# build/deps/openvino, or into the folder given. Needs python3 with pip. Nothing outside that folder is touched; a
# second run does nothing. Wheels before 2026 are built with the old C++ ABI and do not link with OpenCV.
set -euo pipefail

version=2026.4.1
root=$(cd "$(dirname "$0")/.." && pwd)
target=${1:-$root/build/deps/openvino}

# The Python version in the wheel's name does not matter: its C++ libraries are used, never its Python module.
case $(uname -m) in
  x86_64)
    platform=manylinux_2_28_x86_64
    sha256=6b4375c17ddcac83a5180349e2e2bb811185c261066e2a920659892d58ef0e3b ;;
  aarch64)
    platform=manylinux_2_35_aarch64
    sha256=82efccb2f9f1bdc7e5a1996e05a3b719ebff9232dd54b44150d6d2e983a86b7d ;;
  *)
    echo "install_openvino.sh: no wheel for $(uname -m); build without it (--segmenter stored or none)" >&2
    exit 1 ;;
esac

if [[ -f $target/.version && $(<"$target/.version") == "$version" ]]; then
  echo "OpenVINO $version is in $target"
  exit 0
fi
if ! python3 -m pip --version >/dev/null 2>&1; then
  echo "install_openvino.sh: python3 with pip is wanted (Debian, Ubuntu: apt-get install python3-pip)" >&2
  exit 1
fi

mkdir -p "$(dirname "$target")"
staging=$(mktemp -d "$target.XXXXXX")
trap 'rm -rf "$staging"' EXIT
export PIP_ROOT_USER_ACTION=ignore
echo "openvino==$version --hash=sha256:$sha256" >"$staging/requirements.txt"
python3 -m pip install --quiet --disable-pip-version-check --no-deps --no-compile \
  --require-hashes --only-binary=:all: --implementation cp --python-version 3.12 --platform "$platform" \
  --target "$staging/wheel" -r "$staging/requirements.txt"
# What runs on graphics and neural processors, and the Python module, are two thirds of the size and never used here.
rm -rf "$staging"/wheel/openvino/libs/{libopenvino_intel_gpu_plugin.so,libopenvino_intel_npu_plugin.so,cache.json} \
  "$staging"/wheel/openvino/_pyopenvino*.so
echo "$version" >"$staging/wheel/.version"
rm -rf "$target"
mv "$staging/wheel" "$target"
echo "OpenVINO $version installed in $target"
