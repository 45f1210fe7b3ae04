// SPDX-License-Identifier: Apache-2.0
// Matching map points to a frame by projecting them into it.
#pragma once

#include <span>
#include <vector>

#include "geometry/rigid3.h"
#include "map/local_map.h"
#include "map/point_match.h"

namespace rds {

// A point of the local map with the keypoint of the last frame that showed it.
struct LastObservation {
  std::uint32_t keypoint = 0;  // of the last frame
  std::uint32_t point = 0;     // index into LocalMap
};

// Those of a frame's points (one a keypoint, invalid where there is none) that a snapshot holds, fusions followed;
// ascending by keypoint.
[[nodiscard]] std::vector<LastObservation> FindObservations(std::span<const PointId> points, const LocalMap& map);

// Searches the last frame's points around their projections at a predicted pose: octave of the last observation and its
// neighbors, rotation checked, each keypoint taken once. `window_px` is scaled with the octave.
[[nodiscard]] std::vector<PointMatch> SearchLastFrame(const FrameData& last,
                                                      std::span<const LastObservation> observations,
                                                      const FrameData& current, const Rigid3& camera_from_world,
                                                      const LocalMap& map, const ScalePyramid& pyramid,
                                                      double window_px);

// Outcome of SearchLocalMap.
struct LocalSearch {
  std::vector<PointMatch> matches;
  std::vector<std::uint32_t> visible;  // points of the local map in view, matched ones and taken ones included
};

// Searches all points of the local map in the frame's view that `taken` (one flag a point) does not mark, in keypoints
// that `occupied` (one flag a keypoint) does not mark. A point is in view if it projects into the image within its
// range of distances and seen from less than 60 degrees off its normal.
[[nodiscard]] LocalSearch SearchLocalMap(const FrameData& current, const Rigid3& camera_from_world, const LocalMap& map,
                                         const ScalePyramid& pyramid, std::span<const std::uint8_t> taken,
                                         std::span<const std::uint8_t> occupied, double window_px, double ratio);

}  // namespace rds
