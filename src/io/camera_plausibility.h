// SPDX-License-Identifier: Apache-2.0
// Whether numbers are those of an RGB-D camera.
#pragma once

#include <optional>
#include <string>

#include "geometry/camera.h"

namespace rds {

// What no RGB-D camera has (field of view, principal point, baseline, units of depth), and what was likely meant.
// Nothing if all is as with known cameras: horizontally 35 to 150 degrees, the principal point in the middle half, a
// baseline of 5 mm to 1 m, 50 to 100,000 units of depth a meter.
[[nodiscard]] std::optional<std::string> CameraProblem(const PinholeCamera& camera);

// What is wrong with the median depth of a picture (meters): indoors it is .1 to 8 m. Names the scale that would make
// it likely. Nothing if all is well, or if the camera is said to be unusual.
[[nodiscard]] std::optional<std::string> DepthProblem(const PinholeCamera& camera, double median_m);

// The depth_scale in common use that brings a median depth nearest to 2 m.
[[nodiscard]] double LikelyDepthScale(const PinholeCamera& camera, double median_m);

}  // namespace rds
