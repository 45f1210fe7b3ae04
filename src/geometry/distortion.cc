// SPDX-License-Identifier: Apache-2.0
#include "geometry/distortion.h"

#include <cmath>
#include <numbers>

namespace rds {
namespace {

Eigen::Vector2d DistortFisheye(const PinholeCamera& camera, const Eigen::Vector2d& p) {
  const double r = p.norm();
  if (r < 1e-12) {
    return p;
  }
  const auto& k = camera.distortion;
  const double theta = std::atan(r);
  const double t2 = theta * theta;
  return p * (theta * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3])))) / r);
}

Eigen::Vector2d DistortBrownConrady(const PinholeCamera& camera, const Eigen::Vector2d& p) {
  const auto& [k1, k2, p1, p2, k3, k4, k5, k6] = camera.distortion;
  const double r2 = p.squaredNorm();
  const double radial = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1 + r2 * (k4 + r2 * (k5 + r2 * k6)));
  const double xy = 2 * p.x() * p.y();
  return {p.x() * radial + p1 * xy + p2 * (r2 + 2 * p.x() * p.x()),
          p.y() * radial + p1 * (r2 + 2 * p.y() * p.y()) + p2 * xy};
}

// Determinant of the distortion's derivative, numerically: below 0 the image is folded over.
double Determinant(const PinholeCamera& camera, const Eigen::Vector2d& p) {
  constexpr double kStep = 1e-5;
  const Eigen::Vector2d dx{kStep, 0};
  const Eigen::Vector2d dy{0, kStep};
  Eigen::Matrix2d derivative;
  derivative.col(0) = (Distort(camera, p + dx) - Distort(camera, p - dx)) / (2 * kStep);
  derivative.col(1) = (Distort(camera, p + dy) - Distort(camera, p - dy)) / (2 * kStep);
  return derivative.determinant();
}

bool IsInImage(const PinholeCamera& camera, const Eigen::Vector2d& distorted) {
  const double x = camera.fx * distorted.x() + camera.cx;
  const double y = camera.fy * distorted.y() + camera.cy;
  return x >= -0.5 && y >= -0.5 && x <= camera.width - 0.5 && y <= camera.height - 0.5;
}

}  // namespace

Eigen::Vector2d Distort(const PinholeCamera& camera, const Eigen::Vector2d& undistorted) {
  return camera.distortion_model == DistortionModel::kFisheye ? DistortFisheye(camera, undistorted)
                                                              : DistortBrownConrady(camera, undistorted);
}

std::optional<std::string> DistortionProblem(const PinholeCamera& camera) {
  constexpr int kRays = 72;
  constexpr double kStep_deg = 0.25;
  constexpr double kWidest_deg = 80;
  constexpr double kLongestStep = 0.1;  // of the image's width, from one step to the next
  for (int ray = 0; ray < kRays; ++ray) {
    const double angle = 2 * std::numbers::pi * ray / kRays;
    const Eigen::Vector2d direction{std::cos(angle), std::sin(angle)};
    Eigen::Vector2d before = Eigen::Vector2d::Zero();
    for (double off_axis_deg = 0;; off_axis_deg += kStep_deg) {
      if (off_axis_deg > kWidest_deg) {
        return "the image reaches farther than 80 degrees off the optical axis; undistort the images first";
      }
      const Eigen::Vector2d point = std::tan(off_axis_deg * std::numbers::pi / 180) * direction;
      const Eigen::Vector2d distorted = Distort(camera, point);
      if (!distorted.allFinite() || !(Determinant(camera, point) > 0)) {
        return "the distortion folds the image over, so it cannot be undone";
      }
      if (camera.fx * (distorted - before).norm() > kLongestStep * camera.width) {
        return "the distortion tears the image apart";
      }
      if (!IsInImage(camera, distorted)) {
        break;
      }
      before = distorted;
    }
  }
  return std::nullopt;
}

}  // namespace rds
