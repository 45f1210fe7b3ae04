#!/usr/bin/env bash
# Runs clang-tidy over the sources as the dev preset compiles them.
# Exit: 0 clean, 1 findings, 77 clang-tidy is not there.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
if ! command -v clang-tidy >/dev/null; then
  say "[  SKIPPED ] clang-tidy is not there (apt-get install clang-tidy)"
  exit 77
fi
cd "$ROOT"
cmake --preset dev >/dev/null
mkdir -p build/tidy
# Without what only g++ knows, and without its precompiled headers.
sed -E 's/ -fpch-preprocess| -Winvalid-pch| -include [^ ]*cmake_pch\.hxx//g' build/dev/compile_commands.json \
  >build/tidy/compile_commands.json
find src \( -name '*.cc' -not -name '*_test.cc' \) -print0 |
  xargs -0 -n 4 -P "$(jobs_for_build)" clang-tidy -p build/tidy --quiet --warnings-as-errors='*'
