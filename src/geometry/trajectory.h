// SPDX-License-Identifier: Apache-2.0
// Trajectories: stamped camera poses.
#pragma once

#include <vector>

#include "geometry/rigid3.h"

namespace rds {

// Pose of the camera at a time; timestamps in seconds, world as the run defined it (first camera = identity).
struct StampedPose {
  double timestamp_s = 0;
  Rigid3 world_from_camera;
};

using Trajectory = std::vector<StampedPose>;  // ascending timestamps

}  // namespace rds
