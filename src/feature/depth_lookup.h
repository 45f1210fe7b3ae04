// SPDX-License-Identifier: Apache-2.0
// Depth at pixels of a registered depth image, dense or full of holes.
#pragma once

#include <cstdint>
#include <limits>

#include "base/image.h"

namespace rds {

// Reads one depth image, which must outlive it. Where a depth camera of few pixels was registered to a color camera of
// many, most pixels have none, though each has some nearby: there a pixel takes the depth of the surface around it. In
// a dense image a hole stays a hole (the sensor saw nothing there).
class DepthLookup {
 public:
  explicit DepthLookup(const Image16& depth);

  // In units of the image; 0 = no depth. The pixel must lie in the image.
  [[nodiscard]] std::uint16_t At(int x, int y) const {
    const std::uint16_t raw = depth_.At(x, y);
    return IsDepth(raw) ? raw : reach_px_ == 0 ? std::uint16_t{0} : Around(x, y);
  }
  [[nodiscard]] int width() const { return depth_.width; }
  [[nodiscard]] int height() const { return depth_.height; }
  // How far around a pixel without depth is searched; 0 in a dense image.
  [[nodiscard]] int reach_px() const { return reach_px_; }

 private:
  static bool IsDepth(std::uint16_t raw) { return raw != 0 && raw != std::numeric_limits<std::uint16_t>::max(); }
  // The mean of what lies within reach, 0 if that is nothing or of two surfaces.
  [[nodiscard]] std::uint16_t Around(int x, int y) const;

  const Image16& depth_;
  int reach_px_ = 0;
};

}  // namespace rds
