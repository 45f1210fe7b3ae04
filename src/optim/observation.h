// SPDX-License-Identifier: Apache-2.0
// Observations of map points in keypoints, as the optimizers take them.
#pragma once

#include <Eigen/Core>

#include "geometry/camera.h"

namespace rds {

// Keypoint side of an observation. With depth the residual has three rows (x, y, depth_px * inverse depth), without two
// (x, y): residual = weight * sqrt(inverse_sigma2) * (measured - projected), in pixels of level 0. `depth_px` makes
// pixels of inverse depths: an error of one standard deviation of the depth counts as one of the position.
// `weight` is 1 - p of the paper's equation 6 and enters residual and Jacobian alike (so the cost carries weight^2).
struct PixelObservation {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  // undistorted
  double inverse_depth = 0;                         // 1 / m; with depth only
  double depth_px = 0;                              // px m; 0 = no depth
  double inverse_sigma2 = 1;                        // 1 / px^2, from the pyramid level
  double weight = 1;                                // in [0, 1]

  [[nodiscard]] bool HasDepth() const { return depth_px > 0; }
};

// 95 % quantiles of the chi-square distribution, for two and three degrees of freedom.
inline constexpr double kChi2Mono = 5.991;
inline constexpr double kChi2Depth = 7.815;

// The bound on chi2 up to which a keypoint agrees with a projection.
[[nodiscard]] inline constexpr double Chi2Bound(bool has_depth) { return has_depth ? kChi2Depth : kChi2Mono; }

}  // namespace rds
