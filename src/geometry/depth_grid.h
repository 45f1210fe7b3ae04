// SPDX-License-Identifier: Apache-2.0
// A depth image on a coarse grid: what it shows of surfaces, and where they lie in another view.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "geometry/camera.h"
#include "geometry/depth_ratio.h"
#include "geometry/rigid3.h"

namespace rds {

inline constexpr int kDepthGridStep = 8;  // pixels of the recorded image

// Whether a depth may be that of the surface at `depth_m`.
[[nodiscard]] inline bool SameSurface(float depth_m, float other_m, float ratio) {
  return std::abs(other_m - depth_m) < ratio * depth_m;
}

// A place of a view: sample (i, j) of the depth grid covers [i, i + 1) x [j, j + 1), so a keypoint lies at its recorded
// pixel over kDepthGridStep.
struct GridPlace {
  float column = 0;
  float row = 0;
  float depth_m = 0;  // not above 0: behind the camera
};

// Depth of every kDepthGridStep-th pixel of the recorded image, row by row: sample (i, j) lies at the middle of its
// kDepthGridStep x kDepthGridStep block. A value.
class DepthGrid {
 public:
  DepthGrid() = default;  // no samples
  // InvariantError unless there is a depth (meters, 0 = unknown) for each sample.
  DepthGrid(int columns, int rows, std::vector<float> depth_m);

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] std::size_t size() const { return depth_m_.size(); }
  [[nodiscard]] bool empty() const { return depth_m_.empty(); }
  [[nodiscard]] const std::vector<float>& depth_m() const { return depth_m_; }
  [[nodiscard]] float operator[](std::size_t sample) const { return depth_m_[sample]; }

  [[nodiscard]] std::size_t Index(int column, int row) const {
    return static_cast<std::size_t>(row * columns_ + column);
  }
  // The sample around a pixel of the recorded image; nothing in the margin that no sample covers.
  [[nodiscard]] std::optional<std::size_t> IndexOfPixel(float x, float y) const {
    const int column = static_cast<int>(x) / kDepthGridStep;
    const int row = static_cast<int>(y) / kDepthGridStep;
    return column < columns_ && row < rows_ ? std::optional(Index(column, row)) : std::nullopt;
  }
  // The sample at a place that has a sample on each side; nothing behind the camera.
  [[nodiscard]] std::optional<std::size_t> IndexWithin(const GridPlace& place) const {
    return place.depth_m > 0 && place.column >= 1 && place.row >= 1 &&
                   place.column < static_cast<float>(columns_ - 1) && place.row < static_cast<float>(rows_ - 1)
               ? std::optional(Index(static_cast<int>(place.column), static_cast<int>(place.row)))
               : std::nullopt;
  }
  // The middle of a sample.
  [[nodiscard]] GridPlace Place(int column, int row) const {
    return {static_cast<float>(column) + 0.5F, static_cast<float>(row) + 0.5F, depth_m_[Index(column, row)]};
  }
  // The same as a coordinate of the recorded image.
  [[nodiscard]] static int MiddlePixel(int column_or_row) {
    return column_or_row * kDepthGridStep + kDepthGridStep / 2;
  }

  // Calls visit(column, row) for every `step`-th sample in each direction, from step / 2 on, row by row.
  template <typename Visitor>
  void ForEach(Visitor&& visit, int step = 1) const {
    for (int row = step / 2; row < rows_; row += step) {
      for (int column = step / 2; column < columns_; column += step) {
        visit(column, row);
      }
    }
  }
  // Calls visit(column, row) for a sample and those around it, row by row.
  template <typename Visitor>
  void ForEachAround(int column, int row, Visitor&& visit) const {
    for (int y = std::max(row - 1, 0); y <= std::min(row + 1, rows_ - 1); ++y) {
      for (int x = std::max(column - 1, 0); x <= std::min(column + 1, columns_ - 1); ++x) {
        visit(x, y);
      }
    }
  }

 private:
  int columns_ = 0;
  int rows_ = 0;
  std::vector<float> depth_m_;
};

// Takes places of one view to another of the same camera. In single precision: samples are coarse, and there are many.
// Distortion of the lens, a few pixels, is not taken out.
class GridWarp {
 public:
  GridWarp(const PinholeCamera& camera, const Rigid3& to_from_from) {
    Eigen::Matrix3d k;
    k << camera.fx / kDepthGridStep, 0, camera.cx / kDepthGridStep,  //
        0, camera.fy / kDepthGridStep, camera.cy / kDepthGridStep,   //
        0, 0, 1;
    rotation_ = (k * to_from_from.RotationMatrix() * k.inverse()).cast<float>();
    translation_ = (k * to_from_from.translation).cast<float>();
  }

  [[nodiscard]] GridPlace operator()(const GridPlace& from) const {
    const Eigen::Vector3f there = from.depth_m * (rotation_ * Eigen::Vector3f(from.column, from.row, 1)) + translation_;
    return {there.x() / there.z(), there.y() / there.z(), there.z()};
  }

 private:
  Eigen::Matrix3f rotation_;
  Eigen::Vector3f translation_;
};

}  // namespace rds
