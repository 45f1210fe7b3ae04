// SPDX-License-Identifier: Apache-2.0
#include "semantic/keypoint_labels.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "segmentation/mask.h"

namespace rds {

KeypointLabel LabelOfPixel(std::uint8_t pixel) {
  return pixel == kStaticPixel   ? KeypointLabel::kStatic
         : pixel == kUnsurePixel ? KeypointLabel::kNone
                                 : KeypointLabel::kDynamic;
}

std::vector<KeypointLabel> LabelKeypoints(const FrameData& data, const Image8& mask) {
  Check(mask.width == data.camera().width && mask.height == data.camera().height && mask.channels == 1,
        "the mask has the size of the image");
  std::vector<KeypointLabel> labels;
  labels.reserve(data.size());
  for (const Keypoint& keypoint : data.keypoints()) {
    const int x = std::clamp(static_cast<int>(std::lround(keypoint.raw_x)), 0, mask.width - 1);
    const int y = std::clamp(static_cast<int>(std::lround(keypoint.raw_y)), 0, mask.height - 1);
    labels.push_back(LabelOfPixel(mask.At(x, y)));
  }
  return labels;
}

}  // namespace rds
