// SPDX-License-Identifier: Apache-2.0
// That a keypoint of a frame shows a point of a snapshot of the map.
#pragma once

#include <cstdint>

#include "map/moving_probability.h"

namespace rds {

// A keypoint of the current frame and the point of the local map that it shows.
struct PointMatch {
  std::uint32_t keypoint = 0;
  std::uint32_t point = 0;  // index into LocalMap
  PointState state = PointState::kUnknown;
  double weight =
      1;  // 1 - p, less for a point that is not proven, scaled so that the best match that is used has weight 1
};

}  // namespace rds
