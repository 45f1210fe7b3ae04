// SPDX-License-Identifier: Apache-2.0
// Local mapping's searches: new points with neighboring keyframes, and duplicates.
#include <algorithm>
#include <cmath>
#include <utility>

#include "feature/matching.h"
#include "mapping/local_mapper.h"
#include "mapping/triangulation.h"
#include "optim/observation.h"
#include "semantic/evidence.h"

namespace rds {
namespace {

std::vector<std::uint32_t> FreeKeypoints(const Keyframe& keyframe) {
  std::vector<std::uint32_t> indices;
  for (std::size_t i = 0; i < keyframe.points.size(); ++i) {
    // What the mask says is a person makes no point.
    const bool dynamic = keyframe.IsLabeled() && keyframe.labels[i] == KeypointLabel::kDynamic;
    if (!keyframe.points[i].valid() && !dynamic) {
      indices.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return indices;
}

// Fundamental matrix: x_b^T F x_a = 0 in undistorted pixels.
Eigen::Matrix3d Fundamental(const PinholeCamera& camera, const Rigid3& b_from_a) {
  Eigen::Matrix3d inverse_k;
  inverse_k << 1.0 / camera.fx, 0, -camera.cx / camera.fx, 0, 1.0 / camera.fy, -camera.cy / camera.fy, 0, 0, 1;
  return inverse_k.transpose() * CrossMatrix(b_from_a.translation) * b_from_a.RotationMatrix() * inverse_k;
}

// Pairs of free keypoints that agree in appearance and with the epipolar geometry. A match's query is a position in
// `free_a`.
std::vector<Match> MatchAlongEpipolarLines(const Map& map, const Keyframe& a, const std::vector<std::uint32_t>& free_a,
                                           const Keyframe& b, double ratio) {
  const FrameData& data_a = *a.data;
  const FrameData& data_b = *b.data;
  const Eigen::Matrix3d f = Fundamental(data_a.camera(), b.camera_from_world * a.camera_from_world.Inverse());
  const std::vector<std::uint32_t> free_b = FreeKeypoints(b);
  MatchSet set(data_b.size());
  std::vector<float> angles;
  for (std::size_t query = 0; query < free_a.size(); ++query) {
    const Keypoint& keypoint = data_a.keypoints()[free_a[query]];
    angles.push_back(keypoint.angle_deg);
    const Eigen::Vector3d line =
        f * Eigen::Vector3d(static_cast<double>(keypoint.x), static_cast<double>(keypoint.y), 1.0);
    const double norm2 = line.head<2>().squaredNorm();
    int best = kStrictDistance + 1;
    int second = 257;
    std::uint32_t chosen = 0;
    for (const std::uint32_t candidate : free_b) {
      const int distance = HammingDistance(data_a.descriptors()[free_a[query]], data_b.descriptors()[candidate]);
      if (distance >= second) {
        continue;
      }
      const Keypoint& other = data_b.keypoints()[candidate];
      const double off = line.dot(Eigen::Vector3d(static_cast<double>(other.x), static_cast<double>(other.y), 1.0));
      if (off * off * map.pyramid().inverse_sigma2[other.octave] > 3.84 * norm2) {
        continue;
      }
      if (distance < best) {
        second = best;
        best = distance;
        chosen = candidate;
      } else {
        second = distance;
      }
    }
    if (best <= kStrictDistance && best <= ratio * second) {
      set.Add({static_cast<std::uint32_t>(query), chosen, best});
    }
  }
  std::vector<Match> matches = set.Take();
  KeepConsistentRotation(data_b, angles, &matches);
  return matches;
}

// A point to be fused into a keyframe and the keypoint that shows it.
struct Fusion {
  PointId point;
  std::uint32_t keypoint = 0;
};

// Keypoints of a keyframe that show points it does not see yet.
std::vector<Fusion> FindFusions(const Map& map, const Keyframe& keyframe, const std::vector<PointId>& points,
                                double window_px) {
  const FrameData& data = *keyframe.data;
  const PinholeCamera& camera = data.camera();
  const Eigen::Matrix3d rotation = keyframe.camera_from_world.RotationMatrix();
  const Eigen::Vector3d center = keyframe.CameraCenter();
  std::vector<Fusion> fusions;
  for (const PointId id : points) {
    const MapPoint& point = map.At(id);
    const Eigen::Vector3d in_camera = rotation * point.position + keyframe.camera_from_world.translation;
    if (in_camera.z() <= 0) {
      continue;
    }
    const Eigen::Vector2d pixel = camera.Project(in_camera);
    const Eigen::Vector3d ray = point.position - center;
    const double distance = ray.norm();
    if (!data.IsInImage(static_cast<float>(pixel.x()), static_cast<float>(pixel.y())) ||
        distance < 0.8 * static_cast<double>(point.min_distance_m) ||
        distance > 1.2 * static_cast<double>(point.max_distance_m) || ray.dot(point.normal) < 0.5 * distance) {
      continue;
    }
    const int level = map.pyramid().PredictLevel(point.max_distance_m, static_cast<float>(distance));
    const float radius = static_cast<float>(window_px) * map.pyramid().scale[static_cast<std::size_t>(level)];
    const double right_x = pixel.x() - camera.Bf() / in_camera.z();
    int best = kStrictDistance + 1;
    std::uint32_t chosen = 0;
    data.ForEachInWindow(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()), radius, level - 1, level,
                         [&](const FrameData::GridItem& item) {
                           const bool has_depth = data.keypoints()[item.index].HasDepth();
                           const double dx = pixel.x() - static_cast<double>(item.x);
                           const double dy = pixel.y() - static_cast<double>(item.y);
                           const double dr = has_depth ? right_x - static_cast<double>(item.right_x) : 0.0;
                           const double bound = has_depth ? kChi2Depth : kChi2Mono;
                           if ((dx * dx + dy * dy + dr * dr) * map.pyramid().inverse_sigma2[item.octave] > bound) {
                             return;
                           }
                           const int hamming = HammingDistance(point.descriptor, data.descriptors()[item.index]);
                           if (hamming < best) {
                             best = hamming;
                             chosen = item.index;
                           }
                         });
    if (best <= kStrictDistance) {
      fusions.push_back({id, chosen});
    }
  }
  return fusions;
}

bool Sees(const MapPoint& point, KeyframeId keyframe) {
  return std::ranges::binary_search(point.observations, keyframe, {}, &Observation::keyframe);
}

}  // namespace

void LocalMapper::Triangulate(Map& map, KeyframeId id) {
  for (const KeyframeId neighbor_id : map.BestCovisible(id, static_cast<std::size_t>(options_.triangulate_neighbors))) {
    const Keyframe& keyframe = map.At(id);
    const Keyframe& neighbor = map.At(neighbor_id);
    const PinholeCamera& camera = keyframe.data->camera();
    if ((keyframe.CameraCenter() - neighbor.CameraCenter()).norm() < camera.baseline_m) {
      continue;
    }
    const std::vector<std::uint32_t> free_keypoints = FreeKeypoints(keyframe);
    for (const Match& match :
         MatchAlongEpipolarLines(map, keyframe, free_keypoints, neighbor, options_.triangulate_ratio)) {
      const std::uint32_t own = free_keypoints[match.query];
      const auto position =
          TriangulatePoint(camera, map.pyramid(), {&keyframe.data->keypoints()[own], keyframe.camera_from_world},
                           {&neighbor.data->keypoints()[match.keypoint], neighbor.camera_from_world});
      if (position) {
        const PointId point = AddPoint(map, *position, id, own, probabilities_, probability_options_).id;
        AddObservation(map, point, neighbor_id, match.keypoint, probabilities_, probability_options_);
        map.At(point).reference = std::min(id, neighbor_id);
        map.UpdateAppearance(point);
        recent_points_.push_back(point);
      }
    }
  }
}

void LocalMapper::Fuse(Map& map, KeyframeId id) {
  std::vector<KeyframeId> targets = map.BestCovisible(id, static_cast<std::size_t>(options_.fuse_neighbors));
  const std::size_t direct = targets.size();
  for (std::size_t i = 0; i < direct; ++i) {
    for (const KeyframeId second : map.BestCovisible(targets[i], 5)) {
      if (second != id && std::ranges::find(targets, second) == targets.end()) {
        targets.push_back(second);
      }
    }
  }
  const auto fuse_into = [&](KeyframeId target, std::vector<PointId> points) {
    std::erase_if(points, [&](PointId p) { return !p.valid() || Sees(map.At(p), target); });
    for (const Fusion& fusion : FindFusions(map, map.At(target), points, 3.0)) {
      const PointId point = map.Resolve(fusion.point);
      const PointId there = map.At(target).points[fusion.keypoint];
      if (!point.valid() || point == there) {
        continue;
      }
      if (!there.valid()) {
        AddObservation(map, point, target, fusion.keypoint, probabilities_, probability_options_);
      } else if (map.At(there).observations.size() >= map.At(point).observations.size()) {
        FusePoints(map, point, there, probabilities_, probability_options_);
      } else {
        FusePoints(map, there, point, probabilities_, probability_options_);
      }
    }
  };
  for (const KeyframeId target : targets) {
    fuse_into(target, map.At(id).points);
  }
  std::vector<PointId> theirs;
  for (const KeyframeId target : targets) {
    const auto& points = map.At(target).points;
    theirs.insert(theirs.end(), points.begin(), points.end());
  }
  std::ranges::sort(theirs);
  const auto rest = std::ranges::unique(theirs);
  theirs.erase(rest.begin(), rest.end());
  fuse_into(id, std::move(theirs));
  for (const PointId point : map.At(id).points) {
    if (point.valid()) {
      map.UpdateAppearance(point);
    }
  }
}

}  // namespace rds
