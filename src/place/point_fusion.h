// SPDX-License-Identifier: Apache-2.0
// Points that a keyframe shows without knowing it.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "map/map.h"

namespace rds {

// A keyframe, and points that it does not see yet. A copy.
struct FusionProblem {
  struct Point {
    PointId id;
    Eigen::Vector3d position;  // in the world frame, meters
    Eigen::Vector3d normal;    // as in MapPoint, like what follows
    float min_distance_m = 0;
    float max_distance_m = 0;
    Descriptor descriptor{};
  };
  KeyframeVersion version;
  Rigid3 camera_from_world;
  std::shared_ptr<const FrameData> data;
  std::vector<Point> points;
  ScalePyramid pyramid;
};

// Those of `points` that live and that the keyframe does not see. Nothing if the keyframe is gone.
[[nodiscard]] std::optional<FusionProblem> PlanFusion(const Map& map, KeyframeId keyframe,
                                                      std::span<const PointId> points);

// Keypoints that show such points, found by projection and appearance; Correction::matches.
[[nodiscard]] std::optional<Correction> SolveFusion(const FusionProblem& problem);

}  // namespace rds
