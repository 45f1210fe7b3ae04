// SPDX-License-Identifier: Apache-2.0
// What happens to the map as a whole.
#pragma once

#include <cstdint>
#include <string_view>

#include "base/ids.h"
#include "geometry/rigid3.h"

namespace rds {

enum class SlamEventKind : std::uint8_t {
  kWorldStarted,  // a piece of map with an origin of its own: the first frame, or where a lost camera goes on
  kRelocalized,   // a lost camera was found in `world`
  kLoopClosed,    // `world` was bent, as a place of it was seen again
  kWorldsMerged,  // `merged` is part of `world` from now on
};

// "world_started", "relocalized", "loop_closed", "worlds_merged".
[[nodiscard]] std::string_view ToString(SlamEventKind kind);

struct SlamEvent {
  SlamEventKind kind = SlamEventKind::kWorldStarted;
  FrameId frame;           // the newest frame when it happened
  double timestamp_s = 0;  // of that
  WorldId world;
  WorldId merged;         // worlds_merged: the one that is no more
  Rigid3 into_from_from;  // worlds_merged: where points of `merged` are in `world`; loop_closed: how far the keyframe
                          // that was seen again moved. Identity otherwise
  int matches = 0;        // that the place was recognized by
};

}  // namespace rds
