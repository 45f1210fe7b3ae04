// SPDX-License-Identifier: Apache-2.0
#include "tracking/coarse_pose.h"

#include <algorithm>
#include <utility>

#include "base/time.h"
#include "place/recovery.h"

namespace rds {
namespace {

// Nothing if fewer inliers than a first pose needs are left.
std::optional<PoseEstimate> IfEnoughInliers(const FrameContext& frame, PoseEstimate estimate) {
  const bool enough = std::ssize(estimate.association.used) >= frame.options.min_motion_inliers;
  return enough ? std::optional(std::move(estimate)) : std::nullopt;
}

}  // namespace

std::optional<PoseEstimate> TrackLastFrame(const FrameContext& frame, const FrameData& last,
                                           std::span<const LastObservation> observations,
                                           const ExpectedPose& expected) {
  const Stopwatch watch;
  const auto search = [&](double window_px) {
    return SearchLastFrame(last, observations, frame.data, expected.camera_from_world, frame.map, frame.setup.pyramid,
                           window_px);
  };
  const double most_px = frame.options.motion_window_px;
  std::vector<PointMatch> matches =
      search(expected.prior ? std::min(most_px, SearchRadius(*expected.prior, frame.data.camera().fx)) : most_px);
  if (std::ssize(matches) < frame.options.min_motion_matches) {
    matches = search(2 * most_px);
  }
  frame.times.matching_ms += watch.Milliseconds();
  if (std::ssize(matches) < frame.options.min_motion_matches) {
    return std::nullopt;
  }
  return IfEnoughInliers(frame, EstimatePose(frame, expected.camera_from_world, expected.prior, matches));
}

std::optional<PoseEstimate> TrackKeyframe(const FrameContext& frame, const LocalKeyframe& keyframe,
                                          const Rigid3& last_camera_from_world) {
  const Stopwatch watch;
  const std::vector<PointMatch> matches = MatchKeyframe(keyframe, frame.data, frame.options.reference_ratio);
  frame.times.matching_ms += watch.Milliseconds();
  if (std::ssize(matches) < frame.options.min_reference_matches) {
    return std::nullopt;
  }
  return IfEnoughInliers(frame, EstimatePose(frame, last_camera_from_world, std::nullopt, matches));
}

std::optional<PoseEstimate> RecoverPose(const FrameContext& frame, const Rigid3& last_camera_from_world) {
  const Stopwatch watch;
  const TrackerOptions& options = frame.options;
  std::optional<PoseEstimate> found;
  const Eigen::Vector3d last_center = last_camera_from_world.Inverse().translation;
  for (const LocalKeyframe* keyframe : NearestKeyframes(frame.map, last_center, options.recovery_keyframes)) {
    const std::vector<PointMatch> matches = MatchKeyframe(*keyframe, frame.data, options.reference_ratio);
    const Association selected = Select(frame, matches);
    if (std::ssize(selected.used) < options.min_reference_matches) {
      continue;
    }
    const auto pose = RansacPose(frame.data, selected.used, frame.map, frame.setup.pyramid, options.min_motion_inliers);
    found =
        IfEnoughInliers(frame, EstimatePose(frame, pose.value_or(keyframe->camera_from_world), std::nullopt, matches));
    if (found) {
      break;
    }
  }
  frame.times.matching_ms += watch.Milliseconds();
  return found;
}

}  // namespace rds
