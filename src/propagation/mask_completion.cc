// SPDX-License-Identifier: Apache-2.0
#include "propagation/mask_completion.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "segmentation/mask.h"

namespace rds {
namespace {

// Sets the block of pixels around a sample of the grid, but for those that are static.
void FillBlock(int column, int row, Image8& mask) {
  for (int y = row * kDepthGridStep; y < (row + 1) * kDepthGridStep; ++y) {
    std::uint8_t* const pixels = mask.Row(y) + column * kDepthGridStep;
    std::replace(pixels, pixels + kDepthGridStep, kUnsurePixel, kDynamicPixel);
  }
}

}  // namespace

void CompleteMask(const DepthGrid& grid, double depth_step_ratio, Image8& mask) {
  Check(grid.columns * kDepthGridStep <= mask.width && grid.rows * kDepthGridStep <= mask.height && mask.channels == 1,
        "the grid and the mask are of one image");
  const auto index = [&](int column, int row) { return static_cast<std::size_t>(row * grid.columns + column); };
  struct Cell {
    int column = 0;
    int row = 0;
  };
  std::vector<std::uint8_t> labels(grid.depth_m.size());
  std::vector<Cell> reached;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      std::uint8_t& label = labels[index(column, row)];
      label = mask.At(column * kDepthGridStep + kDepthGridStep / 2, row * kDepthGridStep + kDepthGridStep / 2);
      if (label == kDynamicPixel && grid.depth_m[index(column, row)] > 0) {
        reached.push_back({column, row});
      }
    }
  }
  const auto share = static_cast<float>(depth_step_ratio);
  while (!reached.empty()) {
    const Cell cell = reached.back();
    reached.pop_back();
    const float depth_m = grid.depth_m[index(cell.column, cell.row)];
    FillBlock(cell.column, cell.row, mask);
    for (int row = std::max(cell.row - 1, 0); row <= std::min(cell.row + 1, grid.rows - 1); ++row) {
      for (int column = std::max(cell.column - 1, 0); column <= std::min(cell.column + 1, grid.columns - 1); ++column) {
        std::uint8_t& label = labels[index(column, row)];
        if (label == kUnsurePixel && std::abs(grid.depth_m[index(column, row)] - depth_m) < share * depth_m) {
          label = kDynamicPixel;
          reached.push_back({column, row});
        }
      }
    }
  }
}

}  // namespace rds
