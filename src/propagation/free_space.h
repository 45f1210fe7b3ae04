// SPDX-License-Identifier: Apache-2.0
// Free-space violations: what stands where earlier views looked through; and static surfaces seen again.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "base/image.h"
#include "map/map.h"
#include "propagation/propagation_options.h"

namespace rds {

inline constexpr std::size_t kFreeSpaceViews = 3;      // earlier views that are asked
inline constexpr std::uint32_t kFreeSpaceFrames = 60;  // how much earlier they may be

// A frame whose pose is known.
struct PosedFrame {
  FrameId frame;
  std::shared_ptr<const FrameData> data;
  Rigid3 camera_from_world;
};

// A frame whose pose is known, and what its mask says of each sample of its depth grid (empty: nothing).
struct DepthView {
  FrameId frame;
  std::shared_ptr<const FrameData> data;
  Rigid3 camera_from_world;
  std::vector<KeypointLabel> labels;
  // Least depth of each sample and its neighbors, 0 at the border and where one of them is unknown: at an edge the
  // nearer surface counts, so that a slightly wrong pose empties no place.
  std::vector<float> least_depth_m;
};

[[nodiscard]] DepthView MakeView(FrameId frame, std::shared_ptr<const FrameData> data, const Rigid3& camera_from_world,
                                 std::vector<KeypointLabel> labels);

// What the mask says of each sample of a frame's depth grid.
[[nodiscard]] std::vector<KeypointLabel> LabelGrid(const FrameData& data, const Image8& mask);

// Judges each sample of a frame's depth grid by earlier views:
// - dynamic where one of them looked through the place, so that it is newly occupied; this needs no network: it finds
//   people that a mask misses and what moves without being a person, but nothing that keeps still;
// - static where one of them saw the same surface at the same place and its mask calls it static;
// - none elsewhere. The word of the first view that has one counts.
// Where more of the view is newly occupied than is credible, it is the pose that is wrong, and nothing is called
// dynamic. Empty without a grid. Re-entrant.
[[nodiscard]] std::vector<KeypointLabel> CheckFreeSpace(const FrameData& frame, const Rigid3& camera_from_world,
                                                        std::span<const DepthView> views,
                                                        const FreeSpaceOptions& options);

// Earlier keyframes of its world to judge one by, spread over the time allowed.
[[nodiscard]] std::vector<PosedFrame> EarlierKeyframes(const Map& map, KeyframeId keyframe);

// Makes the labels of keypoints dynamic where the sample is.
void MarkNewlyOccupied(const FrameData& data, std::span<const KeypointLabel> judged,
                       std::vector<KeypointLabel>& labels);

}  // namespace rds
