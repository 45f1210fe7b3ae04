// SPDX-License-Identifier: Apache-2.0
// Reprojection error of a point in the camera frame, and its derivative.
#pragma once

#include <Eigen/Core>
#include <limits>

#include "geometry/camera.h"
#include "optim/observation.h"

namespace rds {

// Points nearer than this (meters) count as behind the camera.
inline constexpr double kMinReprojectionDepth_m = 1e-6;

// Measured minus projected (x, y, depth_px * inverse depth), px; the third row is zero without depth. The point has z >
// 0.
inline Eigen::Vector3d ReprojectionError(const PinholeCamera& camera, const PixelObservation& keypoint,
                                         const Eigen::Vector3d& point_in_camera) {
  const double inverse_z = 1.0 / point_in_camera.z();
  const double u = camera.fx * point_in_camera.x() * inverse_z + camera.cx;
  const double v = camera.fy * point_in_camera.y() * inverse_z + camera.cy;
  return {keypoint.pixel.x() - u, keypoint.pixel.y() - v, keypoint.depth_px * (keypoint.inverse_depth - inverse_z)};
}

// Derivative of ReprojectionError by the point.
inline Eigen::Matrix3d ReprojectionJacobian(const PinholeCamera& camera, const PixelObservation& keypoint,
                                            const Eigen::Vector3d& point_in_camera) {
  const double inverse_z = 1.0 / point_in_camera.z();
  const double gx = camera.fx * inverse_z;
  const double gy = camera.fy * inverse_z;
  const double gxz = gx * point_in_camera.x() * inverse_z;
  const double gyz = gy * point_in_camera.y() * inverse_z;
  Eigen::Matrix3d jacobian;
  jacobian << -gx, 0, gxz,  //
      0, -gy, gyz,          //
      0, 0, keypoint.depth_px * inverse_z * inverse_z;
  return jacobian;
}

// Squared error in standard deviations, without the weight; infinite behind the camera or where not finite.
inline double ReprojectionChi2(const PinholeCamera& camera, const PixelObservation& keypoint,
                               const Eigen::Vector3d& point_in_camera) {
  if (point_in_camera.z() > kMinReprojectionDepth_m) {
    const double chi2 = ReprojectionError(camera, keypoint, point_in_camera).squaredNorm() * keypoint.inverse_sigma2;
    if (chi2 < std::numeric_limits<double>::max()) {
      return chi2;
    }
  }
  return std::numeric_limits<double>::infinity();
}

// Whether chi2 is within the 95 % quantile.
inline bool IsInlier(const PixelObservation& keypoint, double chi2) { return chi2 <= Chi2Bound(keypoint.HasDepth()); }

}  // namespace rds
