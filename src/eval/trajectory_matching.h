// SPDX-License-Identifier: Apache-2.0
// Which pose of an estimate belongs to which pose of the ground truth.
#pragma once

#include <vector>

#include "geometry/trajectory.h"

namespace rds {

struct MatchedPose {
  double timestamp_s = 0;  // of the estimate
  Rigid3 estimate;         // world_from_camera, the estimate's world
  Rigid3 ground_truth;     // world_from_camera, the ground truth's world
};

// Every pose of the sparser trajectory (the estimate where both have as many) with the pose of the other that is
// nearest in time, the earlier of two equally near, if no farther than `max_difference_s`. The rule of the evo package,
// so that figures agree; a pose of the denser one may so serve twice. Both ascend in time.
std::vector<MatchedPose> MatchNearest(const Trajectory& estimate, const Trajectory& ground_truth,
                                      double max_difference_s);

// Every pose of the estimate with the ground truth at its very time, interpolated between the poses before and after
// (positions linearly, rotations spherically) where these are no more than `max_gap_s` apart.
std::vector<MatchedPose> MatchInterpolated(const Trajectory& estimate, const Trajectory& ground_truth,
                                           double max_gap_s);

}  // namespace rds
