// SPDX-License-Identifier: Apache-2.0
#include "optim/pose_prior.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/numeric_jacobian.h"

namespace rds {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

const Rigid3 kMean{ExpSo3({0.4, -0.3, 0.2}), {1.0, -2.0, 3.0}};

TEST(PosePrior, TheResidualIsTheMotionFromTheMean) {
  const Rigid3 motion{ExpSo3({0.01, 0.02, -0.03}), {0.1, -0.2, 0.3}};
  const Vector6 residual = PriorResidual({kMean, Matrix6::Identity()}, motion * kMean);
  EXPECT_LT((residual.head<3>() - motion.translation).norm(), 1e-12);
  EXPECT_LT((residual.tail<3>() - Eigen::Vector3d(0.01, 0.02, -0.03)).norm(), 1e-9);
  EXPECT_LT(PriorResidual({kMean, Matrix6::Identity()}, kMean).norm(), 1e-9);
}

TEST(PosePrior, TheJacobianMatchesDifferences) {
  const PosePrior prior{kMean, Matrix6::Identity()};
  for (const double size : {0.0, 0.01, 0.8}) {
    const Rigid3 pose = Rigid3{ExpSo3(size * Eigen::Vector3d(1, -0.5, 0.7)), {size, -size, 2 * size}} * kMean;
    Matrix6 jacobian;
    EXPECT_TRUE(PriorResidual(prior, pose, &jacobian).allFinite());
    const auto residual = [&](const Vector6& delta) -> Vector6 { return PriorResidual(prior, Retract(delta, pose)); };
    const Matrix6 expected = NumericJacobian<6, 6>(residual, Vector6::Zero());
    EXPECT_LT((jacobian - expected).norm(), 1e-6) << size;
  }
}

TEST(PosePrior, TheSearchRadiusesAsFarAsTurnAndTranslationAreUncertain) {
  PosePrior prior;
  prior.information.diagonal() << 1e4, 1e6, 1e6, 1e6, 1e6, 1e4;  // 1 cm at most, .01 rad at most
  EXPECT_NEAR(SearchRadius(prior, 500), 2 * 500 * std::sqrt(2e-4), 1e-9);
  prior.information.setZero();
  EXPECT_FALSE(std::isfinite(SearchRadius(prior, 500)));
}

}  // namespace
}  // namespace rds
