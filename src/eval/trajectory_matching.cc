// SPDX-License-Identifier: Apache-2.0
#include "eval/trajectory_matching.h"

#include <algorithm>
#include <cmath>

namespace rds {
namespace {

// The first pose at or after a time.
Trajectory::const_iterator NotBefore(const Trajectory& trajectory, double timestamp_s) {
  return std::lower_bound(trajectory.begin(), trajectory.end(), timestamp_s,
                          [](const StampedPose& pose, double time) { return pose.timestamp_s < time; });
}

// The nearest pose in time, the earlier of two; `trajectory` is not empty.
const StampedPose& Nearest(const Trajectory& trajectory, double timestamp_s) {
  const auto after = NotBefore(trajectory, timestamp_s);
  if (after == trajectory.begin()) {
    return *after;
  }
  const auto before = std::prev(after);
  if (after == trajectory.end()) {
    return *before;
  }
  const bool before_is_nearer =
      std::abs(before->timestamp_s - timestamp_s) <= std::abs(after->timestamp_s - timestamp_s);
  return before_is_nearer ? *before : *after;
}

Rigid3 Interpolate(const StampedPose& before, const StampedPose& after, double timestamp_s) {
  const double weight = (timestamp_s - before.timestamp_s) / (after.timestamp_s - before.timestamp_s);
  const Rigid3& a = before.world_from_camera;
  const Rigid3& b = after.world_from_camera;
  return {a.rotation.slerp(weight, b.rotation).normalized(), (1 - weight) * a.translation + weight * b.translation};
}

}  // namespace

std::vector<MatchedPose> MatchNearest(const Trajectory& estimate, const Trajectory& ground_truth,
                                      double max_difference_s) {
  std::vector<MatchedPose> matches;
  if (estimate.empty() || ground_truth.empty()) {
    return matches;
  }
  const bool walk_estimate = estimate.size() <= ground_truth.size();
  for (const StampedPose& pose : walk_estimate ? estimate : ground_truth) {
    const StampedPose& other = Nearest(walk_estimate ? ground_truth : estimate, pose.timestamp_s);
    if (std::abs(other.timestamp_s - pose.timestamp_s) <= max_difference_s) {
      const StampedPose& estimated = walk_estimate ? pose : other;
      const StampedPose& truth = walk_estimate ? other : pose;
      matches.push_back({estimated.timestamp_s, estimated.world_from_camera, truth.world_from_camera});
    }
  }
  return matches;
}

std::vector<MatchedPose> MatchInterpolated(const Trajectory& estimate, const Trajectory& ground_truth,
                                           double max_gap_s) {
  std::vector<MatchedPose> matches;
  for (const StampedPose& pose : estimate) {
    const auto after = NotBefore(ground_truth, pose.timestamp_s);
    if (after == ground_truth.end()) {
      break;
    }
    if (after->timestamp_s == pose.timestamp_s) {
      matches.push_back({pose.timestamp_s, pose.world_from_camera, after->world_from_camera});
    } else if (after != ground_truth.begin() && after->timestamp_s - std::prev(after)->timestamp_s <= max_gap_s) {
      matches.push_back(
          {pose.timestamp_s, pose.world_from_camera, Interpolate(*std::prev(after), *after, pose.timestamp_s)});
    }
  }
  return matches;
}

}  // namespace rds
