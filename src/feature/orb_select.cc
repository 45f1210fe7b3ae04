// SPDX-License-Identifier: Apache-2.0
#include "feature/orb_select.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace rds {
namespace {

// Cells of equal size over an image; the division by the cell size is a multiplication.
class Grid {
 public:
  Grid(int width, int height, double cell_px)
      : columns_(std::max(1, static_cast<int>(std::lround(width / cell_px)))),
        rows_(std::max(1, static_cast<int>(std::lround(height / cell_px)))),
        columns_per_px_((static_cast<std::uint32_t>(columns_) << 16U) / static_cast<std::uint32_t>(width)),
        rows_per_px_((static_cast<std::uint32_t>(rows_) << 16U) / static_cast<std::uint32_t>(height)) {}

  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  }
  [[nodiscard]] std::uint32_t CellOf(const Corner& corner) const {
    const std::uint32_t row = (static_cast<std::uint32_t>(corner.y) * rows_per_px_) >> 16U;
    const std::uint32_t column = (static_cast<std::uint32_t>(corner.x) * columns_per_px_) >> 16U;
    return row * static_cast<std::uint32_t>(columns_) + column;
  }

 private:
  int columns_;
  int rows_;
  std::uint32_t columns_per_px_;  // times 2^16
  std::uint32_t rows_per_px_;
};

constexpr double kThresholdCellPx = 35;
constexpr double kCornersPerCell = 6;  // of Spread's grid, on average

}  // namespace

void CornerSelector::DropWeak(int width, int height, std::uint8_t strong_threshold, std::vector<Corner>& corners) {
  const Grid grid(width, height, kThresholdCellPx);
  strongest_.assign(grid.size(), 0);
  for (const Corner& corner : corners) {
    std::uint8_t& strongest = strongest_[grid.CellOf(corner)];
    strongest = std::max(strongest, corner.score);
  }
  // Compaction without branches: which corners are weak is hard to predict.
  Corner* kept = corners.data();
  for (const Corner& corner : corners) {
    *kept = corner;
    kept += static_cast<int>(corner.score > strong_threshold) |
            static_cast<int>(strongest_[grid.CellOf(corner)] <= strong_threshold);
  }
  corners.erase(corners.begin() + (kept - corners.data()), corners.end());
}

void CornerSelector::Spread(int width, int height, std::size_t wanted, std::vector<Corner>& corners) {
  if (corners.size() <= wanted) {
    return;
  }
  if (wanted == 0) {
    corners.clear();
    return;
  }
  const Grid grid(width, height,
                  std::sqrt(kCornersPerCell * static_cast<double>(width) * height / static_cast<double>(wanted)));

  // Counting sort into the cells, best first in each; equal scores keep their order.
  cell_start_.assign(grid.size() + 1, 0);
  cell_of_.resize(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    cell_of_[i] = grid.CellOf(corners[i]);
    ++cell_start_[cell_of_[i]];
  }
  std::uint32_t start = 0;
  for (std::uint32_t& cell : cell_start_) {
    start += cell;
    cell = start - cell;
  }
  sorted_.resize(corners.size());
  cell_end_ = cell_start_;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::uint32_t begin = cell_start_[cell_of_[i]];
    std::uint32_t at = cell_end_[cell_of_[i]]++;
    for (; at > begin && sorted_[at - 1].score < corners[i].score; --at) {
      sorted_[at] = sorted_[at - 1];
    }
    sorted_[at] = corners[i];
  }

  value_.resize(corners.size());
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    std::uint32_t place = 1;
    for (std::uint32_t i = cell_start_[cell]; i < cell_start_[cell + 1]; ++i, ++place) {
      value_[i] = (static_cast<std::uint32_t>(sorted_[i].score) << 16U) / place;
    }
  }
  ordered_ = value_;
  const auto last = ordered_.begin() + static_cast<std::ptrdiff_t>(wanted) - 1;
  std::nth_element(ordered_.begin(), last, ordered_.end(), std::greater<>());
  const std::uint32_t lowest = *last;
  // Of those that equal the lowest value, the first.
  auto ties = wanted - static_cast<std::size_t>(
                           std::count_if(ordered_.begin(), last, [lowest](std::uint32_t v) { return v > lowest; }));
  corners.clear();
  for (std::size_t i = 0; i < sorted_.size(); ++i) {
    if (value_[i] > lowest || (value_[i] == lowest && ties > 0)) {
      ties -= value_[i] == lowest ? 1 : 0;
      corners.push_back(sorted_[i]);
    }
  }
}

}  // namespace rds
