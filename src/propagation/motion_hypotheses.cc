// SPDX-License-Identifier: Apache-2.0
#include "propagation/motion_hypotheses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "base/random.h"
#include "feature/keypoint_observation.h"
#include "feature/matching.h"
#include "geometry/alignment.h"
#include "optim/pose_optimizer.h"

namespace rds {
namespace {

constexpr double kMatchRatio = 0.85;  // of the best descriptor distance to the second
constexpr int kCellsAcross = 16;      // of the image
constexpr int kMotionTrials = 300;
constexpr MisfitBounds kCoarse{3, 5};  // an alignment of three noisy depths is coarse
constexpr std::size_t kMostMotions = 3;
constexpr int kLeastFollowing = 8;  // pairs that a second motion needs

// Draws pairs so that each cell of the image has the same chance.
class FairDraw {
 public:
  explicit FairDraw(std::span<const Pair> pairs) {
    std::map<int, std::vector<std::uint32_t>> cells;
    for (std::uint32_t i = 0; i < pairs.size(); ++i) {
      cells[pairs[i].cell].push_back(i);
    }
    for (auto& [cell, members] : cells) {
      cells_.push_back(std::move(members));
    }
  }
  [[nodiscard]] std::uint32_t operator()(Random& random) const {
    const auto& members = cells_[random.Index(static_cast<std::uint32_t>(cells_.size()))];
    return members[random.Index(static_cast<std::uint32_t>(members.size()))];
  }

 private:
  std::vector<std::vector<std::uint32_t>> cells_;
};

std::vector<const Pair*> Following(std::span<const Pair> pairs, const FrameData& witness, const Rigid3& motion,
                                   const MisfitBounds& bounds) {
  const Eigen::Matrix3d rotation = motion.RotationMatrix();
  std::vector<const Pair*> following;
  for (const Pair& pair : pairs) {
    if (Measure(pair, witness, rotation, motion.translation).Within(bounds)) {
      following.push_back(&pair);
    }
  }
  return following;
}

double Area(const std::vector<const Pair*>& pairs) {
  double area = 0;
  for (const Pair* pair : pairs) {
    area += pair->area;
  }
  return area;
}

// The motion that most of the area follows.
std::optional<Rigid3> MotionOfMost(std::span<const Pair> pairs, const FrameData& witness, const ScalePyramid& pyramid) {
  const FairDraw draw(pairs);
  Random random(1);
  std::optional<Rigid3> best;
  double most = 0;
  for (int trial = 0; trial < kMotionTrials; ++trial) {
    const std::array<std::uint32_t, 3> pick = {draw(random), draw(random), draw(random)};
    if (pick[0] == pick[1] || pick[1] == pick[2] || pick[0] == pick[2]) {
      continue;
    }
    std::array<Eigen::Vector3d, 3> from;
    std::array<Eigen::Vector3d, 3> to;
    for (std::size_t i = 0; i < 3; ++i) {
      from[i] = pairs[pick[i]].point;
      to[i] = pairs[pick[i]].seen;
    }
    const Rigid3 motion = Align(from, to, false).target_from_source;
    const double area = Area(Following(pairs, witness, motion, kCoarse));
    if (area > most) {
      most = area;
      best = motion;
    }
  }
  for (const double bound : {3.0, 2.0, 1.5}) {
    if (!best) {
      break;
    }
    std::vector<PoseObservation> observations;
    for (const Pair* pair : Following(pairs, witness, *best, MisfitBounds{bound, 2 * bound})) {
      observations.push_back(
          {pair->point, ObservationOf(witness.keypoints()[pair->there], pyramid, std::sqrt(pair->area))});
    }
    const PoseResult result = OptimizePose(witness.camera(), *best, observations);
    if (!result.converged) {
      return std::nullopt;
    }
    best = result.camera_from_world;
  }
  return best;
}

}  // namespace

Misfit Measure(const Pair& pair, const FrameData& witness, const Eigen::Matrix3d& rotation,
               const Eigen::Vector3d& translation) {
  constexpr double kNowhere = 1e6;
  const Eigen::Vector3d moved = rotation * pair.point + translation;
  if (moved.z() <= 0) {
    return {kNowhere, kNowhere, Eigen::Vector2d::Constant(kNowhere)};
  }
  Misfit misfit;
  misfit.shift_px = witness.keypoints()[pair.there].Pixel() - witness.camera().Project(moved);
  misfit.image = misfit.shift_px.norm() / pair.sigma_px;
  misfit.depth = std::abs(moved.z() - pair.seen.z()) / pair.sigma_m;
  return misfit;
}

std::vector<Pair> FindPairs(const FrameData& frame, std::span<const KeypointLabel> known, const FrameData& witness,
                            const ScalePyramid& pyramid) {
  std::vector<std::uint32_t> chosen;
  for (std::uint32_t i = 0; i < frame.size(); ++i) {
    if (frame.keypoints()[i].HasDepth() && (known.empty() || known[i] != KeypointLabel::kDynamic)) {
      chosen.push_back(i);
    }
  }
  const double cell_px = static_cast<double>(frame.camera().width) / kCellsAcross;
  std::vector<Pair> pairs;
  std::map<int, int> in_cell;
  for (const Match& match : MatchDescriptors(frame, chosen, witness, kMatchRatio)) {
    const Keypoint& here = frame.keypoints()[chosen[match.query]];
    const Keypoint& there = witness.keypoints()[match.keypoint];
    if (!there.HasDepth()) {
      continue;
    }
    Pair pair;
    pair.here = chosen[match.query];
    pair.there = match.keypoint;
    pair.point = here.PointIn(frame.camera());
    pair.seen = there.PointIn(witness.camera());
    pair.sigma_px = static_cast<double>(std::max(pyramid.scale[here.octave], pyramid.scale[there.octave]));
    pair.sigma_m = std::hypot(here.depth_sigma_m, there.depth_sigma_m);
    pair.cell = static_cast<int>(here.y / cell_px) * 2 * kCellsAcross + static_cast<int>(here.x / cell_px);
    ++in_cell[pair.cell];
    pairs.push_back(pair);
  }
  for (Pair& pair : pairs) {
    pair.area = 1.0 / in_cell[pair.cell];
  }
  return pairs;
}

std::vector<Rigid3> FindMotions(std::vector<Pair> pairs, const FrameData& witness, const ScalePyramid& pyramid) {
  std::vector<Rigid3> motions;
  while (std::ssize(pairs) >= kLeastFollowing && motions.size() < kMostMotions) {
    const auto motion = MotionOfMost(pairs, witness, pyramid);
    if (!motion) {
      break;
    }
    const Eigen::Matrix3d rotation = motion->RotationMatrix();
    const auto followers = std::erase_if(pairs, [&](const Pair& pair) {
      return Measure(pair, witness, rotation, motion->translation).Within(kFollows);
    });
    if (std::ssize(motions) > 0 && static_cast<int>(followers) < kLeastFollowing) {
      break;
    }
    motions.push_back(*motion);
  }
  return motions;
}

}  // namespace rds
