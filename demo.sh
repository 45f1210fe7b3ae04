#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# RGB-D SLAM in dynamic scenes, from nothing to a trajectory.
#
#   ./demo.sh                        installs what is missing, builds, makes a synthetic room with people walking
#                                    through it, and runs SLAM on it with and without semantics
#   ./demo.sh SEQUENCE [options]     the same with a folder of yours (TUM or Bonn layout); the options are those of
#                                    `rds run`, such as --camera FILE, --segmenter geometry, --video FILE.mp4
#
# Results are written below out/. A second call builds and makes only what changed.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/scripts/common.sh"
RDS=$ROOT/build/release/rds
OUT=$ROOT/out

prepare() {
  "$ROOT/scripts/install_dependencies.sh"
  (build release rds_program)
}

# compare WITHOUT WITH: both reports side by side.
compare() {
  python3 - "$1" "$2" <<'PYTHON'
import json, sys

reports = [json.load(open(f"{folder}/report.json")) for folder in sys.argv[1:3]]

def row(name, values, unit):
    print(f"  {name:<34}" + "".join(f"{value:>18}" for value in values) + f"  {unit}")

row("", ["without semantics", "with semantics"], "")
row("frames tracked", [f"{r['tracked']} of {r['frames']}" for r in reports], "")
row("absolute trajectory error (RMSE)", [f"{r['ate_m']['rmse']:.4f}" for r in reports], "m")
row("tracking time, median", [f"{r['tracking_ms']['median']:.1f}" for r in reports], "ms a frame")
PYTHON
}


synthetic_demo() {
  local sequence=$OUT/demo/sequence without=$OUT/demo/without_semantics with=$OUT/demo/with_semantics
  prepare
  # Made again only if the program is newer.
  if [ ! -f "$sequence/groundtruth.txt" ] || [ "$RDS" -nt "$sequence/groundtruth.txt" ]; then
    rm -rf "$sequence"
    "$RDS" synth --out "$sequence" --scenario walking
  fi
  say "" "SLAM without semantics"
  "$RDS" run "$sequence" --out "$without" --segmenter none \
    --video "$without/video.mp4" --still "$without/last_frame.png"
  say "" "SLAM with semantics (masks from the sequence, 200 ms late)"
  "$RDS" run "$sequence" --out "$with" --segmenter stored --set semantic.stored.delay_ms=200 \
    --video "$with/video.mp4" --still "$with/last_frame.png"
  say ""
  compare "$without" "$with"
  say "" "$without and" "$with hold:" \
    "  trajectory.txt  trajectory.svg  report.json  video.mp4  last_frame.png (of the video)"
}

# The weights of the default segmenter; from the folder that RDS_SHARED names, where it has them.
fetch_weights() {
  local models=${RDS_SHARED:+$RDS_SHARED/models}
  if [ -z "${RDS_WEIGHTS_URL:-}" ] && [ -n "$models" ] && [ -d "$models" ]; then
    export RDS_WEIGHTS_URL=file://$(realpath "$models")
  fi
  "$RDS" fetch weights
}

own_sequence() {
  local sequence=$1 name option out="" weights=wanted
  shift
  [ -d "$sequence" ] || die "there is no folder $sequence (./demo.sh --help tells more)"
  name=$(basename "$(realpath "$sequence")")
  for option in "$@"; do
    [[ $option == --out || $option == --out=* ]] && out=given
    [[ $option =~ ^--(segmenter|model)(=|$) ]] && weights=chosen
  done
  prepare
  if [ $weights = wanted ] && [ -z "${RDS_WEIGHTS:-}" ] && ! fetch_weights; then
    say "going on without a network: what moves is told from geometry"
    set -- --segmenter geometry "$@"
  fi
  if [ -z "$out" ]; then
    set -- --out "$OUT/$name" "$@"
  fi
  "$RDS" run "$sequence" "$@"
}

case "${1:-}" in
  "") synthetic_demo ;;
  -h | --help) sed -n '2,/^set/s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" ;;
  -*) die "the first argument is the folder of a sequence (try --help)" ;;
  *) own_sequence "$@" ;;
esac
