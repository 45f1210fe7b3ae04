// SPDX-License-Identifier: Apache-2.0
// Finding the camera again from a keyframe, without a motion model.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "map/local_map.h"
#include "map/point_match.h"

namespace rds {

// Matches the keyframe's points to the frame by descriptor alone.
[[nodiscard]] std::vector<PointMatch> MatchKeyframe(const LocalKeyframe& keyframe, const FrameData& current,
                                                    double ratio);

// Pose that most matches agree with, from triples of keypoints: RANSAC over 3-D to 3-D alignments of those with depth,
// or, where under half of the matches have any, over the poses that three directions leave (P3P). A match agrees if it
// reprojects within the chi2 bound. Nothing if fewer than `min_inliers` agree. Seeded, so the same input gives the same
// pose.
[[nodiscard]] std::optional<Rigid3> RansacPose(const FrameData& current, std::span<const PointMatch> matches,
                                               const LocalMap& map, const ScalePyramid& pyramid, int min_inliers);

// The keyframes of a map whose camera centers are nearest to a place, nearest first, `most` of them at most.
[[nodiscard]] std::vector<const LocalKeyframe*> NearestKeyframes(const LocalMap& map, const Eigen::Vector3d& center,
                                                                 int most);

}  // namespace rds
