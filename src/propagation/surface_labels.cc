// SPDX-License-Identifier: Apache-2.0
#include "propagation/surface_labels.h"

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
  columns_ = grid.columns() + 2;
  const auto size = static_cast<std::size_t>(columns_ * (grid.rows() + 2));
  depth_m_.assign(size, 0.0F);
  for (int row = 0; row < grid.rows(); ++row) {
    std::copy_n(grid.depth_m().begin() + row * grid.columns(), grid.columns(),
                depth_m_.begin() + (row + 1) * columns_ + 1);
  }
  cells_.assign(size, SurfaceLabel{});
}

void SurfaceLabels::Offer(Cell cell, int distance_px, bool dynamic) {
  SurfaceLabel& label = cells_[cell];
  if (distance_px < label.distance_px && distance_px < options_.MaxDistance(dynamic)) {
    label = {static_cast<std::uint16_t>(distance_px), dynamic};
    queue_[static_cast<std::size_t>(distance_px)].push_back(cell);
  }
}

void SurfaceLabels::Add(std::span<const SurfaceLabel> samples, int farther_px) {
  const auto columns = static_cast<std::size_t>(columns_ - 2);
  Check(samples.empty() || samples.size() == columns * (cells_.size() / (columns + 2) - 2),
        "a label for each sample of the grid");
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::size_t cell = (i / columns + 1) * (columns + 2) + i % columns + 1;
    Offer(static_cast<Cell>(cell), samples[i].distance_px + farther_px, samples[i].dynamic);
  }
}

void SurfaceLabels::Add(std::span<const KeypointLabel> samples, int farther_px) {
  std::vector<SurfaceLabel> labels(samples.size());
  std::ranges::transform(samples, labels.begin(), ToSurfaceLabel);
  Add(labels, farther_px);
}

// Dijkstra with a bucket for each distance.
void SurfaceLabels::Spread() {
  const auto ratio = static_cast<float>(options_.depth_step_ratio);
  for (int distance_px = 0; distance_px < SurfaceLabel::kNone; ++distance_px) {
    std::vector<Cell>& bucket = queue_[static_cast<std::size_t>(distance_px)];
    for (const Cell cell : bucket) {  // what is offered goes into later buckets
      const SurfaceLabel label = cells_[cell];
      if (label.distance_px != distance_px) {
        continue;  // reached on a shorter way since
      }
      const float depth_m = depth_m_[cell];
      const auto step = [&](int offset, int length_px) {
        const auto neighbor = static_cast<Cell>(static_cast<int>(cell) + offset);
        if (cells_[neighbor].distance_px > distance_px + length_px && SameSurface(depth_m, depth_m_[neighbor], ratio)) {
          Offer(neighbor, distance_px + length_px, label.dynamic);
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

std::vector<SurfaceLabel> SurfaceLabels::Labels() const {
  std::vector<SurfaceLabel> labels;
  labels.reserve(cells_.size());
  for (int first = columns_ + 1; first + columns_ < std::ssize(cells_); first += columns_) {
    labels.insert(labels.end(), cells_.begin() + first, cells_.begin() + first + columns_ - 2);
  }
  return labels;
}

std::vector<SurfaceLabel> SpreadLabels(const FrameData& data, std::span<const KeypointLabel> labels, int reach_px) {
  Check(labels.size() == data.size(), "a label for each keypoint");
  constexpr float kSameThing = 0.15F;  // difference of a keypoint's depth from its sample's, as a ratio
  const DepthGrid& grid = data.depth_grid();
  if (grid.empty()) {
    return {};
  }
  std::vector<KeypointLabel> samples(grid.size(), KeypointLabel::kNone);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const Keypoint& keypoint = data.keypoints()[i];
    const auto sample = grid.IndexOfPixel(keypoint.raw_x, keypoint.raw_y);
    if (labels[i] != KeypointLabel::kNone && sample && samples[*sample] != KeypointLabel::kDynamic &&
        SameSurface(keypoint.depth_m, grid[*sample], kSameThing)) {
      samples[*sample] = labels[i];
    }
  }
  SurfaceLabels surfaces({.max_dynamic_distance_px = reach_px, .max_static_distance_px = reach_px});
  surfaces.Start(grid);
  surfaces.Add(std::span<const KeypointLabel>(samples));
  surfaces.Spread();
  return surfaces.Labels();
}

}  // namespace rds
