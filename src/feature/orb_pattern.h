// SPDX-License-Identifier: Apache-2.0
// Pixel pairs that the ORB descriptor compares.
#pragma once

#include <array>
#include <cstdint>

namespace rds {

// Two pixels relative to the keypoint, for an orientation of 0: x right, y down, within radius 15.
struct PixelPair {
  std::int8_t ax;
  std::int8_t ay;
  std::int8_t bx;
  std::int8_t by;
};

// Pairs of little mutual correlation, computed from a model of images (see orb_pattern.py), not learned from data. Bit
// i of a descriptor compares pair i.
[[nodiscard]] const std::array<PixelPair, 256>& OrbPattern();

}  // namespace rds
