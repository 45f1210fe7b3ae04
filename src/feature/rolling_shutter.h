// SPDX-License-Identifier: Apache-2.0
// Keypoints of a camera that exposes one row after the other.
#pragma once

#include <vector>

#include "feature/frame_data.h"
#include "geometry/rigid3.h"

namespace rds {

// Moves keypoints (undistorted and recorded pixels and depth set) to where they would be had all rows been exposed
// with the middle one, to first order in PinholeCamera::rolling_shutter_s (nothing where that is 0). `velocity` is that
// of points at rest in the frame of the camera, m/s and rad/s; without depth a keypoint is taken as far away. Model:
// Hedborg, Forssen, Felsberg and Ringaby, "Rolling Shutter Bundle Adjustment", CVPR 2012, with one velocity a frame.
void CorrectRollingShutter(const PinholeCamera& camera, const Tangent6& velocity, std::vector<Keypoint>& keypoints);

}  // namespace rds
