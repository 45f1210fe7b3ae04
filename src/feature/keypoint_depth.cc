// SPDX-License-Identifier: Apache-2.0
#include "feature/keypoint_depth.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rds {
namespace {

// How far depth is registered to color, pixels. Measured: what scatters corners' depths of a first-generation Kinect is
// more than its noise, and follows the slopes.
constexpr double kRegistration_px = 1.5;

// Whether a surface ends next to a pixel of depth `raw`: it is much nearer or farther a few pixels away, or, below
// `near_raw`, there are holes. A sensor that triangulates leaves them beside near surfaces, the wider the nearer, and
// between them often sees the near surface where the camera looks past it.
bool IsAtEdge(const DepthLookup& depth, int x, int y, std::uint16_t raw, double near_raw) {
  constexpr int kMaxDistance_px = 6;
  constexpr int kEdgeShare = 10;  // a tenth of the depth
  constexpr int kEdgeHoles = 2;
  int holes = 0;
  for (const int dy : {-kMaxDistance_px, 0, kMaxDistance_px}) {
    for (const int dx : {-kMaxDistance_px, 0, kMaxDistance_px}) {
      if (x + dx < 0 || y + dy < 0 || x + dx >= depth.width() || y + dy >= depth.height()) {
        continue;
      }
      const std::uint16_t other = depth.At(x + dx, y + dy);
      if (other == 0) {
        ++holes;
      } else if (std::abs(int{other} - int{raw}) > raw / kEdgeShare) {
        return true;
      }
    }
  }
  return holes >= kEdgeHoles && raw < near_raw;
}

// The steepest change of depth toward a neighbor, units a pixel.
double SlopeAt(const DepthLookup& depth, int x, int y, std::uint16_t raw) {
  constexpr int kDistance_px = 3;
  int steepest = 0;
  const auto look = [&](int to_x, int to_y) {
    if (to_x < 0 || to_y < 0 || to_x >= depth.width() || to_y >= depth.height()) {
      return;
    }
    const std::uint16_t other = depth.At(to_x, to_y);
    steepest = std::max(steepest, other == 0 ? 0 : std::abs(int{other} - int{raw}));
  };
  look(x + kDistance_px, y);
  look(x - kDistance_px, y);
  look(x, y + kDistance_px);
  look(x, y - kDistance_px);
  return static_cast<double>(steepest) / kDistance_px;
}

}  // namespace

void LookUpDepth(const PinholeCamera& camera, const DepthLookup& depth, bool edges, const ScalePyramid& pyramid,
                 std::vector<Keypoint>& keypoints) {
  constexpr double kNearBaselines = 15;
  const double near_raw = kNearBaselines * camera.baseline_m * camera.depth_scale;
  for (Keypoint& keypoint : keypoints) {
    const auto x = static_cast<int>(std::lround(keypoint.raw_x));
    const auto y = static_cast<int>(std::lround(keypoint.raw_y));
    const std::uint16_t raw = depth.At(x, y);
    if (raw == 0) {
      continue;
    }
    const double depth_m = raw / camera.depth_scale;
    const double off_px = kRegistration_px + static_cast<double>(pyramid.scale[keypoint.octave]);
    const double slope_m = SlopeAt(depth, x, y, raw) / camera.depth_scale * off_px;
    keypoint.depth_m = static_cast<float>(depth_m);
    keypoint.depth_sigma_m = static_cast<float>(std::hypot(camera.depth_noise.Sigma_m(depth_m), slope_m));
    keypoint.at_edge = edges && IsAtEdge(depth, x, y, raw, near_raw);
  }
}

DepthGrid SampleDepth(const PinholeCamera& camera, const DepthLookup& depth) {
  const int columns = depth.width() / kDepthGridStep;
  const int rows = depth.height() / kDepthGridStep;
  std::vector<float> depth_m;
  depth_m.reserve(static_cast<std::size_t>(columns * rows));
  const auto meters_per_unit = static_cast<float>(1 / camera.depth_scale);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const std::uint16_t raw = depth.At(DepthGrid::MiddlePixel(column), DepthGrid::MiddlePixel(row));
      depth_m.push_back(static_cast<float>(raw) * meters_per_unit);
    }
  }
  return {columns, rows, std::move(depth_m)};
}

}  // namespace rds
