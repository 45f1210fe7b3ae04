// SPDX-License-Identifier: Apache-2.0
#include "tracking/depth_registration.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace rds {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr int kIterations = 4;     // of Gauss-Newton
constexpr int kLeastSamples = 50;  // fewer that lie on a surface of the other view say nothing
constexpr float kNearest_m = 0.3F;
constexpr float kFarthest_m = 4;  // depth says little beyond
constexpr double kHuber = 2;      // standard deviations
constexpr int kReach = 3;         // samples to each side that make a plane: fewer, and noise makes its normal

// Standard deviation of a sample's distance from the plane that it is said to lie on: 3 mm for the nearest. The noise
// of structured-light depth grows with the square of the depth (Khoshelham and Oude Elberink, Sensors 2012), and what
// is far lies on planes through samples farther apart, so with its cube. Measured: with the square, far walls pull
// poses away.
double PlaneSigma(double depth_m) { return 0.003 + 0.0015 * depth_m * depth_m * depth_m; }

Eigen::Vector3d PointAt(const PinholeCamera& camera, int column, int row, double depth_m) {
  return camera.Unproject({DepthGrid::MiddlePixel(column), DepthGrid::MiddlePixel(row)}, depth_m);
}

struct Plane {
  Eigen::Vector3d point;
  Eigen::Vector3d normal;  // unit
};

// The surface around a sample, in the frame of the camera; nothing at edges and where it bends. On a plane the inverse
// of the depth is linear in the image.
std::optional<Plane> PlaneAt(const PinholeCamera& camera, const DepthGrid& grid, int column, int row) {
  if (column < kReach || row < kReach || column >= grid.columns() - kReach || row >= grid.rows() - kReach) {
    return std::nullopt;
  }
  const float* const depth_m = &grid.depth_m()[grid.Index(column, row)];
  const float center = depth_m[0];
  const float left = depth_m[-kReach];
  const float right = depth_m[kReach];
  const float up = depth_m[-kReach * grid.columns()];
  const float down = depth_m[kReach * grid.columns()];
  if (!(center > 0 && left > 0 && right > 0 && up > 0 && down > 0)) {
    return std::nullopt;
  }
  const float across = 2 / (1 / left + 1 / right);
  const float along = 2 / (1 / up + 1 / down);
  if (std::abs(across - center) > depth_ratio::kBend * center ||
      std::abs(along - center) > depth_ratio::kBend * center) {
    return std::nullopt;
  }
  const auto at = [&](int columns, int rows, float depth) {
    return PointAt(camera, column + columns, row + rows, static_cast<double>(depth));
  };
  const Eigen::Vector3d to_right = at(kReach, 0, right) - at(-kReach, 0, left);
  const Eigen::Vector3d downward = at(0, kReach, down) - at(0, -kReach, up);
  return Plane{at(0, 0, (2 * center + across + along) / 4), to_right.cross(downward).normalized()};
}

struct Sample {
  Eigen::Vector3d point;  // in the frame's camera
  double sigma_m = 0;
};

std::vector<Sample> CollectSamples(const FrameData& frame, std::span<const std::uint8_t> usable) {
  const DepthGrid& grid = frame.depth_grid();
  std::vector<Sample> samples;
  const auto collect = [&](int column, int row) {
    const std::size_t i = grid.Index(column, row);
    if (grid[i] > kNearest_m && grid[i] < kFarthest_m && (usable.empty() || usable[i] != 0)) {
      const auto depth_m = static_cast<double>(grid[i]);
      samples.push_back({PointAt(frame.camera(), column, row, depth_m), PlaneSigma(depth_m)});
    }
  };
  grid.ForEach(collect, kRegistrationStep);
  return samples;
}

// Normal equations of the samples by a motion (dt, w) of the camera: point <- point + dt + w x point is undone.
struct Fit {
  Matrix6 hessian = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  int samples = 0;
};

Fit Evaluate(const std::vector<Sample>& samples, const FrameData& view, const Rigid3& view_from_frame, double weight) {
  Fit fit;
  const PinholeCamera& camera = view.camera();
  const DepthGrid& grid = view.depth_grid();
  const Eigen::Matrix3d rotation = view_from_frame.RotationMatrix();
  for (const Sample& sample : samples) {
    const Eigen::Vector3d point = rotation * sample.point + view_from_frame.translation;
    if (!(point.z() > static_cast<double>(kNearest_m))) {
      continue;
    }
    const Eigen::Vector2d place = camera.Project(point) / kDepthGridStep;
    if (!(place.x() >= 0 && place.y() >= 0 && place.x() < grid.columns() && place.y() < grid.rows())) {
      continue;
    }
    const auto plane = PlaneAt(camera, grid, static_cast<int>(place.x()), static_cast<int>(place.y()));
    if (!plane) {
      continue;
    }
    const double off_m = plane->normal.dot(point - plane->point);
    if (std::abs(off_m) > depth_ratio::kPlane * point.z()) {
      continue;
    }
    const double deviations = std::abs(off_m) / sample.sigma_m;
    const double information = weight * std::min(1.0, kHuber / deviations) / (sample.sigma_m * sample.sigma_m);
    const Eigen::Vector3d normal = rotation.transpose() * plane->normal;
    Vector6 jacobian;
    jacobian << -normal, -sample.point.cross(normal);
    fit.hessian.noalias() += information * jacobian * jacobian.transpose();
    fit.gradient += information * off_m * jacobian;
    ++fit.samples;
  }
  return fit;
}

}  // namespace

PosePrior RegisterDepth(const FrameData& frame, std::span<const std::uint8_t> usable, const FrameData& view,
                        const Rigid3& view_from_world, const PosePrior& prior,
                        const DepthRegistrationOptions& options) {
  const std::vector<Sample> samples = CollectSamples(frame, usable);
  PosePrior result = prior;
  for (int iteration = 0;; ++iteration) {
    const Fit fit = Evaluate(samples, view, view_from_world * result.camera_from_world.Inverse(), options.weight);
    if (fit.samples < kLeastSamples) {
      return prior;
    }
    if (iteration == kIterations) {
      result.information += fit.hessian;
      return result;
    }
    const Vector6 gradient = fit.gradient + prior.information * PriorResidual(prior, result.camera_from_world);
    const Vector6 step = (fit.hessian + prior.information).ldlt().solve(-gradient);
    if (!step.allFinite()) {
      return prior;
    }
    result.camera_from_world = Retract(step, result.camera_from_world);
  }
}

}  // namespace rds
