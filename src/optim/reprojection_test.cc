#include "optim/reprojection.h"

#include <gtest/gtest.h>

#include "geometry/numeric_jacobian.h"

namespace rds {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

PinholeCamera TestCamera() {
  PinholeCamera camera;
  camera.fx = 520;
  camera.fy = 515;
  camera.cx = 318;
  camera.cy = 243;
  return camera;
}

ReprojectionTarget TestTarget() {
  PixelObservation keypoint;
  keypoint.pixel = {300, 200};
  keypoint.right_x = 280;
  keypoint.inverse_sigma2 = 0.6;
  keypoint.weight = 0.7;
  return ReprojectionTarget(keypoint);
}

const Eigen::Vector3d kPoint(0.3, -0.2, 2.1);

PoseVariable At(const Vector6& increment) {
  PoseVariable pose({ExpSo3({0.4, -0.3, 0.2}), {0.1, 0.2, 0.5}});
  Eigen::Map<Vector6>(pose.increment.data()) = increment;
  pose.Update();
  return pose;
}

template <int Rows>
void ExpectJacobiansMatchDifferences(const Vector6& increment) {
  using Vector = Eigen::Matrix<double, Rows, 1>;
  const auto residual = [](const Vector6& change, const Eigen::Vector3d& point) {
    Vector result;
    EvaluateReprojection<Rows>(TestCamera(), At(change), TestTarget(), point.data(), result.data(), nullptr, nullptr);
    return result;
  };
  Vector unused;
  Eigen::Matrix<double, Rows, 6, Eigen::RowMajor> by_increment;
  Eigen::Matrix<double, Rows, 3, Eigen::RowMajor> by_point;
  EvaluateReprojection<Rows>(TestCamera(), At(increment), TestTarget(), kPoint.data(), unused.data(),
                             by_increment.data(), by_point.data());
  const auto numeric_increment =
      NumericJacobian<Rows, 6>([&](const Vector6& x) { return residual(x, kPoint); }, increment);
  const auto numeric_point =
      NumericJacobian<Rows, 3>([&](const Eigen::Vector3d& x) { return residual(increment, x); }, kPoint);
  EXPECT_LT((by_increment - numeric_increment).cwiseAbs().maxCoeff(), 1e-5 * numeric_increment.cwiseAbs().maxCoeff());
  EXPECT_LT((by_point - numeric_point).cwiseAbs().maxCoeff(), 1e-5 * numeric_point.cwiseAbs().maxCoeff());
}

TEST(Reprojection, JacobiansMatchDifferencesAtTheStart) {
  ExpectJacobiansMatchDifferences<2>(Vector6::Zero());
  ExpectJacobiansMatchDifferences<3>(Vector6::Zero());
}

TEST(Reprojection, JacobiansMatchDifferencesFarFromTheStart) {
  Vector6 increment;
  increment << 0.3, -0.1, 0.4, 0.5, -0.4, 0.6;
  ExpectJacobiansMatchDifferences<2>(increment);
  ExpectJacobiansMatchDifferences<3>(increment);
}

TEST(Reprojection, ResidualIsWeightedMeasuredMinusProjected) {
  const PinholeCamera camera = TestCamera();
  const PoseVariable pose(Rigid3{});
  const double scale = 0.7 * std::sqrt(0.6);
  Eigen::Vector3d residual;
  EvaluateReprojection<3>(camera, pose, TestTarget(), kPoint.data(), residual.data(), nullptr, nullptr);
  const Eigen::Vector2d projected = camera.Project(kPoint);
  EXPECT_NEAR(residual.x(), scale * (300 - projected.x()), 1e-12);
  EXPECT_NEAR(residual.y(), scale * (200 - projected.y()), 1e-12);
  EXPECT_NEAR(residual.z(), scale * (280 - (projected.x() - camera.fx * camera.baseline_m / kPoint.z())), 1e-12);
}

TEST(Reprojection, TargetThatTakesNoPartIsZeroEvenForNonsense) {
  const PoseVariable pose(Rigid3{});
  const Eigen::Vector3d nonsense = Eigen::Vector3d::Constant(std::nan(""));
  Eigen::Vector3d residual;
  Eigen::Matrix<double, 3, 6, Eigen::RowMajor> by_increment;
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> by_point;
  EvaluateReprojection<3>(TestCamera(), pose, ReprojectionTarget(), nonsense.data(), residual.data(),
                          by_increment.data(), by_point.data());
  EXPECT_TRUE(residual.isZero(0) && by_increment.isZero(0) && by_point.isZero(0));
}

TEST(Reprojection, PointBehindTheCameraIsFiniteAndBad) {
  const Eigen::Vector3d behind(0.1, 0.1, -1);
  Eigen::Vector3d residual;
  EvaluateReprojection<3>(TestCamera(), PoseVariable(Rigid3{}), TestTarget(), behind.data(), residual.data(), nullptr,
                          nullptr);
  EXPECT_TRUE(residual.allFinite());
  EXPECT_GT(residual.norm(), 1e6);
}

TEST(PoseVariable, ValueIsThePerturbedStart) {
  Vector6 increment;
  increment << 0.3, -0.1, 0.4, 0.5, -0.4, 0.6;
  const PoseVariable pose = At(increment);
  const Rigid3 expected = Perturb(increment, pose.initial_camera_from_world);
  EXPECT_TRUE(pose.Value().rotation.isApprox(expected.rotation, 1e-14));
  EXPECT_TRUE(pose.Value().translation.isApprox(expected.translation, 1e-14));
  EXPECT_TRUE(pose.rotation.isApprox(expected.RotationMatrix(), 1e-14));
  EXPECT_TRUE(pose.translation.isApprox(expected.translation, 1e-14));
}

TEST(PoseVariable, ZeroIncrementKeepsTheBytes) {
  const Rigid3 start{ExpSo3({0.4, -0.3, 0.2}), {0.1, 0.2, 0.5}};
  EXPECT_EQ(PoseVariable(start).Value().rotation.coeffs(), start.rotation.coeffs());
  EXPECT_EQ(PoseVariable(start).Value().translation, start.translation);
}

}  // namespace
}  // namespace rds
