// SPDX-License-Identifier: Apache-2.0
// What a depth image says of keypoints.
#pragma once

#include <vector>

#include "feature/depth_lookup.h"
#include "feature/frame_data.h"

namespace rds {

// Gives the keypoints (recorded pixels set) their depth, its standard deviation and, if wanted, whether a surface ends
// beside them. The deviation has two parts: the sensor's (PinholeCamera::depth_noise), and the slope of the surface
// times how far the pixel may be off, by the registration of depth to color and by the level of the pyramid.
void LookUpDepth(const PinholeCamera& camera, const DepthLookup& depth, bool edges, const ScalePyramid& pyramid,
                 std::vector<Keypoint>& keypoints);

[[nodiscard]] DepthGrid SampleDepth(const PinholeCamera& camera, const DepthLookup& depth);

}  // namespace rds
