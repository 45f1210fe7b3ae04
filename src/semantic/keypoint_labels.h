// SPDX-License-Identifier: Apache-2.0
// From masks to labels of keypoints.
#pragma once

#include <cstdint>
#include <vector>

#include "base/image.h"
#include "feature/frame_data.h"
#include "map/keyframe.h"

namespace rds {

// What a pixel of a mask says.
[[nodiscard]] KeypointLabel LabelOfPixel(std::uint8_t pixel);

// Labels of keypoints under a dilated mask of the recorded image's size; none where it is unsure.
[[nodiscard]] std::vector<KeypointLabel> LabelKeypoints(const FrameData& data, const Image8& mask);

}  // namespace rds
