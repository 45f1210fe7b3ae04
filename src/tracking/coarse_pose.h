// SPDX-License-Identifier: Apache-2.0
// Ways to a first pose of a frame. Each gives nothing where too few matches are found or agree.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "place/projection_search.h"
#include "tracking/pose_estimate.h"

namespace rds {

// Where the camera is expected before anything is matched; the prior says what that is worth.
struct ExpectedPose {
  Rigid3 camera_from_world;
  std::optional<PosePrior> prior;
};

// From the points of the last frame, searched around where they are expected (constant velocity).
[[nodiscard]] std::optional<PoseEstimate> TrackLastFrame(const FrameContext& frame, const FrameData& last,
                                                         std::span<const LastObservation> observations,
                                                         const ExpectedPose& expected);

// From the points of a keyframe, matched by appearance, beginning at the last pose.
[[nodiscard]] std::optional<PoseEstimate> TrackKeyframe(const FrameContext& frame, const LocalKeyframe& keyframe,
                                                        const Rigid3& last_camera_from_world);

// From the keyframes nearest to the last known pose, matched by appearance, without a motion model: recovers lost
// tracking.
[[nodiscard]] std::optional<PoseEstimate> RecoverPose(const FrameContext& frame, const Rigid3& last_camera_from_world);

}  // namespace rds
