// SPDX-License-Identifier: Apache-2.0
// From pixels as recorded to those of a camera without distortion.
#pragma once

#include <Eigen/Core>
#include <span>

#include "geometry/camera.h"

namespace rds {

// In place, by OpenCV's iteration. Exact to a hundredth of a pixel for lenses that DistortionProblem passes.
void UndistortPixels(const PinholeCamera& camera, std::span<Eigen::Vector2f> pixels);

}  // namespace rds
