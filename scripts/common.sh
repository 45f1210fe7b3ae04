# SPDX-License-Identifier: Apache-2.0
# What the scripts share; sourced, not run. Sets ROOT and LOGS.
# shellcheck shell=bash
ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
LOGS=$ROOT/build/logs

say() { printf '%s\n' "$@"; }
die() {
  printf 'error: %s\n' "$*" >&2
  exit 1
}

# step NAME COMMAND...: runs the command with its output in a log file; shows the log's end if it fails.
step() {
  local name=$1 log start=$SECONDS status=0
  shift
  log=$LOGS/${name//[^A-Za-z0-9]/_}.log
  mkdir -p "$LOGS"
  printf '%-44s' "$name ..."
  "$@" >"$log" 2>&1 </dev/null || status=$?
  if ((status)); then
    printf 'failed (%d s)\n' $((SECONDS - start))
    tail -n 60 "$log" >&2
    printf 'error: %s failed (status %d); all of its output: %s\n' "$name" "$status" "$log" >&2
    return "$status"
  fi
  printf 'done (%d s)\n' $((SECONDS - start))
}

jobs_for_build() {
  # A compiler wants up to 1.5 GB: no more jobs than the memory can hold.
  local cores memory_gb
  cores=$(nproc)
  memory_gb=$(awk '/MemAvailable/ {print int($2 / 1500000)}' /proc/meminfo)
  ((memory_gb < 1)) && memory_gb=1
  echo $((cores < memory_gb ? cores : memory_gb))
}

# build PRESET [TARGET...]: configures and builds a preset of CMakePresets.json.
build() {
  local preset=$1
  shift
  cd "$ROOT" || return 1
  step "Configuring ($preset)" cmake --preset "$preset" || return
  step "Building ($preset)" cmake --build --preset "$preset" -j "$(jobs_for_build)" ${1:+--target "$@"} -- -k 0
}
