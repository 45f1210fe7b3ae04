// SPDX-License-Identifier: Apache-2.0
// A landmark.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "base/ids.h"
#include "feature/frame_data.h"

namespace rds {

// That a keyframe sees a point at one of its keypoints.
struct Observation {
  KeyframeId keyframe;
  std::uint32_t keypoint = 0;
  float log_odds =
      0;  // what the keypoint's label added to the log odds of the point's moving probability; 0 = no label
};

// When a point counts as in view: seen from less than 60 degrees off its mean viewing direction (Mur-Artal et al., T-RO
// 2015, section V-D), at a distance at which the pyramid can see it again, give or take a fifth (one level).
inline constexpr double kMinViewCosine = 0.5;
inline constexpr double kNearerThanRange = 0.8;
inline constexpr double kFartherThanRange = 1.2;

// A 3-D point with its appearance. Owned and changed by Map only; not thread-safe by itself.
struct MapPoint {
  PointId id;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // in the frame of its reference keyframe's world, meters
  std::uint32_t revision = 0;                          // grows with each change of the position
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    // mean direction from the observing cameras to the point, unit
  float min_distance_m = 0;                            // range in which the pyramid can see it again
  float max_distance_m = 0;
  Descriptor descriptor{};                // the observation's descriptor with the least median distance to the others
  std::vector<Observation> observations;  // ascending by keyframe
  KeyframeId reference;                   // keyframe that hosts the point: the oldest of those that made it
  KeyframeId created_at;                  // newest keyframe when the point was made, for the trial of young points
  int visible = 1;                        // frames in whose view it was
  int found = 1;                          // frames that matched it

  [[nodiscard]] bool IsMadeBy(KeyframeId keyframe) const { return observations.front().keyframe == keyframe; }
};

}  // namespace rds
