#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what is missing, builds and runs every test.
#
#   ./test.sh                 everything: format, dev (warnings are errors), asan-ubsan, tsan
#   ./test.sh --quick         format and dev only
#   ./test.sh --only SUITE    one suite: format, dev, asan-ubsan, tsan, tidy
#   ./test.sh --tidy          everything and clang-tidy (slow)
#
# The last line counts all suites together: "N passed, N failed, N skipped". Exit code 1 if anything failed.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/scripts/common.sh"
cd "$ROOT"
RESULTS=$ROOT/build/test-results
export TSAN_OPTIONS="halt_on_error=1 second_deadlock_stack=1 suppressions=$ROOT/tests/tsan.supp"
export ASAN_OPTIONS="detect_leaks=1 strict_string_checks=1 detect_stack_use_after_return=1"
export LSAN_OPTIONS="suppressions=$ROOT/tests/lsan.supp print_suppressions=0"
export UBSAN_OPTIONS="print_stacktrace=1 halt_on_error=1"

# record SUITE NAME passed|failed|skipped [REASON]: the result of a check that is not run by ctest.
record() {
  printf '%s\t%s\t%s\t%s\n' "$1" "$2" "$3" "${4:-}" >>"$RESULTS/other.tsv"
}

# check SUITE NAME COMMAND...: a check that is one command; exit code 77 says that it was skipped.
check() {
  local suite=$1 name=$2 status=0 log=$RESULTS/$1.log
  shift 2
  "$@" >"$log" 2>&1 </dev/null || status=$?
  case $status in
    0) record "$suite" "$name" passed ;;
    77) record "$suite" "$name" skipped "$(tail -n 1 "$log")" ;;
    *)
      record "$suite" "$name" failed "exit code $status"
      tail -n 40 "$log" >&2
      ;;
  esac
}

# run_ctest SUITE [arguments of ctest]: all tests of a preset's build; failures are shown, the rest goes to a log.
run_ctest() {
  local suite=$1 log=$RESULTS/$1.log start=$SECONDS run=() status=0
  shift
  # ThreadSanitizer of older compilers cannot run where addresses are randomised much.
  if [ "$suite" = tsan ] && setarch "$(uname -m)" -R true 2>/dev/null; then
    run=(setarch "$(uname -m)" -R)
  fi
  printf '%-44s' "Testing ($suite) ..."
  "${run[@]}" ctest --test-dir "build/$suite" -j "$(nproc)" --no-tests=error --output-on-failure \
    --output-junit "$RESULTS/$suite.xml" "$@" >"$log" 2>&1 </dev/null || status=$?
  if ((status)); then
    printf 'failed (%d s)\n' $((SECONDS - start))
    sed -n '/\*\*\*Failed\|\*\*\*Timeout\|\*\*\*Exception\|\*\*\*Not Run/,/^ *[0-9]*\/[0-9]* Test/p' "$log" | tail -n 300 >&2
    [ -s "$RESULTS/$suite.xml" ] || record "$suite" ctest failed "ctest ended with $status; see $log"
  else
    printf 'done (%d s)\n' $((SECONDS - start))
  fi
}

suite_format() { check format formatting scripts/check_format.sh; }

suite_dev() {
  build dev || { record dev build failed; return 0; }
  run_ctest dev
}

suite_asan-ubsan() {
  build asan-ubsan || { record asan-ubsan build failed; return 0; }
  run_ctest asan-ubsan
}

# Only what has threads.
suite_tsan() {
  build tsan rds_thread_tests || { record tsan build failed; return 0; }
  run_ctest tsan -L '^(runtime|semantic|system)$'
}

suite_tidy() { check tidy clang-tidy scripts/check_tidy.sh; }

main() {
  local suites=(format dev asan-ubsan tsan) suite
  while (($#)); do
    case $1 in
      --quick) suites=(format dev) ;;
      --tidy) suites+=(tidy) ;;
      --only)
        shift
        case ${1:-} in
          format | dev | asan-ubsan | tsan | tidy) suites=("$1") ;;
          *) die "--only wants one of format, dev, asan-ubsan, tsan, tidy" ;;
        esac
        ;;
      -h | --help)
        sed -n '2,/^set/s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
        return 0
        ;;
      *) die "unknown option $1 (try --help)" ;;
    esac
    shift
  done
  rm -rf "$RESULTS"
  mkdir -p "$RESULTS"
  touch "$RESULTS/other.tsv"
  scripts/install_dependencies.sh --tests
  for suite in "${suites[@]}"; do
    "suite_$suite"
  done
  python3 scripts/summarize_tests.py "$RESULTS"
}

main "$@"
