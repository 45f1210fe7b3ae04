// SPDX-License-Identifier: Apache-2.0
#include "feature/frame_data.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "feature/undistortion.h"

namespace rds {

ScalePyramid::ScalePyramid(int levels_, double factor_) : levels(levels_), factor(factor_) {
  Check(levels > 0 && factor > 1, "a scale pyramid needs a level and a factor above 1");
  for (int i = 0; i < levels; ++i) {
    const double s = std::pow(factor, i);
    scale.push_back(static_cast<float>(s));
    inverse_sigma2.push_back(1.0 / (s * s));
  }
}

FrameData::FrameData(const PinholeCamera& camera, std::vector<Keypoint> keypoints, std::vector<Descriptor> descriptors,
                     DepthGrid depth_grid)
    : camera_(camera),
      keypoints_(std::move(keypoints)),
      descriptors_(std::move(descriptors)),
      depth_grid_(std::move(depth_grid)) {
  Check(keypoints_.size() == descriptors_.size(), "a descriptor for each keypoint");
  Check(keypoints_.size() < std::numeric_limits<std::uint16_t>::max(), "fewer than 65535 keypoints");
  max_x_ = static_cast<float>(camera.width);
  max_y_ = static_cast<float>(camera.height);
  if (camera.HasDistortion()) {
    std::vector<Eigen::Vector2f> corners = {{0, 0}, {max_x_, 0}, {0, max_y_}, {max_x_, max_y_}};
    UndistortPixels(camera, corners);
    min_x_ = std::min(corners[0].x(), corners[2].x());
    max_x_ = std::max(corners[1].x(), corners[3].x());
    min_y_ = std::min(corners[0].y(), corners[1].y());
    max_y_ = std::max(corners[2].y(), corners[3].y());
    Check(
        max_x_ - min_x_ > 0 && max_y_ - min_y_ > 0 && std::isfinite(max_x_ - min_x_) && std::isfinite(max_y_ - min_y_),
        "the undistorted image has a size");
  }
  columns_per_px_ = kGridColumns / (max_x_ - min_x_);
  rows_per_px_ = kGridRows / (max_y_ - min_y_);

  // Counting sort of the keypoints into the cells.
  cell_start_.assign(static_cast<std::size_t>(kGridColumns * kGridRows) + 1, 0);
  cell_items_.resize(keypoints_.size());
  const auto cell_of = [this](const Keypoint& k) {
    return static_cast<std::size_t>(Row(k.y) * kGridColumns + Column(k.x));
  };
  for (const Keypoint& keypoint : keypoints_) {
    ++cell_start_[cell_of(keypoint) + 1];
  }
  for (std::size_t i = 1; i < cell_start_.size(); ++i) {
    cell_start_[i] = static_cast<std::uint16_t>(cell_start_[i] + cell_start_[i - 1]);
  }
  std::vector<std::uint16_t> next(cell_start_.begin(), cell_start_.end() - 1);
  for (std::size_t i = 0; i < keypoints_.size(); ++i) {
    const Keypoint& keypoint = keypoints_[i];
    cell_items_[next[cell_of(keypoint)]++] = {keypoint.x, keypoint.y, keypoint.depth_m, static_cast<std::uint16_t>(i),
                                              keypoint.octave};
  }
}

}  // namespace rds
