#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A program built for instructions that this processor lacks says so in a sentence. XOP and FMA4 stand in for those of
# the future: few processors ever had them, and none made since 2017 has.
#   processor_test.sh [CXX]
set -euo pipefail
cxx=${1:-c++}
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if [ "$(uname -m)" != x86_64 ] || grep -qw xop /proc/cpuinfo; then
  echo "[  SKIPPED ] needs an x86-64 processor without XOP"
  exit 77
fi
echo '#include <cstdio>
struct Early { Early() { std::puts("ran"); } } early;
int main() {}' >"$work/main.cc"
compile() { "$cxx" -std=c++20 -I"$root/src" "$@"; }
compile -c "$root/src/cli/processor_check.cc" -o "$work/check.o"
compile -c "$work/main.cc" -o "$work/main.o"
for flag in -march=native -mxop; do
  compile $flag -c "$root/src/cli/processor_needs.cc" -o "$work/needs.o"
  "$cxx" "$work/main.o" "$work/check.o" "$work/needs.o" -o "$work/program"
  status=0
  "$work/program" >"$work/said" 2>&1 || status=$?
  cat "$work/said"
  case $flag in
    -march=native) [ $status = 0 ] && grep -qx ran "$work/said" ;;
    -mxop) [ $status = 1 ] && grep -q 'built for a processor with .*, which this one lacks; build it here' "$work/said" &&
      ! grep -q ran "$work/said" ;;
  esac || { echo "unexpected with $flag: status $status"; exit 1; }
done
