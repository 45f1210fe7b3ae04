// SPDX-License-Identifier: Apache-2.0
#include "optim/pose_prior.h"

#include <Eigen/LU>
#include <cmath>

namespace rds {

Eigen::Matrix<double, 6, 1> PriorResidual(const PosePrior& prior, const Rigid3& camera_from_world,
                                          Eigen::Matrix<double, 6, 6>* jacobian) {
  const Rigid3 d = camera_from_world * prior.camera_from_world.Inverse();
  Eigen::Matrix<double, 6, 1> residual;
  residual << d.translation, LogSo3(d.rotation);
  if (jacobian != nullptr) {
    // d <- motion * d
    jacobian->setIdentity();
    jacobian->topRightCorner<3, 3>() = -CrossMatrix(d.translation);
    jacobian->bottomRightCorner<3, 3>() = LeftJacobianSo3(residual.tail<3>()).inverse();
  }
  return residual;
}

double SearchRadius(const PosePrior& prior, double focal_px) {
  const Eigen::Matrix<double, 6, 1> variances = prior.information.inverse().diagonal();
  return 2 * focal_px * std::sqrt(variances.head<3>().maxCoeff() + variances.tail<3>().maxCoeff());
}

}  // namespace rds
