// SPDX-License-Identifier: Apache-2.0
// The features of one RGB-D frame.
#pragma once

#include <Eigen/Core>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/camera.h"
#include "geometry/depth_grid.h"

namespace rds {

// 256-bit binary descriptor (ORB).
using Descriptor = std::array<std::uint64_t, 4>;

// Hamming distance, 0..256.
inline int HammingDistance(const Descriptor& a, const Descriptor& b) {
  return std::popcount(a[0] ^ b[0]) + std::popcount(a[1] ^ b[1]) + std::popcount(a[2] ^ b[2]) +
         std::popcount(a[3] ^ b[3]);
}

// One ORB keypoint.
struct Keypoint {
  float x = 0;  // undistorted pixel
  float y = 0;
  float raw_x = 0;  // pixel in the image as recorded (for masks and drawing); equal to x, y without distortion
  float raw_y = 0;
  float depth_m = 0;        // 0 = no depth
  float depth_sigma_m = 0;  // its standard deviation, above 0 where there is depth
  float angle_deg = 0;      // orientation, [0, 360)
  std::uint8_t octave = 0;  // pyramid level, 0 = finest
  bool at_edge = false;     // the depth around it jumps, or is near and has holes

  [[nodiscard]] bool HasDepth() const { return depth_m > 0; }
  // Undistorted.
  [[nodiscard]] Eigen::Vector2d Pixel() const { return {static_cast<double>(x), static_cast<double>(y)}; }
  // Where its depth puts it in the frame of the camera, meters.
  [[nodiscard]] Eigen::Vector3d PointIn(const PinholeCamera& camera) const {
    return camera.Unproject(Pixel(), static_cast<double>(depth_m));
  }
};

// Scale pyramid of the extractor. Level i is the image shrunk by scale[i] = factor^i; the standard deviation of a
// keypoint's position is scale[i] pixels.
struct ScalePyramid {
  explicit ScalePyramid(int levels = 8, double factor = 1.2);

  int levels;
  double factor;
  std::vector<float> scale;            // factor^i
  std::vector<double> inverse_sigma2;  // 1 / scale^2

  // Level at which a point whose scale-invariance range ends at max_distance_m is expected from `distance_m`; clamped.
  [[nodiscard]] int PredictLevel(float max_distance_m, float distance_m) const {
    const float ratio = max_distance_m / distance_m;
    int level = 0;
    for (int i = 0; i + 1 < levels; ++i) {  // without branches: the level is hard to guess
      level += scale[static_cast<std::size_t>(i)] < ratio ? 1 : 0;
    }
    return level;
  }
};

// What is known of a sample's surface.
enum class SampleMotion : std::uint8_t {
  kNone,
  kBoundary,  // next to a sample of what moves
  kMoves,
};

// Immutable features of one frame: keypoints, descriptors and a grid over the image for window searches.
// Built once, then only read: safe to share between threads by shared_ptr<const FrameData>.
class FrameData {
 public:
  static constexpr int kGridColumns = 64;
  static constexpr int kGridRows = 48;

  // Takes keypoints (undistorted coordinates set) and their descriptors, one for one (else InvariantError). The bounds
  // of the grid are the undistorted image's.
  FrameData(const PinholeCamera& camera, std::vector<Keypoint> keypoints, std::vector<Descriptor> descriptors,
            DepthGrid depth_grid = {});

  [[nodiscard]] const PinholeCamera& camera() const { return camera_; }
  [[nodiscard]] std::span<const Keypoint> keypoints() const { return keypoints_; }
  [[nodiscard]] std::span<const Descriptor> descriptors() const { return descriptors_; }
  [[nodiscard]] std::size_t size() const { return keypoints_.size(); }
  [[nodiscard]] const DepthGrid& depth_grid() const { return depth_grid_; }  // empty if there is none

  // Whether an undistorted pixel lies in the undistorted image.
  [[nodiscard]] bool IsInImage(float x, float y) const {
    return x >= min_x_ && x < max_x_ && y >= min_y_ && y < max_y_;
  }

  // What a window search must know of each keypoint, so that it reads them in one run.
  struct GridItem {
    float x = 0;  // undistorted pixel
    float y = 0;
    float depth_m = 0;  // as in Keypoint
    std::uint16_t index = 0;
    std::uint8_t octave = 0;
  };

  // Calls visit(item) for each keypoint with |dx| < radius_px, |dy| < radius_px and min_octave <= octave <= max_octave,
  // in a fixed order.
  template <typename Visitor>
  void ForEachInWindow(float x, float y, float radius_px, int min_octave, int max_octave, Visitor&& visit) const;

 private:
  [[nodiscard]] int Column(float x) const {
    return static_cast<int>(std::clamp((x - min_x_) * columns_per_px_, 0.0F, kGridColumns - 1.0F));
  }
  [[nodiscard]] int Row(float y) const {
    return static_cast<int>(std::clamp((y - min_y_) * rows_per_px_, 0.0F, kGridRows - 1.0F));
  }

  PinholeCamera camera_;
  std::vector<Keypoint> keypoints_;
  std::vector<Descriptor> descriptors_;
  DepthGrid depth_grid_;
  float min_x_ = 0;
  float max_x_ = 0;
  float min_y_ = 0;
  float max_y_ = 0;
  float columns_per_px_ = 0;
  float rows_per_px_ = 0;
  std::vector<std::uint16_t> cell_start_;  // kGridRows * kGridColumns + 1 offsets into cell_items_, row by row
  std::vector<GridItem> cell_items_;       // cell by cell, ascending by index in each
};

template <typename Visitor>
void FrameData::ForEachInWindow(float x, float y, float radius_px, int min_octave, int max_octave,
                                Visitor&& visit) const {
  const int first_column = Column(x - radius_px);
  const int last_column = Column(x + radius_px);
  const int last_row = Row(y + radius_px);
  // Collected without branches, which would be guessed wrong half the time, and visited afterwards.
  std::array<const GridItem*, 64> inside;
  std::size_t count = 0;
  const auto visit_all = [&] {
    for (std::size_t k = 0; k < count; ++k) {
      visit(*inside[k]);
    }
    count = 0;
  };
  for (int row = Row(y - radius_px); row <= last_row; ++row) {
    // Cells of a row are contiguous, so one run of items covers all columns.
    const auto cell = static_cast<std::size_t>(row * kGridColumns);
    const std::size_t end = cell_start_[cell + static_cast<std::size_t>(last_column) + 1];
    for (std::size_t i = cell_start_[cell + static_cast<std::size_t>(first_column)]; i < end; ++i) {
      const GridItem& item = cell_items_[i];
      inside[count] = &item;
      count += static_cast<std::size_t>(
          static_cast<int>(item.octave >= min_octave) & static_cast<int>(item.octave <= max_octave) &
          static_cast<int>(std::abs(item.x - x) < radius_px) & static_cast<int>(std::abs(item.y - y) < radius_px));
      if (count == inside.size()) {
        visit_all();
      }
    }
  }
  visit_all();
}

}  // namespace rds
