// SPDX-License-Identifier: Apache-2.0
// No network: a back end that leaves every pixel unsure.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "segmentation/mask.h"
#include "segmentation/segmenter.h"

namespace rds {

// What moves is then told from geometry alone: by the motion of surfaces and by free space.
class UnsureSegmenter final : public Segmenter {
 public:
  [[nodiscard]] std::vector<Image8> Segment(std::span<const SegmentationInput> inputs) override {
    std::vector<Image8> masks;
    for (const SegmentationInput& input : inputs) {
      masks.emplace_back(input.image->width, input.image->height, 1, kUnsurePixel);
    }
    return masks;
  }
  void Cancel() override {}
  [[nodiscard]] std::string Name() const override { return "geometry"; }
};

}  // namespace rds
