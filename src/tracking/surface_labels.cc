#include "tracking/surface_labels.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace rds {
namespace {

constexpr int kStraightPx = kDepthGridStep;
constexpr int kDiagonalPx = 11;
static_assert(kDepthGridStep == 8);

}  // namespace

void SurfaceLabels::Start(const DepthGrid& grid) {
  columns_ = grid.columns + 2;
  const auto size = static_cast<std::size_t>(columns_ * (grid.rows + 2));
  Check(std::ssize(grid.depth_m) == grid.columns * grid.rows, "a depth for each sample of the grid");
  depth_m_.assign(size, 0.0F);
  for (int row = 0; row < grid.rows; ++row) {
    std::copy_n(grid.depth_m.begin() + row * grid.columns, grid.columns, depth_m_.begin() + (row + 1) * columns_ + 1);
  }
  cells_.assign(size, State{});
}

std::optional<SurfaceLabels::Cell> SurfaceLabels::Find(const Keypoint& keypoint) const {
  if (!keypoint.HasDepth()) {
    return std::nullopt;
  }
  const int column = static_cast<int>(keypoint.raw_x) / kDepthGridStep + 1;
  const int cell = (static_cast<int>(keypoint.raw_y) / kDepthGridStep + 1) * columns_ + column;
  if (column >= columns_ - 1 || cell + columns_ >= static_cast<int>(depth_m_.size())) {
    return std::nullopt;  // right of or below the last whole block
  }
  const float tolerance_m = keypoint.depth_m * static_cast<float>(options_.step_depth);
  for (const int step : {0, -1, 1, -columns_, columns_, -columns_ - 1, -columns_ + 1, columns_ - 1, columns_ + 1}) {
    if (std::abs(depth_m_[static_cast<std::size_t>(cell + step)] - keypoint.depth_m) < tolerance_m) {
      return static_cast<Cell>(cell + step);
    }
  }
  return std::nullopt;
}

void SurfaceLabels::Offer(Cell cell, int distance_px, bool dynamic) {
  State& state = cells_[cell];
  if (distance_px < state.distance_px && distance_px < Reach(dynamic)) {
    state = {static_cast<std::uint16_t>(distance_px), dynamic};
    queue_[static_cast<std::size_t>(distance_px)].push_back(cell);
  }
}

void SurfaceLabels::Add(const Keypoint& keypoint, const SurfaceLabel& label) {
  if (const auto cell = Find(keypoint)) {
    Offer(*cell, label.distance_px, label.dynamic);
  }
}

void SurfaceLabels::AddSamples(std::span<const KeypointLabel> samples) {
  const auto columns = static_cast<std::size_t>(columns_ - 2);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples[i] != KeypointLabel::kNone) {
      const std::size_t cell = (i / columns + 1) * (columns + 2) + i % columns + 1;
      Offer(static_cast<Cell>(cell), 0, samples[i] == KeypointLabel::kDynamic);
    }
  }
}

// Dijkstra with a bucket for each distance.
void SurfaceLabels::Spread() {
  const auto share = static_cast<float>(options_.step_depth);
  for (int distance_px = 0; distance_px < kMostReach; ++distance_px) {
    std::vector<Cell>& bucket = queue_[static_cast<std::size_t>(distance_px)];
    for (const Cell cell : bucket) {  // what is offered goes into later buckets
      const State state = cells_[cell];
      if (state.distance_px != distance_px) {
        continue;  // reached on a shorter way since
      }
      const float depth_m = depth_m_[cell];
      const float tolerance_m = depth_m * share;
      const auto step = [&](int offset, int length_px) {
        const auto neighbour = static_cast<Cell>(cell + offset);
        if (cells_[neighbour].distance_px > distance_px + length_px &&
            std::abs(depth_m_[neighbour] - depth_m) < tolerance_m) {
          Offer(neighbour, distance_px + length_px, state.dynamic);
        }
      };
      step(-1, kStraightPx);
      step(1, kStraightPx);
      step(-columns_, kStraightPx);
      step(columns_, kStraightPx);
      step(-columns_ - 1, kDiagonalPx);
      step(-columns_ + 1, kDiagonalPx);
      step(columns_ - 1, kDiagonalPx);
      step(columns_ + 1, kDiagonalPx);
    }
    bucket.clear();
  }
}

std::optional<SurfaceLabel> SurfaceLabels::At(const Keypoint& keypoint) const {
  const auto cell = Find(keypoint);
  if (!cell || cells_[*cell].distance_px >= kMostReach) {
    return std::nullopt;
  }
  return SurfaceLabel{cells_[*cell].dynamic, cells_[*cell].distance_px};
}

std::vector<std::uint8_t> SurfaceLabels::Moving() const {
  const int columns = columns_ - 2;
  const int rows = static_cast<int>(cells_.size()) / columns_ - 2;
  std::vector<std::uint8_t> moving;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      if (!cells_[static_cast<std::size_t>((row + 1) * columns_ + column + 1)].dynamic) {
        continue;
      }
      moving.resize(static_cast<std::size_t>(rows * columns));
      for (int y = std::max(row - 1, 0); y <= std::min(row + 1, rows - 1); ++y) {
        for (int x = std::max(column - 1, 0); x <= std::min(column + 1, columns - 1); ++x) {
          moving[static_cast<std::size_t>(y * columns + x)] = 1;
        }
      }
    }
  }
  return moving;
}

}  // namespace rds
