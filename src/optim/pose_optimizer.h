// SPDX-License-Identifier: Apache-2.0
// Optimizes one camera pose over fixed points.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/camera.h"
#include "geometry/rigid3.h"
#include "optim/observation.h"
#include "optim/optim_options.h"
#include "optim/pose_prior.h"

namespace rds {

struct PoseObservation {
  Eigen::Vector3d point_in_world = Eigen::Vector3d::Zero();
  PixelObservation keypoint;
};

struct PoseResult {
  Rigid3 camera_from_world;
  std::vector<std::uint8_t> inlier;  // one for each observation, 1 = its unweighted chi2 is below the 95 % quantile
  int inliers = 0;
  bool converged = false;  // false: fewer than 3 inliers or a singular system; the pose is the initial one
  Eigen::Matrix<double, 6, 6> information =
      Eigen::Matrix<double, 6, 6>::Zero();  // J^T W J at the end, (t, w) order, with the prior's
};

// Levenberg-Marquardt with Huber kernels in rounds of inlier classification; the motion-only bundle adjustment of
// ORB-SLAM (Mur-Artal et al., T-RO 2015, section V) with the weight of RDS-SLAM's equation 6. What is known beforehand
// (or null) counts like an observation that is never an outlier. Re-entrant.
[[nodiscard]] PoseResult OptimizePose(const PinholeCamera& camera, const Rigid3& initial_camera_from_world,
                                      std::span<const PoseObservation> observations,
                                      const PoseOptimizerOptions& options = {}, const PosePrior* prior = nullptr);

}  // namespace rds
