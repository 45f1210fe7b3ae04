// SPDX-License-Identifier: Apache-2.0
#include "place/projection_search.h"

#include <algorithm>
#include <cmath>

#include "feature/matching.h"

namespace rds {
namespace {

// A point seen from nearly the same direction as before (3.6 degrees) is found in a narrower window. The factors are
// conventions of the ORB-SLAM family, not tuned here.
constexpr float kStraightCosine = 0.998F;
constexpr float kStraightWindow = 2.5F / 3.0F;
constexpr float kObliqueWindow = 4.0F / 3.0F;

std::vector<PointMatch> ToPointMatches(const std::vector<Match>& matches) {
  std::vector<PointMatch> result;
  result.reserve(matches.size());
  for (const Match& match : matches) {
    result.push_back({match.keypoint, match.query, PointState::kUnknown, 1.0});
  }
  return result;
}

// Points of a local map in a frame; one entry a point.
struct Projections {
  std::vector<float> u, v, inverse_depth, distance, cosine;
  std::vector<std::uint32_t> in_view;  // points, ascending
};

Projections ProjectAll(const LocalMap& map, const FrameData& frame, const Rigid3& camera_from_world) {
  const std::size_t n = map.size();
  Projections out;
  out.u.resize(n);
  out.v.resize(n);
  out.inverse_depth.resize(n);
  out.distance.resize(n);
  out.cosine.resize(n);
  out.in_view.resize(n);
  const PinholeCamera& camera = frame.camera();
  const Eigen::Matrix3f r = camera_from_world.RotationMatrix().cast<float>();
  const Eigen::Vector3f t = camera_from_world.translation.cast<float>();
  const Eigen::Vector3f c = camera_from_world.Inverse().translation.cast<float>();
  const auto fx = static_cast<float>(camera.fx);
  const auto fy = static_cast<float>(camera.fy);
  const auto cx = static_cast<float>(camera.cx);
  const auto cy = static_cast<float>(camera.cy);
  // Plain arrays that do not overlap and no branches: the compiler turns this into vector code.
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    const float x = map.x[i];
    const float y = map.y[i];
    const float z = map.z[i];
    const float camera_x = r(0, 0) * x + r(0, 1) * y + r(0, 2) * z + t.x();
    const float camera_y = r(1, 0) * x + r(1, 1) * y + r(1, 2) * z + t.y();
    const float camera_z = r(2, 0) * x + r(2, 1) * y + r(2, 2) * z + t.z();
    const float inverse = 1.0F / camera_z;
    out.inverse_depth[i] = inverse;
    out.u[i] = fx * camera_x * inverse + cx;
    out.v[i] = fy * camera_y * inverse + cy;
    const float dx = x - c.x();
    const float dy = y - c.y();
    const float dz = z - c.z();
    const float distance = std::sqrt(dx * dx + dy * dy + dz * dz);
    out.distance[i] = distance;
    out.cosine[i] = (dx * map.normal_x[i] + dy * map.normal_y[i] + dz * map.normal_z[i]) / distance;
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; ++i) {  // without branches, which would often be guessed wrong
    out.in_view[count] = static_cast<std::uint32_t>(i);
    count += static_cast<std::size_t>(
        static_cast<int>(out.inverse_depth[i] > 0) &
        static_cast<int>(out.cosine[i] >= static_cast<float>(kMinViewCosine)) &
        static_cast<int>(frame.IsInImage(out.u[i], out.v[i])) &
        static_cast<int>(out.distance[i] >= static_cast<float>(kNearerThanRange) * map.min_distance_m[i]) &
        static_cast<int>(out.distance[i] <= static_cast<float>(kFartherThanRange) * map.max_distance_m[i]));
  }
  out.in_view.resize(count);
  return out;
}

}  // namespace

std::vector<LastObservation> FindObservations(std::span<const PointId> points, const LocalMap& map) {
  std::vector<LastObservation> observations;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].valid()) {
      if (const auto point = map.IndexOf(points[i])) {
        observations.push_back({static_cast<std::uint32_t>(i), *point});
      }
    }
  }
  return observations;
}

std::vector<PointMatch> SearchLastFrame(const FrameData& last, std::span<const LastObservation> observations,
                                        const FrameData& current, const Rigid3& camera_from_world, const LocalMap& map,
                                        const ScalePyramid& pyramid, double window_px) {
  const PinholeCamera& camera = current.camera();
  const Eigen::Matrix3d rotation = camera_from_world.RotationMatrix();
  MatchSet set(current.size());
  std::vector<float> angles(map.size(), 0.0F);
  for (const LastObservation& observation : observations) {
    const Eigen::Vector3d point = rotation * map.Position(observation.point) + camera_from_world.translation;
    if (point.z() <= 0) {
      continue;
    }
    const Eigen::Vector2d pixel = camera.Project(point);
    const auto x = static_cast<float>(pixel.x());
    const auto y = static_cast<float>(pixel.y());
    if (!current.IsInImage(x, y)) {
      continue;
    }
    const Keypoint& keypoint = last.keypoints()[observation.keypoint];
    const float radius = static_cast<float>(window_px) * pyramid.scale[keypoint.octave];
    const Candidate best =
        FindBest(current, {x, y, static_cast<float>(point.z()), radius, keypoint.octave - 1, keypoint.octave + 1},
                 last.descriptors()[observation.keypoint]);
    if (best.keypoint >= 0 && best.distance <= kLooseDistance) {
      angles[observation.point] = keypoint.angle_deg;
      set.Add({observation.point, static_cast<std::uint32_t>(best.keypoint), best.distance});
    }
  }
  std::vector<Match> matches = set.Take();
  KeepConsistentRotation(current, angles, &matches);
  return ToPointMatches(matches);
}

LocalSearch SearchLocalMap(const FrameData& current, const Rigid3& camera_from_world, const LocalMap& map,
                           const ScalePyramid& pyramid, std::span<const std::uint8_t> taken,
                           std::span<const std::uint8_t> occupied, double window_px, double ratio) {
  Projections all = ProjectAll(map, current, camera_from_world);
  LocalSearch result;
  MatchSet set(current.size());
  for (const std::uint32_t i : all.in_view) {
    if (taken[i] != 0) {
      continue;
    }
    const int level = pyramid.PredictLevel(map.max_distance_m[i], all.distance[i]);
    const float radius = static_cast<float>(window_px) * pyramid.scale[static_cast<std::size_t>(level)] *
                         (all.cosine[i] > kStraightCosine ? kStraightWindow : kObliqueWindow);
    const Candidate best =
        FindBest(current, {all.u[i], all.v[i], 1 / all.inverse_depth[i], radius, level - 1, level}, map.descriptors[i]);
    if (best.keypoint >= 0 && best.distance <= kLooseDistance && best.IsDistinct(ratio) &&
        occupied[static_cast<std::size_t>(best.keypoint)] == 0) {
      set.Add({i, static_cast<std::uint32_t>(best.keypoint), best.distance});
    }
  }
  result.visible = std::move(all.in_view);
  result.matches = ToPointMatches(set.Take());
  return result;
}

}  // namespace rds
