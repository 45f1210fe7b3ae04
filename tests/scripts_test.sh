#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The scripts at the root and in scripts/: syntax, help, wrong arguments, and a machine on which nothing can be installed.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$root"

fail() {
  echo "FAILED: $*"
  exit 1
}
expect_output() { grep -q -- "$1" "$work/output" || { cat "$work/output"; fail "the output lacks '$1'"; }; }
# expect_status STATUS COMMAND...: runs the command; its output is in $work/output.
expect_status() {
  local wanted=$1 status=0
  shift
  "$@" >"$work/output" 2>&1 </dev/null || status=$?
  [ "$status" = "$wanted" ] || { cat "$work/output"; fail "$* ended with $status, not $wanted"; }
}

for script in *.sh scripts/*.sh tests/*.sh .ci/run; do
  bash -n "$script" || fail "$script"
done
if command -v shellcheck >/dev/null; then
  shellcheck -S warning -x ./*.sh scripts/*.sh tests/*.sh .ci/run || fail shellcheck
fi

expect_status 0 ./demo.sh --help
expect_output "SEQUENCE"
expect_status 1 ./demo.sh --no-such-option
expect_status 1 ./demo.sh "$work/no-such-folder"
expect_output "there is no folder"
expect_status 0 ./test.sh --help
expect_output "--quick"
expect_status 1 ./test.sh --no-such-option
expect_status 1 ./test.sh --only nothing
expect_status 1 scripts/install_dependencies.sh --no-such-option

# A path with little on it.
bin=$work/bin
mkdir "$bin"
for tool in bash cat dirname env grep mktemp rm sed tail; do
  ln -s "$(command -v "$tool")" "$bin/$tool"
done
# Neither apt nor CMake: says what is wanted.
expect_status 1 env PATH="$bin" bash scripts/install_dependencies.sh
expect_output "CMake >= 3.22"
expect_output "libopencv-dev"
# apt, but neither root nor sudo: names the missing packages, and those alone.
printf '#!/bin/sh\n[ "$3" = cmake ] && echo installed\nexit 0\n' >"$bin/dpkg-query"
printf '#!/bin/sh\necho must not be called; exit 1\n' >"$bin/apt-get"
printf '#!/bin/sh\necho 1000\n' >"$bin/id"
chmod +x "$bin/dpkg-query" "$bin/apt-get" "$bin/id"
expect_status 1 env PATH="$bin" bash scripts/install_dependencies.sh
expect_output "apt-get install g++ ninja-build"
if grep -q " cmake " "$work/output"; then
  fail "names a package that is there"
fi
