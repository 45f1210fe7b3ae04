// SPDX-License-Identifier: Apache-2.0
#include "tracking/motion_model.h"

#include <cmath>

namespace rds {
namespace {

// Errors of the two poses that a velocity is taken from (standard deviations): no prediction can be better than that.
constexpr double kPoseNoise_m = 0.002;
constexpr double kPoseNoise_rad = 0.003;
constexpr double kGain = 0.5;  // share of the newest step in the velocity

double Information(double acceleration, double seconds, double noise) {
  const double change = acceleration * seconds * seconds;
  return 1 / (change * change + noise * noise);
}

}  // namespace

void MotionModel::Observe(const Rigid3& now_from_before, double seconds) {
  if (!(seconds > 0)) {
    return;
  }
  Eigen::Matrix<double, 6, 1> step;
  step << now_from_before.translation, LogSo3(now_from_before.rotation);
  const Eigen::Matrix<double, 6, 1> velocity = step / seconds;
  velocity_ = velocity_ ? *velocity_ + kGain * (velocity - *velocity_) : velocity;
}

std::optional<Rigid3> MotionModel::Predict(double seconds) const {
  if (!velocity_) {
    return std::nullopt;
  }
  return Rigid3{ExpSo3(seconds * velocity_->tail<3>()), seconds * velocity_->head<3>()};
}

std::optional<PosePrior> MotionModel::Prior(const Rigid3& predicted_camera_from_world, double seconds) const {
  if (!(options_.acceleration_m_s2 > 0) || !velocity_ || !(seconds > 0)) {
    return std::nullopt;
  }
  PosePrior prior{predicted_camera_from_world, {}};
  prior.information.setZero();
  prior.information.diagonal().head<3>().setConstant(Information(options_.acceleration_m_s2, seconds, kPoseNoise_m));
  prior.information.diagonal().tail<3>().setConstant(
      Information(options_.angular_acceleration_rad_s2, seconds, kPoseNoise_rad));
  return prior;
}

}  // namespace rds
