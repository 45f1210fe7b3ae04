// SPDX-License-Identifier: Apache-2.0
#include "feature/depth_lookup.h"

#include <algorithm>
#include <cmath>

namespace rds {
namespace {

// Depth values that differ by more than a tenth are of two surfaces.
constexpr int kJumpShare = 10;

}  // namespace

DepthLookup::DepthLookup(const Image16& depth) : depth_(depth) {
  // In a dense image nearly all neighbors of a pixel with depth have depth, too, however many holes there are.
  constexpr int kStep_px = 7;  // shares no factor with the patterns that registration leaves in common sizes
  constexpr double kDenseShare = 0.6;
  constexpr int kFarthest_px = 8;
  int looked_at = 0;
  int with_depth = 0;
  int neighbors = 0;
  for (int y = 1; y + 1 < depth.height; y += kStep_px) {
    for (int x = 1; x + 1 < depth.width; x += kStep_px) {
      ++looked_at;
      if (IsDepth(depth.At(x, y))) {
        ++with_depth;
        neighbors += IsDepth(depth.At(x - 1, y)) + IsDepth(depth.At(x + 1, y)) + IsDepth(depth.At(x, y - 1)) +
                     IsDepth(depth.At(x, y + 1));
      }
    }
  }
  if (with_depth == 0 || neighbors >= kDenseShare * 4 * with_depth) {
    return;
  }
  const double spacing_px = std::sqrt(static_cast<double>(looked_at) / with_depth);
  reach_px_ = std::clamp(static_cast<int>(std::ceil(1.5 * spacing_px)), 2, kFarthest_px);
}

std::uint16_t DepthLookup::Around(int x, int y) const {
  int least = std::numeric_limits<std::uint16_t>::max();
  int most = 0;
  double sum = 0;
  double weights = 0;
  for (int v = std::max(y - reach_px_, 0); v <= std::min(y + reach_px_, depth_.height - 1); ++v) {
    for (int u = std::max(x - reach_px_, 0); u <= std::min(x + reach_px_, depth_.width - 1); ++u) {
      const std::uint16_t raw = depth_.At(u, v);
      if (IsDepth(raw)) {
        const double weight = 1.0 / ((u - x) * (u - x) + (v - y) * (v - y));
        least = std::min<int>(least, raw);
        most = std::max<int>(most, raw);
        sum += weight * raw;
        weights += weight;
      }
    }
  }
  return most == 0 || most - least > least / kJumpShare ? std::uint16_t{0}
                                                        : static_cast<std::uint16_t>(std::lround(sum / weights));
}

}  // namespace rds
