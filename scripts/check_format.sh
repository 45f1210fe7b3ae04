#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Checks (or with --fix mends) the formatting of all sources with the pinned clang-format.
# Exit: 0 all is formatted, 1 something is not, 77 the pinned clang-format is not there.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
VERSION=14

for candidate in "$ROOT/build/venv/bin/clang-format" "clang-format-$VERSION" clang-format; do
  if "$candidate" --version 2>/dev/null | grep -q "version $VERSION\."; then
    formatter=$candidate
    break
  fi
done
if [ -z "${formatter:-}" ]; then
  say "[  SKIPPED ] clang-format $VERSION is not there (scripts/install_dependencies.sh --tests installs it)"
  exit 77
fi
cd "$ROOT"
if [ "${1:-}" = --fix ]; then
  find src examples \( -name "*.h" -o -name "*.cc" \) -print0 | xargs -0 "$formatter" -i
else
  find src examples \( -name "*.h" -o -name "*.cc" \) -print0 | xargs -0 "$formatter" --dry-run -Werror
fi
