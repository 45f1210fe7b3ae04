// SPDX-License-Identifier: Apache-2.0
#include "geometry/rigid3.h"

#include <gtest/gtest.h>

#include <numbers>

#include "base/random.h"
#include "geometry/numeric_jacobian.h"

namespace rds {
namespace {

constexpr double kPi = std::numbers::pi;

Eigen::Vector3d RandomVector(Random* random) {
  return {random->Gaussian(0, 1), random->Gaussian(0, 1), random->Gaussian(0, 1)};
}

Rigid3 RandomPose(Random* random) { return {ExpSo3(RandomVector(random)), RandomVector(random)}; }

void ExpectNear(const Rigid3& a, const Rigid3& b, double tolerance) {
  EXPECT_LT(AngleOf(a.rotation * b.rotation.conjugate()), tolerance);
  EXPECT_LT((a.translation - b.translation).norm(), tolerance);
}

TEST(So3, ExpIsARotationAboutTheVector) {
  const Eigen::Vector3d w(0.3, -0.4, 1.2);
  const Eigen::Matrix3d expected = Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix();
  EXPECT_TRUE(ExpSo3(w).toRotationMatrix().isApprox(expected, 1e-14));
  EXPECT_EQ(ExpSo3(Eigen::Vector3d::Zero()).coeffs(), Eigen::Quaterniond::Identity().coeffs());
}

TEST(So3, LogUndoesExpAtEveryAngle) {
  Random random(1);
  for (const double angle :
       {1e-300, 1e-16, 1e-11, 1e-9, 1e-8, 1e-7, 1e-4, 0.1, 1.0, 2.0, 3.0, kPi - 1e-4, kPi - 1e-8}) {
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector3d w = angle * RandomVector(&random).normalized();
      EXPECT_LT((LogSo3(ExpSo3(w)) - w).norm(), 1e-14 + 1e-9 * angle) << "angle " << angle;
      EXPECT_NEAR(ExpSo3(w).norm(), 1, 1e-15);
    }
  }
}

TEST(So3, LogIsAccurateForTinyAngles) {
  for (const double angle : {1e-12, 1e-10, 1e-9, 1e-8, 1e-6}) {
    const Eigen::Vector3d w(0.6 * angle, 0, -0.8 * angle);
    EXPECT_LT((LogSo3(ExpSo3(w)) - w).norm(), 1e-12 * angle) << angle;
  }
}

TEST(So3, LogTakesTheShortWay) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, -2) / 3;
  EXPECT_LT((LogSo3(ExpSo3((kPi + 0.1) * axis)) + (kPi - 0.1) * axis).norm(), 1e-12);
  Eigen::Quaterniond negated = ExpSo3(0.3 * axis);
  negated.coeffs() *= -1;
  EXPECT_LT((LogSo3(negated) - 0.3 * axis).norm(), 1e-14);
  negated.coeffs() = -Eigen::Quaterniond::Identity().coeffs();
  EXPECT_EQ(LogSo3(negated).norm(), 0);
  EXPECT_NEAR(LogSo3(ExpSo3(kPi * axis)).norm(), kPi, 1e-12);
}

TEST(So3, CrossMatrixIsTheCrossProduct) {
  const Eigen::Vector3d a(1, 2, 3);
  const Eigen::Vector3d b(-2, 0.5, 4);
  EXPECT_EQ(CrossMatrix(a) * b, a.cross(b));
}

TEST(So3, LeftJacobianMatchesDifferences) {
  for (const double angle : {0.0, 1e-6, 9e-5, 1.1e-4, 0.01, 0.5, 2.0, 3.1}) {
    const Eigen::Vector3d w = angle * Eigen::Vector3d(1, -2, 2) / 3;
    const auto change = [&](const Eigen::Vector3d& moved) { return LogSo3(ExpSo3(moved) * ExpSo3(w).conjugate()); };
    const Eigen::Matrix3d numeric = NumericJacobian<3, 3>(change, w);
    EXPECT_LT((LeftJacobianSo3(w) - numeric).norm(), 1e-8) << angle;
  }
}

TEST(Rigid3, CompositionIsOneTransformAfterTheOther) {
  Random random(2);
  const Rigid3 b_from_a = RandomPose(&random);
  const Rigid3 c_from_b = RandomPose(&random);
  const Eigen::Vector3d point = RandomVector(&random);
  EXPECT_LT(((c_from_b * b_from_a) * point - c_from_b * (b_from_a * point)).norm(), 1e-14);
  EXPECT_TRUE((b_from_a.RotationMatrix() * point + b_from_a.translation).isApprox(b_from_a * point, 1e-14));
}

TEST(Rigid3, InverseUndoes) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Rigid3 pose = RandomPose(&random);
    ExpectNear(pose * pose.Inverse(), Rigid3{}, 1e-14);
    ExpectNear(pose.Inverse() * pose, Rigid3{}, 1e-14);
  }
}

TEST(Rigid3, StaysNormalizedInLongChains) {
  Random random(4);
  Rigid3 pose;
  for (int i = 0; i < 10000; ++i) {
    pose = Rigid3{ExpSo3(0.1 * RandomVector(&random)), Eigen::Vector3d::Zero()} * pose;
  }
  EXPECT_NEAR(pose.rotation.norm(), 1, 1e-15);
}

TEST(Retract, IsAMotionFromTheLeft) {
  Random random(5);
  const Rigid3 pose = RandomPose(&random);
  Eigen::Matrix<double, 6, 1> delta;
  delta << 0.1, 0.2, -0.3, 0.3, -0.2, 0.5;
  const Rigid3 moved = Retract(delta, pose);
  const Eigen::Vector3d point(1, 2, 3);
  EXPECT_TRUE((moved * point).isApprox(ExpSo3(delta.tail<3>()) * (pose * point) + delta.head<3>(), 1e-14));
  EXPECT_EQ(Retract(Tangent6::Zero(), Rigid3{}).translation, Eigen::Vector3d::Zero());
}

TEST(Retract, DerivativeOfAMovedPointMatchesDifferences) {
  Random random(6);
  const Rigid3 pose = RandomPose(&random);
  const Eigen::Vector3d point = RandomVector(&random);
  Eigen::Matrix<double, 3, 6> analytic;
  analytic << Eigen::Matrix3d::Identity(), -CrossMatrix(pose * point);
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  const auto moved = [&](const Vector6& delta) -> Eigen::Vector3d { return Retract(delta, pose) * point; };
  EXPECT_LT((analytic - NumericJacobian<3, 6>(moved, Vector6::Zero().eval())).norm(), 1e-8);
}

TEST(AngleOf, IsTheAngleWhateverTheSign) {
  const Eigen::Vector3d axis = Eigen::Vector3d(2, -1, 2) / 3;
  for (const double angle : {0.0, 1e-9, 0.5, 3.0, kPi}) {
    Eigen::Quaterniond q = ExpSo3(angle * axis);
    EXPECT_NEAR(AngleOf(q), angle, 1e-12);
    q.coeffs() *= -1;
    EXPECT_NEAR(AngleOf(q), angle, 1e-12);
  }
  EXPECT_NEAR(AngleOf(ExpSo3((kPi + 0.5) * axis)), kPi - 0.5, 1e-12);
}

}  // namespace
}  // namespace rds
