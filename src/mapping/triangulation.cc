// SPDX-License-Identifier: Apache-2.0
#include "mapping/triangulation.h"

#include <algorithm>
#include <cmath>

#include "optim/observation.h"

namespace rds {
namespace {

// 1.15 degrees: with less, half a pixel of error (at 525 px of focal length) changes the distance by more than 5 %.
constexpr double kMaxParallaxCosine = 0.9998;

// Unit ray of a keypoint in the world frame.
Eigen::Vector3d RayOf(const PinholeCamera& camera, const PointView& view) {
  return (view.camera_from_world.rotation.conjugate() * camera.Unproject(view.keypoint->Pixel(), 1.0)).normalized();
}

// Cosine of the angle under which the virtual stereo pair sees the keypoint's depth; 1 without depth.
double StereoCosine(const PinholeCamera& camera, const Keypoint& keypoint) {
  return keypoint.HasDepth()
             ? std::cos(2.0 * std::atan2(0.5 * camera.baseline_m, static_cast<double>(keypoint.depth_m)))
             : 1.0;
}

Eigen::Vector3d FromDepth(const PinholeCamera& camera, const PointView& view) {
  return view.camera_from_world.Inverse() * view.keypoint->PointIn(camera);
}

// Midpoint of the shortest segment between the two rays.
Eigen::Vector3d Midpoint(const Eigen::Vector3d& center_a, const Eigen::Vector3d& ray_a, const Eigen::Vector3d& center_b,
                         const Eigen::Vector3d& ray_b) {
  const Eigen::Vector3d between = center_b - center_a;
  const double cosine = ray_a.dot(ray_b);
  const double sine2 = 1.0 - cosine * cosine;
  const double along_a = (between.dot(ray_a) - cosine * between.dot(ray_b)) / sine2;
  const double along_b = (cosine * between.dot(ray_a) - between.dot(ray_b)) / sine2;
  return 0.5 * (center_a + along_a * ray_a + center_b + along_b * ray_b);
}

bool Reprojects(const PinholeCamera& camera, const ScalePyramid& pyramid, const PointView& view,
                const Eigen::Vector3d& point) {
  const Eigen::Vector3d in_camera = view.camera_from_world * point;
  if (in_camera.z() <= 0) {
    return false;
  }
  const Keypoint& keypoint = *view.keypoint;
  const Eigen::Vector2d projected = camera.Project(in_camera);
  double error2 = (projected - keypoint.Pixel()).squaredNorm();
  if (keypoint.HasDepth()) {
    const double right = projected.x() - camera.Bf() / in_camera.z() - static_cast<double>(keypoint.right_x);
    error2 += right * right;
  }
  return error2 * pyramid.inverse_sigma2[keypoint.octave] <= Chi2Bound(keypoint.HasDepth());
}

}  // namespace

std::optional<Eigen::Vector3d> TriangulatePoint(const PinholeCamera& camera, const ScalePyramid& pyramid,
                                                const PointView& a, const PointView& b) {
  const Eigen::Vector3d center_a = a.camera_from_world.Inverse().translation;
  const Eigen::Vector3d center_b = b.camera_from_world.Inverse().translation;
  const Eigen::Vector3d ray_a = RayOf(camera, a);
  const Eigen::Vector3d ray_b = RayOf(camera, b);
  const double cosine = ray_a.dot(ray_b);
  const double stereo_a = StereoCosine(camera, *a.keypoint);
  const double stereo_b = StereoCosine(camera, *b.keypoint);
  Eigen::Vector3d point;
  if (cosine > 0 && cosine < std::min({stereo_a, stereo_b, kMaxParallaxCosine})) {
    point = Midpoint(center_a, ray_a, center_b, ray_b);
  } else if (stereo_a < 1.0 && stereo_a <= stereo_b) {
    point = FromDepth(camera, a);
  } else if (stereo_b < 1.0) {
    point = FromDepth(camera, b);
  } else {
    return std::nullopt;
  }
  if (!point.allFinite() || !Reprojects(camera, pyramid, a, point) || !Reprojects(camera, pyramid, b, point)) {
    return std::nullopt;
  }
  const double distance_ratio = (point - center_b).norm() / (point - center_a).norm();
  const double octave_ratio =
      static_cast<double>(pyramid.scale[b.keypoint->octave] / pyramid.scale[a.keypoint->octave]);
  const double factor = 1.5 * pyramid.factor;
  if (distance_ratio * factor < octave_ratio || distance_ratio > octave_ratio * factor) {
    return std::nullopt;
  }
  return point;
}

}  // namespace rds
