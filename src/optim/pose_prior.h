// SPDX-License-Identifier: Apache-2.0
// What is known of a pose before anything is matched.
#pragma once

#include <Eigen/Core>

#include "geometry/rigid3.h"

namespace rds {

// A Gaussian over poses: with d = pose * mean^-1, the camera's motion that the mean does not explain, PriorResidual =
// (d.translation in meters, log d.rotation in radians) has zero mean and this information (inverse covariance).
struct PosePrior {
  Rigid3 camera_from_world;  // the mean
  Information6 information = Information6::Zero();
};

// The residual at a pose; with a Jacobian, its derivative by Retract (geometry/rigid3.h), too.
[[nodiscard]] Eigen::Matrix<double, 6, 1> PriorResidual(const PosePrior& prior, const Rigid3& camera_from_world,
                                                        Eigen::Matrix<double, 6, 6>* jacobian = nullptr);

// How far from where the mean shows it a point 1 m away is to be searched, in pixels: two standard deviations, by the
// most uncertain directions of turn and translation. Not finite where the information is singular.
[[nodiscard]] double SearchRadius(const PosePrior& prior, double focal_px);

}  // namespace rds
