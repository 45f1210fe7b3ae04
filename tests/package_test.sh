#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs the build into an empty folder, builds the example against the installed package alone, and runs it.
#   package_test.sh CMAKE BUILD_FOLDER
set -euo pipefail
cmake=$1
build=$2
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$cmake" --install "$build" --prefix "$work/prefix" >"$work/install.log"
for file in bin/rds include/rds/system/slam.h share/rds/config/tum_fr3.yaml; do
  [ -f "$work/prefix/$file" ] || { echo "not installed: $file"; exit 1; }
done
# The example must find all it needs below the prefix: build it from a copy, away from the sources.
cp -r "$root/examples" "$work/examples"
"$cmake" -S "$work/examples" -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$work/prefix" \
  >"$work/configure.log" || { cat "$work/configure.log"; exit 1; }
"$cmake" --build "$work/build" >"$work/build.log" || { cat "$work/build.log"; exit 1; }
if grep -r "$root/src\|-march=native" "$work/prefix/lib" --include='*.cmake'; then
  echo "the installed package names the source folder, or flags of this machine"
  exit 1
fi

# The camera of the example moves 10 mm to its right with each of 60 frames.
"$work/build/minimal" | tee "$work/output"
awk '/^frame/ {count++; last = $5} END {
  if (count != 60 || last < 0.58 || last > 0.60) {
    print "expected 60 poses, the last one .59 m to the right of the first; got " count " and " last
    exit 1
  }}' "$work/output"
# The program needs nothing of the build tree: no path into it, and no library from it.
"$work/prefix/bin/rds" --help >/dev/null
if grep -rl --binary-files=text "$root/build\|$build" "$work/prefix/lib" --include='*.cmake' ||
  readelf -d "$work/prefix/bin/rds" | grep -F "$root" || ldd "$work/prefix/bin/rds" | grep -F "$root" ||
  ldd "$work/prefix/bin/rds" | grep 'not found'; then
  echo "what is installed needs the build tree"
  exit 1
fi
