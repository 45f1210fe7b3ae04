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
  Check(grid.columns() * kDepthGridStep <= mask.width && grid.rows() * kDepthGridStep <= mask.height &&
            mask.channels == 1,
        "the grid and the mask are of one image");
  struct Cell {
    int column = 0;
    int row = 0;
  };
  std::vector<std::uint8_t> labels(grid.size());
  std::vector<Cell> reached;
  grid.ForEach([&](int column, int row) {
    std::uint8_t& label = labels[grid.Index(column, row)];
    label = mask.At(DepthGrid::MiddlePixel(column), DepthGrid::MiddlePixel(row));
    if (label == kDynamicPixel && grid[grid.Index(column, row)] > 0) {
      reached.push_back({column, row});
    }
  });
  const auto ratio = static_cast<float>(depth_step_ratio);
  while (!reached.empty()) {
    const Cell cell = reached.back();
    reached.pop_back();
    const float depth_m = grid[grid.Index(cell.column, cell.row)];
    FillBlock(cell.column, cell.row, mask);
    grid.ForEachAround(cell.column, cell.row, [&](int column, int row) {
      const std::size_t i = grid.Index(column, row);
      if (labels[i] == kUnsurePixel && SameSurface(depth_m, grid[i], ratio)) {
        labels[i] = kDynamicPixel;
        reached.push_back({column, row});
      }
    });
  }
}

}  // namespace rds
