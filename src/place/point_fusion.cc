// SPDX-License-Identifier: Apache-2.0
#include "place/point_fusion.h"

#include <algorithm>

#include "feature/keypoint_observation.h"
#include "feature/matching.h"
#include "optim/reprojection.h"

namespace rds {
namespace {

constexpr float kWindow_px = 3;  // of the level at which a point is expected

bool Sees(const MapPoint& point, KeyframeId keyframe) {
  return std::ranges::binary_search(point.observations, keyframe, {}, &Observation::keyframe);
}

}  // namespace

std::optional<FusionProblem> PlanFusion(const Map& map, KeyframeId keyframe_id, std::span<const PointId> points) {
  const Keyframe* const keyframe = map.Find(keyframe_id);
  if (keyframe == nullptr) {
    return std::nullopt;
  }
  FusionProblem problem{
      {keyframe_id, keyframe->pose_revision}, keyframe->camera_from_world, keyframe->data, {}, map.pyramid()};
  problem.points.reserve(points.size());
  for (const PointId id : points) {
    const MapPoint* const point = id.valid() ? map.Find(id) : nullptr;
    if (point != nullptr && !Sees(*point, keyframe_id)) {
      problem.points.push_back(
          {id, point->position, point->normal, point->min_distance_m, point->max_distance_m, point->descriptor});
    }
  }
  return problem;
}

std::optional<Correction> SolveFusion(const FusionProblem& problem) {
  const FrameData& data = *problem.data;
  const PinholeCamera& camera = data.camera();
  const ScalePyramid& pyramid = problem.pyramid;
  const Eigen::Matrix3d rotation = problem.camera_from_world.RotationMatrix();
  const Eigen::Vector3d center =
      -(problem.camera_from_world.rotation.conjugate() * problem.camera_from_world.translation);
  Correction correction;
  for (const FusionProblem::Point& point : problem.points) {
    const Eigen::Vector3d in_camera = rotation * point.position + problem.camera_from_world.translation;
    if (in_camera.z() <= 0) {
      continue;
    }
    const Eigen::Vector2d pixel = camera.Project(in_camera);
    const Eigen::Vector3d ray = point.position - center;
    const double distance = ray.norm();
    if (!data.IsInImage(static_cast<float>(pixel.x()), static_cast<float>(pixel.y())) ||
        distance < kNearerThanRange * static_cast<double>(point.min_distance_m) ||
        distance > kFartherThanRange * static_cast<double>(point.max_distance_m) ||
        ray.dot(point.normal) < kMinViewCosine * distance) {
      continue;
    }
    const int level = pyramid.PredictLevel(point.max_distance_m, static_cast<float>(distance));
    const float radius = kWindow_px * pyramid.scale[static_cast<std::size_t>(level)];
    int best = kStrictDistance + 1;
    std::uint32_t chosen = 0;
    data.ForEachInWindow(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()), radius, level - 1, level,
                         [&](const FrameData::GridItem& item) {
                           const PixelObservation keypoint = ObservationOf(data.keypoints()[item.index], pyramid, 1);
                           if (!IsInlier(keypoint, ReprojectionChi2(camera, keypoint, in_camera))) {
                             return;
                           }
                           const int hamming = HammingDistance(point.descriptor, data.descriptors()[item.index]);
                           if (hamming < best) {
                             best = hamming;
                             chosen = item.index;
                           }
                         });
    if (best <= kStrictDistance) {
      correction.matches.push_back({point.id, problem.version, chosen});
    }
  }
  return correction;
}

}  // namespace rds
