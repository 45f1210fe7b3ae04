// SPDX-License-Identifier: Apache-2.0
#include "mapping/triangulation.h"

#include <algorithm>
#include <cmath>

#include "feature/keypoint_observation.h"
#include "optim/reprojection.h"

namespace rds {
namespace {

// 1.15 degrees: with less, half a pixel of error (at 525 px of focal length) changes the distance by more than 5 %.
constexpr double kMaxParallaxCosine = 0.9998;

// Unit ray of a keypoint in the world frame.
Eigen::Vector3d RayOf(const PinholeCamera& camera, const PointView& view) {
  return (view.camera_from_world.rotation.conjugate() * camera.Unproject(view.keypoint->Pixel(), 1.0)).normalized();
}

// Standard deviation of the depth as a share of it; infinite without depth.
double DepthShare(const Keypoint& keypoint) {
  return keypoint.HasDepth() ? static_cast<double>(keypoint.depth_sigma_m / keypoint.depth_m)
                             : std::numeric_limits<double>::infinity();
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
  const PixelObservation keypoint = ObservationOf(*view.keypoint, pyramid, 1);
  return IsInlier(keypoint, ReprojectionChi2(camera, keypoint, in_camera));
}

}  // namespace

std::optional<Eigen::Vector3d> TriangulatePoint(const PinholeCamera& camera, const ScalePyramid& pyramid,
                                                const PointView& a, const PointView& b) {
  const Eigen::Vector3d center_a = a.camera_from_world.Inverse().translation;
  const Eigen::Vector3d center_b = b.camera_from_world.Inverse().translation;
  const Eigen::Vector3d ray_a = RayOf(camera, a);
  const Eigen::Vector3d ray_b = RayOf(camera, b);
  const double cosine = ray_a.dot(ray_b);
  const double share_a = DepthShare(*a.keypoint);
  const double share_b = DepthShare(*b.keypoint);
  // A pixel to each side turns the parallax, and with it the distance, by so large a share.
  const double parallax_share = std::hypot(pyramid.scale[a.keypoint->octave], pyramid.scale[b.keypoint->octave]) /
                                camera.fx / std::sqrt(1.0 - cosine * cosine);
  Eigen::Vector3d point;
  if (cosine > 0 && cosine < kMaxParallaxCosine && parallax_share < std::min(share_a, share_b)) {
    point = Midpoint(center_a, ray_a, center_b, ray_b);
  } else if (a.keypoint->HasDepth() && share_a <= share_b) {
    point = FromDepth(camera, a);
  } else if (b.keypoint->HasDepth()) {
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
