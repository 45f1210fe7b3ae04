// SPDX-License-Identifier: Apache-2.0
#include "system/slam_event.h"

#include "base/error.h"

namespace rds {

std::string_view ToString(SlamEventKind kind) {
  switch (kind) {
    case SlamEventKind::kWorldStarted:
      return "world_started";
    case SlamEventKind::kRelocalized:
      return "relocalized";
    case SlamEventKind::kLoopClosed:
      return "loop_closed";
    case SlamEventKind::kWorldsMerged:
      return "worlds_merged";
  }
  throw InvariantError("unknown event");
}

}  // namespace rds
