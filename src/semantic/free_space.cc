#include "semantic/free_space.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "semantic/evidence.h"

namespace rds {
namespace {

constexpr int kLeastNeighbours = 4;  // of a sample that moved in, itself among them, in a block of 3 x 3

std::size_t IndexOf(const DepthGrid& grid, int column, int row) {
  return static_cast<std::size_t>(row * grid.columns + column);
}

// Least depth around a pixel, 0 if some of the block is unknown: at an edge the nearer surface counts, so that a
// slightly wrong pose empties no place.
float LeastDepthAround(const DepthGrid& grid, int column, int row) {
  float least = std::numeric_limits<float>::max();
  for (int y = row - 1; y <= row + 1; ++y) {
    for (int x = column - 1; x <= column + 1; ++x) {
      least = std::min(least, grid.depth_m[IndexOf(grid, x, y)]);
    }
  }
  return least;
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
      int neighbours = 0;
      for (int y = std::max(row - 1, 0); y <= std::min(row + 1, grid.rows - 1); ++y) {
        for (int x = std::max(column - 1, 0); x <= std::min(column + 1, grid.columns - 1); ++x) {
          neighbours += before[IndexOf(grid, x, y)] == KeypointLabel::kDynamic ? 1 : 0;
        }
      }
      if (neighbours >= kLeastNeighbours) {
        ++left;
      } else {
        judged[IndexOf(grid, column, row)] = KeypointLabel::kNone;
      }
    }
  }
  return left;
}

// One view's word on the samples of a frame; marks those that it saw at all.
void JudgeByView(const FrameData& frame, const Rigid3& view_from_now, const SeenView& view,
                 const FreeSpaceOptions& options, std::vector<KeypointLabel>& judged, std::vector<std::uint8_t>& seen) {
  const DepthGrid& grid = frame.depth_grid();
  const DepthGrid& then = view.data->depth_grid();
  const PinholeCamera& camera = frame.camera();
  const Eigen::Matrix3d rotation = view_from_now.RotationMatrix();
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const std::size_t i = IndexOf(grid, column, row);
      const auto depth_m = static_cast<double>(grid.depth_m[i]);
      if (depth_m <= 0 || judged[i] == KeypointLabel::kDynamic) {
        continue;
      }
      const Eigen::Vector2d pixel((column + 0.5) * kDepthGridStep, (row + 0.5) * kDepthGridStep);
      const Eigen::Vector3d there = rotation * camera.Unproject(pixel, depth_m) + view_from_now.translation;
      if (there.z() <= 0) {
        continue;
      }
      const Eigen::Vector2d place = camera.Project(there) / kDepthGridStep;
      if (!(place.x() >= 1 && place.y() >= 1 && place.x() < then.columns - 1 && place.y() < then.rows - 1)) {
        continue;
      }
      const auto x = static_cast<int>(place.x());
      const auto y = static_cast<int>(place.y());
      const auto looked_m = static_cast<double>(LeastDepthAround(then, x, y));
      seen[i] |= looked_m > 0 ? 1 : 0;
      if (looked_m > there.z() * (1 + options.margin_depth)) {
        judged[i] = KeypointLabel::kDynamic;
      } else if (!view.labels.empty() && view.labels[IndexOf(then, x, y)] == KeypointLabel::kStatic &&
                 std::abs(static_cast<double>(then.depth_m[IndexOf(then, x, y)]) - there.z()) <
                     there.z() * options.match_depth) {
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

std::vector<KeypointLabel> JudgeBySpace(const FrameData& frame, const Rigid3& camera_from_world,
                                        std::span<const SeenView> views, const FreeSpaceOptions& options) {
  const DepthGrid& grid = frame.depth_grid();
  std::vector<KeypointLabel> judged(grid.depth_m.size(), KeypointLabel::kNone);
  std::vector<std::uint8_t> seen(grid.depth_m.size(), 0);
  for (const SeenView& view : views) {
    JudgeByView(frame, view.camera_from_world * camera_from_world.Inverse(), view, options, judged, seen);
  }
  const auto moved = static_cast<double>(RemoveSingles(grid, judged));
  if (moved > options.most_share * static_cast<double>(std::ranges::count(seen, 1))) {
    std::ranges::replace(judged, KeypointLabel::kDynamic, KeypointLabel::kNone);
  }
  return judged;
}

std::vector<SeenView> EarlierViews(const Map& map, KeyframeId id, const FreeSpaceOptions& options) {
  const Keyframe& keyframe = map.At(id);
  std::vector<const Keyframe*> candidates;
  for (auto other = map.keyframes().rbegin(); other != map.keyframes().rend(); ++other) {
    const Keyframe& earlier = map.At(*other);
    if (earlier.frame >= keyframe.frame) {
      continue;
    }
    if (keyframe.frame.value - earlier.frame.value > static_cast<std::uint32_t>(options.most_frames)) {
      break;
    }
    candidates.push_back(&earlier);
  }
  std::vector<SeenView> views;
  const auto count = std::min(candidates.size(), static_cast<std::size_t>(options.views));
  for (std::size_t i = 1; i <= count; ++i) {
    const Keyframe& chosen = *candidates[i * candidates.size() / count - 1];
    views.push_back({chosen.frame, chosen.data, chosen.camera_from_world, {}});
  }
  return views;
}

void LabelMovedIn(const FrameData& data, std::span<const KeypointLabel> judged, std::vector<KeypointLabel>& labels) {
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
