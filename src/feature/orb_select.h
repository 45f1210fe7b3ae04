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

  // Reduces the corners to at most `wanted`, evenly spread: over a grid of about that many cells, takes the best corner
  // of every cell, then every cell's second, and so on; of the last round the best. The result is ordered by cell.
  void Spread(int width, int height, std::size_t wanted, std::vector<Corner>& corners);

 private:
  std::vector<std::uint8_t> strongest_;    // by cell
  std::vector<std::uint32_t> cell_start_;  // by cell, into sorted_
  std::vector<std::uint32_t> cell_of_;     // by corner
  std::vector<Corner> sorted_;             // by cell, best first
  std::vector<std::uint32_t> rank_;        // by corner in sorted_: its place in its cell, from 1
  std::vector<std::uint32_t> rank_count_;  // corners of a rank
  std::vector<std::uint32_t> last_round_;  // indices into sorted_
};

}  // namespace rds
