// SPDX-License-Identifier: Apache-2.0
// New points from what two keyframes see.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "map/map.h"

namespace rds {

// A pair of keyframes with the keypoints of both that show no point yet and may make one. A copy.
struct CreationProblem {
  struct View {
    KeyframeVersion version;
    Rigid3 camera_from_world;
    std::shared_ptr<const FrameData> data;
    std::vector<std::uint32_t> free_keypoints;  // without a point, and not labeled dynamic; ascending
  };
  View keyframe;
  View neighbor;
  ScalePyramid pyramid;
};

// Nothing if one of the keyframes is gone, or if the cameras are closer to each other than the baseline of the sensor.
[[nodiscard]] std::optional<CreationProblem> PlanCreation(const Map& map, KeyframeId keyframe, KeyframeId neighbor);

// Points of pairs of keypoints that agree in appearance and with the epipolar geometry (the best match must be
// `ratio` times better than the second), triangulated; Correction::new_points.
[[nodiscard]] std::optional<Correction> SolveCreation(const CreationProblem& problem, double ratio);

}  // namespace rds
