// SPDX-License-Identifier: Apache-2.0
// Two-view triangulation.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "feature/frame_data.h"
#include "geometry/rigid3.h"

namespace rds {

// One of two views of a point.
struct PointView {
  const Keypoint* keypoint = nullptr;
  Rigid3 camera_from_world;
};

// Point in the world frame that both keypoints show: from the rays' parallax or, where a keypoint has depth and sees
// the point at a wider virtual angle, from that depth. Nothing if the parallax is too small, the point is behind a
// camera, a reprojection exceeds the chi2 quantile, or distances and octaves disagree.
[[nodiscard]] std::optional<Eigen::Vector3d> TriangulatePoint(const PinholeCamera& camera, const ScalePyramid& pyramid,
                                                              const PointView& a, const PointView& b);

}  // namespace rds
