// SPDX-License-Identifier: Apache-2.0
#include "propagation/free_space.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "propagation/grid_warp.h"
#include "semantic/keypoint_labels.h"

namespace rds {
namespace {

constexpr double kMostShare = 0.4;  // of the view that can have moved in
constexpr int kLeastNeighbors = 4;  // of a sample that moved in, itself among them, in a block of 3 x 3

std::size_t IndexOf(const DepthGrid& grid, int column, int row) {
  return static_cast<std::size_t>(row * grid.columns + column);
}

std::vector<float> LeastDepths(const DepthGrid& grid) {
  std::vector<float> result(grid.depth_m.size(), 0);
  for (int row = 1; row + 1 < grid.rows; ++row) {
    for (int column = 1; column + 1 < grid.columns; ++column) {
      float least = std::numeric_limits<float>::max();
      for (int y = row - 1; y <= row + 1; ++y) {
        const float* const depth_m = &grid.depth_m[IndexOf(grid, column - 1, y)];
        least = std::min({least, depth_m[0], depth_m[1], depth_m[2]});
      }
      result[IndexOf(grid, column, row)] = least;
    }
  }
  return result;
}

// Takes away what stands alone: noise of the depth. Returns the number of those that are left.
int RemoveSingles(const DepthGrid& grid, std::vector<KeypointLabel>& judged) {
  const std::vector<KeypointLabel> before = judged;
  int left = 0;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      if (before[IndexOf(grid, column, row)] != KeypointLabel::kDynamic) {
        continue;
      }
      int neighbors = 0;
      for (int y = std::max(row - 1, 0); y <= std::min(row + 1, grid.rows - 1); ++y) {
        for (int x = std::max(column - 1, 0); x <= std::min(column + 1, grid.columns - 1); ++x) {
          neighbors += before[IndexOf(grid, x, y)] == KeypointLabel::kDynamic ? 1 : 0;
        }
      }
      if (neighbors >= kLeastNeighbors) {
        ++left;
      } else {
        judged[IndexOf(grid, column, row)] = KeypointLabel::kNone;
      }
    }
  }
  return left;
}

// One view's word on the samples of a frame; marks those that it saw at all.
void JudgeByView(const FrameData& frame, const Rigid3& view_from_now, const DepthView& view,
                 const FreeSpaceOptions& options, std::vector<KeypointLabel>& judged, std::vector<std::uint8_t>& seen) {
  const DepthGrid& grid = frame.depth_grid();
  const DepthGrid& then = view.data->depth_grid();
  const GridWarp warp(frame.camera(), view_from_now);
  const auto farther = static_cast<float>(1 + options.margin_ratio);
  const auto same = static_cast<float>(options.match_ratio);
  const auto last_column = static_cast<float>(then.columns - 1);
  const auto last_row = static_cast<float>(then.rows - 1);
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const std::size_t i = IndexOf(grid, column, row);
      const float depth_m = grid.depth_m[i];
      if (depth_m <= 0 || judged[i] != KeypointLabel::kNone) {
        continue;
      }
      const GridPlace there = warp({static_cast<float>(column) + 0.5F, static_cast<float>(row) + 0.5F, depth_m});
      if (!(there.depth_m > 0 && there.column >= 1 && there.row >= 1 && there.column < last_column &&
            there.row < last_row)) {
        continue;
      }
      const std::size_t place = IndexOf(then, static_cast<int>(there.column), static_cast<int>(there.row));
      const float looked_m = view.least_depth_m[place];
      seen[i] |= looked_m > 0 ? 1 : 0;
      if (looked_m > there.depth_m * farther) {
        judged[i] = KeypointLabel::kDynamic;
      } else if (!view.labels.empty() && view.labels[place] == KeypointLabel::kStatic &&
                 std::abs(then.depth_m[place] - there.depth_m) < there.depth_m * same) {
        judged[i] = KeypointLabel::kStatic;
      }
    }
  }
}

}  // namespace

std::vector<KeypointLabel> LabelGrid(const FrameData& data, const Image8& mask) {
  const DepthGrid& grid = data.depth_grid();
  Check(mask.width == data.camera().width && mask.height == data.camera().height && mask.channels == 1,
        "the mask has the size of the image");
  std::vector<KeypointLabel> labels;
  labels.reserve(grid.depth_m.size());
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      labels.push_back(LabelOfPixel(
          mask.At(column * kDepthGridStep + kDepthGridStep / 2, row * kDepthGridStep + kDepthGridStep / 2)));
    }
  }
  return labels;
}

DepthView MakeView(FrameId frame, std::shared_ptr<const FrameData> data, const Rigid3& camera_from_world,
                   std::vector<KeypointLabel> labels) {
  std::vector<float> least_depth_m = LeastDepths(data->depth_grid());
  return {frame, std::move(data), camera_from_world, std::move(labels), std::move(least_depth_m)};
}

std::vector<KeypointLabel> CheckFreeSpace(const FrameData& frame, const Rigid3& camera_from_world,
                                          std::span<const DepthView> views, const FreeSpaceOptions& options) {
  const DepthGrid& grid = frame.depth_grid();
  std::vector<KeypointLabel> judged(grid.depth_m.size(), KeypointLabel::kNone);
  std::vector<std::uint8_t> seen(grid.depth_m.size(), 0);
  for (const DepthView& view : views) {
    JudgeByView(frame, view.camera_from_world * camera_from_world.Inverse(), view, options, judged, seen);
  }
  const auto moved = static_cast<double>(RemoveSingles(grid, judged));
  if (moved > kMostShare * static_cast<double>(std::ranges::count(seen, 1))) {
    std::ranges::replace(judged, KeypointLabel::kDynamic, KeypointLabel::kNone);
  }
  return judged;
}

std::vector<PosedFrame> EarlierKeyframes(const Map& map, KeyframeId id) {
  const Keyframe& keyframe = map.At(id);
  std::vector<const Keyframe*> candidates;
  const auto self = std::ranges::lower_bound(map.keyframes(), id);
  for (auto other = std::reverse_iterator(self); other != map.keyframes().rend(); ++other) {
    const Keyframe& earlier = map.At(*other);
    if (keyframe.frame.value - earlier.frame.value > kFreeSpaceFrames) {
      break;
    }
    if (earlier.world == keyframe.world) {
      candidates.push_back(&earlier);
    }
  }
  std::vector<PosedFrame> spread;
  const auto count = std::min(candidates.size(), kFreeSpaceViews);
  for (std::size_t i = 1; i <= count; ++i) {
    const Keyframe& chosen = *candidates[i * candidates.size() / count - 1];
    spread.push_back({chosen.frame, chosen.data, chosen.camera_from_world});
  }
  return spread;
}

void MarkNewlyOccupied(const FrameData& data, std::span<const KeypointLabel> judged,
                       std::vector<KeypointLabel>& labels) {
  const DepthGrid& grid = data.depth_grid();
  for (std::size_t k = 0; k < labels.size(); ++k) {
    const int column = static_cast<int>(data.keypoints()[k].raw_x) / kDepthGridStep;
    const int row = static_cast<int>(data.keypoints()[k].raw_y) / kDepthGridStep;
    if (column < grid.columns && row < grid.rows && judged[IndexOf(grid, column, row)] == KeypointLabel::kDynamic) {
      labels[k] = KeypointLabel::kDynamic;
    }
  }
}

}  // namespace rds
