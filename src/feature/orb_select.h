// SPDX-License-Identifier: Apache-2.0
// Choice of corners that cover an image evenly.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "feature/orb_fast.h"

namespace rds {

// Chooses the corners to keep. Deterministic: ties go to the corner that comes first. Not thread-safe: keeps its
// buffers.
class CornerSelector {
 public:
  // Drops corners up to `strong_threshold` that share a cell of about 35 pixels with a corner above it. Keeps the
  // order.
  void DropWeak(int width, int height, std::uint8_t strong_threshold, std::vector<Corner>& corners);

  // Reduces the corners to at most `wanted`, evenly spread: in each cell of a grid the best corner counts its full
  // score, the second half of it, the third a third and so on; those that count most are kept. Ordered by cell.
  void Spread(int width, int height, std::size_t wanted, std::vector<Corner>& corners);

 private:
  std::vector<std::uint8_t> strongest_;    // by cell
  std::vector<std::uint32_t> cell_start_;  // by cell, into sorted_
  std::vector<std::uint32_t> cell_end_;    // by cell, into sorted_, while it fills
  std::vector<std::uint32_t> cell_of_;     // by corner
  std::vector<Corner> sorted_;             // by cell, best first
  std::vector<std::uint32_t> value_;       // by corner in sorted_: score over its place in the cell
  std::vector<std::uint32_t> ordered_;     // the values, partly ordered
};

}  // namespace rds
