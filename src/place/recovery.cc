// SPDX-License-Identifier: Apache-2.0
#include "place/recovery.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <iterator>
#include <opencv2/calib3d.hpp>
#include <utility>

#include "base/random.h"
#include "feature/matching.h"
#include "geometry/alignment.h"
#include "optim/pose_optimizer.h"

namespace rds {
namespace {

constexpr int kTrials = 200;

int CountAgreeing(const FrameData& current, std::span<const PointMatch> matches, const LocalMap& map,
                  const ScalePyramid& pyramid, const Rigid3& camera_from_world) {
  const PinholeCamera& camera = current.camera();
  const Eigen::Matrix3d rotation = camera_from_world.RotationMatrix();
  int count = 0;
  for (const PointMatch& match : matches) {
    const Keypoint& keypoint = current.keypoints()[match.keypoint];
    const Eigen::Vector3d point = rotation * map.Position(match.point) + camera_from_world.translation;
    if (point.z() <= 0) {
      continue;
    }
    // Twice the standard deviation: an alignment of three noisy depths is coarse.
    const double bound = 4.0 * kChi2Mono / pyramid.inverse_sigma2[keypoint.octave];
    count += (camera.Project(point) - keypoint.Pixel()).squaredNorm() < bound ? 1 : 0;
  }
  return count;
}

using Triple = std::array<Eigen::Vector3d, 3>;

// Whether three points fix a pose: not where they coincide, lie on a line or are no numbers.
bool IsTriangle(const Triple& points) {
  constexpr double kLeastSine = 0.02;
  const Eigen::Vector3d a = points[1] - points[0];
  const Eigen::Vector3d b = points[2] - points[0];
  return a.cross(b).norm() > kLeastSine * a.norm() * b.norm();
}

// Poses, up to four, from which three points are seen in three directions (z = 1).
std::vector<Rigid3> PosesOfDirections(const Triple& in_world, const Triple& directions) {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (std::size_t i = 0; i < 3; ++i) {
    points.emplace_back(in_world[i].x(), in_world[i].y(), in_world[i].z());
    pixels.emplace_back(directions[i].x(), directions[i].y());
  }
  std::vector<cv::Mat> rotations;
  std::vector<cv::Mat> translations;
  cv::solveP3P(points, pixels, cv::Matx33d::eye(), {}, rotations, translations, cv::SOLVEPNP_AP3P);
  std::vector<Rigid3> poses;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const Eigen::Map<const Eigen::Vector3d> rotation(rotations[i].ptr<double>());
    const Eigen::Map<const Eigen::Vector3d> translation(translations[i].ptr<double>());
    if (rotation.allFinite() && translation.allFinite()) {
      poses.emplace_back(ExpSo3(rotation), translation);
    }
  }
  return poses;
}

}  // namespace

std::vector<PointMatch> MatchKeyframe(const LocalKeyframe& keyframe, const FrameData& current, double ratio) {
  std::vector<std::uint32_t> chosen;
  chosen.reserve(keyframe.links.size());
  for (const LocalKeyframe::Link& link : keyframe.links) {
    chosen.push_back(link.keypoint);
  }
  std::vector<PointMatch> result;
  for (const Match& match : MatchDescriptors(*keyframe.data, chosen, current, ratio)) {
    result.push_back({match.keypoint, keyframe.links[match.query].point, PointState::kUnknown, 1.0});
  }
  return result;
}

std::optional<Rigid3> RansacPose(const FrameData& current, std::span<const PointMatch> matches, const LocalMap& map,
                                 const ScalePyramid& pyramid, int min_inliers) {
  const auto has_depth = [&](const PointMatch& match) { return current.keypoints()[match.keypoint].HasDepth(); };
  const bool by_depth = 2 * std::ranges::count_if(matches, has_depth) >= std::ssize(matches);
  std::vector<Eigen::Vector3d> in_camera;  // or its direction
  std::vector<Eigen::Vector3d> in_world;
  for (const PointMatch& match : matches) {
    const Keypoint& keypoint = current.keypoints()[match.keypoint];
    if (!by_depth || keypoint.HasDepth()) {
      in_camera.push_back(by_depth ? keypoint.PointIn(current.camera())
                                   : current.camera().Unproject(keypoint.Pixel(), 1));
      in_world.push_back(map.Position(match.point));
    }
  }
  if (in_camera.size() < 3) {
    return std::nullopt;
  }
  Random random(1);
  const auto n = static_cast<std::uint32_t>(in_camera.size());
  std::optional<Rigid3> best;
  int most = min_inliers - 1;
  for (int trial = 0; trial < kTrials; ++trial) {
    const std::array<std::uint32_t, 3> pick = {random.Index(n), random.Index(n), random.Index(n)};
    if (pick[0] == pick[1] || pick[1] == pick[2] || pick[0] == pick[2]) {
      continue;
    }
    const Triple from = {in_world[pick[0]], in_world[pick[1]], in_world[pick[2]]};
    const Triple to = {in_camera[pick[0]], in_camera[pick[1]], in_camera[pick[2]]};
    if (!IsTriangle(from) || !IsTriangle(to)) {
      continue;
    }
    const std::vector<Rigid3> poses =
        by_depth ? std::vector{Align(from, to, false).target_from_source} : PosesOfDirections(from, to);
    for (const Rigid3& pose : poses) {
      if (const int agreeing = CountAgreeing(current, matches, map, pyramid, pose); agreeing > most) {
        most = agreeing;
        best = pose;
      }
    }
  }
  return best;
}

std::vector<const LocalKeyframe*> NearestKeyframes(const LocalMap& map, const Eigen::Vector3d& center, int most) {
  std::vector<std::pair<double, const LocalKeyframe*>> nearest;
  for (const LocalKeyframe& keyframe : map.keyframes) {
    nearest.emplace_back((keyframe.camera_from_world.Inverse().translation - center).norm(), &keyframe);
  }
  const auto count = std::min<std::ptrdiff_t>(std::ssize(nearest), most);
  std::ranges::partial_sort(nearest, nearest.begin() + count, {},
                            [](const auto& item) { return std::pair(item.first, item.second->id); });
  std::vector<const LocalKeyframe*> keyframes;
  std::transform(nearest.begin(), nearest.begin() + count, std::back_inserter(keyframes),
                 [](const auto& item) { return item.second; });
  return keyframes;
}

}  // namespace rds
