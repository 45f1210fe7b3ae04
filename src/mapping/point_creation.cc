// SPDX-License-Identifier: Apache-2.0
#include "mapping/point_creation.h"

#include <algorithm>
#include <cmath>

#include "feature/matching.h"
#include "mapping/triangulation.h"

namespace rds {
namespace {

// 95 % quantile of the chi-square distribution with one degree of freedom: the distance of a keypoint from a line.
constexpr double kChi2Line = 3.84;

CreationProblem::View ViewOf(const Keyframe& keyframe) {
  CreationProblem::View view{{keyframe.id, keyframe.pose_revision}, keyframe.camera_from_world, keyframe.data, {}};
  for (std::size_t i = 0; i < keyframe.points.size(); ++i) {
    // What the mask says is a person makes no point.
    const bool dynamic = keyframe.IsLabeled() && keyframe.labels[i] == KeypointLabel::kDynamic;
    if (!keyframe.points[i].valid() && !dynamic) {
      view.free_keypoints.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return view;
}

// Fundamental matrix: x_b^T F x_a = 0 in undistorted pixels.
Eigen::Matrix3d Fundamental(const PinholeCamera& camera, const Rigid3& b_from_a) {
  Eigen::Matrix3d inverse_k;
  inverse_k << 1.0 / camera.fx, 0, -camera.cx / camera.fx, 0, 1.0 / camera.fy, -camera.cy / camera.fy, 0, 0, 1;
  return inverse_k.transpose() * CrossMatrix(b_from_a.translation) * b_from_a.RotationMatrix() * inverse_k;
}

// Pairs of free keypoints. A match's query is a position among those of the keyframe.
std::vector<Match> MatchAlongEpipolarLines(const CreationProblem& problem, double ratio) {
  const CreationProblem::View& a = problem.keyframe;
  const CreationProblem::View& b = problem.neighbor;
  const FrameData& data_a = *a.data;
  const FrameData& data_b = *b.data;
  const Eigen::Matrix3d f = Fundamental(data_a.camera(), b.camera_from_world * a.camera_from_world.Inverse());
  MatchSet set(data_b.size());
  std::vector<float> angles;
  for (std::size_t query = 0; query < a.free_keypoints.size(); ++query) {
    const Keypoint& keypoint = data_a.keypoints()[a.free_keypoints[query]];
    angles.push_back(keypoint.angle_deg);
    const Eigen::Vector3d line = f * keypoint.Pixel().homogeneous();
    const double norm2 = line.head<2>().squaredNorm();
    int best = kStrictDistance + 1;
    int second = 257;
    std::uint32_t chosen = 0;
    for (const std::uint32_t candidate : b.free_keypoints) {
      const int distance =
          HammingDistance(data_a.descriptors()[a.free_keypoints[query]], data_b.descriptors()[candidate]);
      if (distance >= second) {
        continue;
      }
      const Keypoint& other = data_b.keypoints()[candidate];
      const double off = line.dot(other.Pixel().homogeneous());
      if (off * off * problem.pyramid.inverse_sigma2[other.octave] > kChi2Line * norm2) {
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

}  // namespace

std::optional<CreationProblem> PlanCreation(const Map& map, KeyframeId keyframe_id, KeyframeId neighbor_id) {
  const Keyframe* const keyframe = map.Find(keyframe_id);
  const Keyframe* const neighbor = map.Find(neighbor_id);
  if (keyframe == nullptr || neighbor == nullptr ||
      (keyframe->CameraCenter() - neighbor->CameraCenter()).norm() < keyframe->data->camera().baseline_m) {
    return std::nullopt;
  }
  return CreationProblem{ViewOf(*keyframe), ViewOf(*neighbor), map.pyramid()};
}

std::optional<Correction> SolveCreation(const CreationProblem& problem, double ratio) {
  const CreationProblem::View& a = problem.keyframe;
  const CreationProblem::View& b = problem.neighbor;
  Correction correction;
  for (const Match& match : MatchAlongEpipolarLines(problem, ratio)) {
    const std::uint32_t own = a.free_keypoints[match.query];
    const auto position =
        TriangulatePoint(a.data->camera(), problem.pyramid, {&a.data->keypoints()[own], a.camera_from_world},
                         {&b.data->keypoints()[match.keypoint], b.camera_from_world});
    if (!position) {
      continue;
    }
    if (a.version.keyframe < b.version.keyframe) {  // the older one hosts the point
      correction.new_points.push_back({*position, a.version, own, b.version, match.keypoint});
    } else {
      correction.new_points.push_back({*position, b.version, match.keypoint, a.version, own});
    }
  }
  return correction;
}

}  // namespace rds
