// SPDX-License-Identifier: Apache-2.0
#include "propagation/free_space.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "geometry/depth_grid.h"
#include "semantic/keypoint_labels.h"

namespace rds {
namespace {

constexpr double kMostShare = 0.4;  // of the view that can be newly occupied
// Standard deviations of the depth that say nothing: of a static surface seen again, and of what was seen beyond a
// place.
constexpr double kAgainSigmas = 1;
constexpr double kBeyondSigmas = 3;
constexpr int kLeastNeighbors = 4;  // newly occupied, the sample itself among them, in a block of 3 x 3

std::vector<float> LeastDepths(const DepthGrid& grid) {
  std::vector<float> result(grid.size(), 0);
  for (int row = 1; row + 1 < grid.rows(); ++row) {
    for (int column = 1; column + 1 < grid.columns(); ++column) {
      float least = std::numeric_limits<float>::max();
      for (int y = row - 1; y <= row + 1; ++y) {
        const float* const depth_m = &grid.depth_m()[grid.Index(column - 1, y)];
        least = std::min({least, depth_m[0], depth_m[1], depth_m[2]});
      }
      result[grid.Index(column, row)] = least;
    }
  }
  return result;
}

// Takes away what stands alone: noise of the depth. Returns the number of those that are left.
int RemoveSingles(const DepthGrid& grid, std::vector<KeypointLabel>& judged) {
  const std::vector<KeypointLabel> before = judged;
  int left = 0;
  grid.ForEach([&](int column, int row) {
    if (before[grid.Index(column, row)] != KeypointLabel::kDynamic) {
      return;
    }
    int neighbors = 0;
    grid.ForEachAround(column, row,
                       [&](int x, int y) { neighbors += before[grid.Index(x, y)] == KeypointLabel::kDynamic ? 1 : 0; });
    if (neighbors >= kLeastNeighbors) {
      ++left;
    } else {
      judged[grid.Index(column, row)] = KeypointLabel::kNone;
    }
  });
  return left;
}

// One view's word on the samples of a frame; marks those that it saw at all.
void JudgeByView(const FrameData& frame, const Rigid3& view_from_now, const DepthView& view,
                 const FreeSpaceOptions& options, std::vector<KeypointLabel>& judged, std::vector<std::uint8_t>& seen) {
  const DepthGrid& grid = frame.depth_grid();
  const DepthGrid& then = view.data->depth_grid();
  Check(view.least_depth_m.size() == then.size(), "a least depth for each sample of a view");
  const GridWarp warp(frame.camera(), view_from_now);
  const auto margin = static_cast<float>(options.margin_ratio);
  const auto match = static_cast<float>(options.match_ratio);
  const DepthNoiseModel& noise = view.data->camera().depth_noise;
  grid.ForEach([&](int column, int row) {
    const std::size_t i = grid.Index(column, row);
    if (grid[i] <= 0 || judged[i] != KeypointLabel::kNone) {
      return;
    }
    const GridPlace there = warp(grid.Place(column, row));
    const auto place = then.IndexWithin(there);
    if (!place) {
      return;
    }
    const float looked_m = view.least_depth_m[*place];
    seen[i] |= looked_m > 0 ? 1 : 0;
    if (looked_m > there.depth_m + SurfaceTolerance_m(noise, there.depth_m, margin, kBeyondSigmas)) {
      judged[i] = KeypointLabel::kDynamic;
    } else if (!view.labels.empty() && view.labels[*place] == KeypointLabel::kStatic &&
               std::abs(then[*place] - there.depth_m) < SurfaceTolerance_m(noise, there.depth_m, match, kAgainSigmas)) {
      judged[i] = KeypointLabel::kStatic;
    }
  });
}

}  // namespace

std::vector<KeypointLabel> LabelGrid(const FrameData& data, const Image8& mask) {
  const DepthGrid& grid = data.depth_grid();
  Check(mask.width == data.camera().width && mask.height == data.camera().height && mask.channels == 1,
        "the mask has the size of the image");
  std::vector<KeypointLabel> labels;
  labels.reserve(grid.size());
  grid.ForEach([&](int column, int row) {
    labels.push_back(LabelOfPixel(mask.At(DepthGrid::MiddlePixel(column), DepthGrid::MiddlePixel(row))));
  });
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
  std::vector<KeypointLabel> judged(grid.size(), KeypointLabel::kNone);
  std::vector<std::uint8_t> seen(grid.size(), 0);
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
    const auto sample = grid.IndexOfPixel(data.keypoints()[k].raw_x, data.keypoints()[k].raw_y);
    if (sample && judged[*sample] == KeypointLabel::kDynamic) {
      labels[k] = KeypointLabel::kDynamic;
    }
  }
}

}  // namespace rds
