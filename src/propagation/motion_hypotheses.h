// SPDX-License-Identifier: Apache-2.0
// Matches between two views and the rigid motions that they follow.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "feature/frame_data.h"
#include "geometry/rigid3.h"
#include "map/keyframe.h"

namespace rds {

// Bounds on a misfit, in standard deviations of the position in the image and of the depth. What lies between is not
// judged.
struct MisfitBounds {
  double image = 0;
  double depth = 0;
};
inline constexpr MisfitBounds kFollows{3, 4};
inline constexpr MisfitBounds kElsewhere{5, 8};

// A keypoint of the frame with its counterpart in the witness, both with depth.
struct Pair {
  std::uint32_t here = 0;
  std::uint32_t there = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // in the frame's camera
  Eigen::Vector3d seen = Eigen::Vector3d::Zero();   // in the witness's camera
  double sigma_px = 1;
  double sigma_m = 0;
  int cell = 0;     // of the image
  double area = 1;  // share of its cell: each counts once, however many matches it has
};

// How far a pair is from a motion, in standard deviations.
struct Misfit {
  double image = 0;
  double depth = 0;
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();  // from the place where the motion takes it

  [[nodiscard]] bool Within(const MisfitBounds& bounds) const { return image < bounds.image && depth < bounds.depth; }
};

// `witness_from_frame` as rotation and translation.
[[nodiscard]] Misfit Measure(const Pair& pair, const FrameData& witness, const Eigen::Matrix3d& rotation,
                             const Eigen::Vector3d& translation);

// Keypoints of a frame that are not known to be dynamic, matched to those of a witness by appearance alone.
[[nodiscard]] std::vector<Pair> FindPairs(const FrameData& frame, std::span<const KeypointLabel> known,
                                          const FrameData& witness, const ScalePyramid& pyramid);

// The motions (witness_from_frame) that most of the area follows: RANSAC over 3-D to 3-D alignments (Fischler and
// Bolles 1981; Umeyama 1991), refined, then the same with what is left, up to three. Seeded: the same input gives the
// same motions.
[[nodiscard]] std::vector<Rigid3> FindMotions(std::vector<Pair> pairs, const FrameData& witness,
                                              const ScalePyramid& pyramid);

}  // namespace rds
