// SPDX-License-Identifier: Apache-2.0
#include "propagation/motion_segmentation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "base/error.h"
#include "base/random.h"
#include "feature/keypoint_observation.h"
#include "feature/matching.h"
#include "geometry/alignment.h"
#include "optim/pose_optimizer.h"
#include "propagation/surface_labels.h"
#include "segmentation/mask.h"

namespace rds {
namespace {

constexpr double kMatchRatio = 0.85;  // of the best descriptor distance to the second
constexpr int kLeastMatches = 60;
constexpr int kCellsAcross = 16;  // of the image: each counts once, however many matches it has
constexpr int kMotionTrials = 300;
constexpr double kLeastShare = 0.5;  // of the matched area that must follow one motion

// Bounds on a misfit, in standard deviations of the position in the image and of the depth. What lies between is not
// judged.
constexpr double kCoarse[] = {3, 5};  // an alignment of three noisy depths is coarse
constexpr double kFollows[] = {3, 4};
constexpr double kElsewhere[] = {5, 8};
constexpr double kContradiction = 0.15;  // by which the motion of most must explain more than the expected one

constexpr int kLookAlike = 60;       // Hamming distance up to which a keypoint may be the one that was looked for ...
constexpr double kLookAlike_px = 6;  // ... within this of the place where it should be, at level 0
constexpr double kNeighborhood = 0.08;  // of the width of the image
constexpr float kSameThing = 0.15F;     // difference in depth within it, as a ratio
constexpr int kLeastAlike = 6;          // neighbors that contradict alike
constexpr double kAlikeShift_px = 4;    // difference of their shifts ...
constexpr double kAlikeShift = 0.25;    // ... or this share of them

// A keypoint of the frame with its counterpart in the witness, both with depth.
struct Pair {
  std::uint32_t here = 0;
  std::uint32_t there = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // in the frame's camera
  Eigen::Vector3d seen = Eigen::Vector3d::Zero();   // in the witness's camera
  double sigma_px = 1;
  double sigma_m = 0;
  int cell = 0;
  double area = 1;
};

// How far a pair is from a motion, in standard deviations.
struct Misfit {
  double image = 0;
  double depth = 0;
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();  // from the place where the motion takes it

  [[nodiscard]] bool Within(const double (&bounds)[2]) const { return image < bounds[0] && depth < bounds[1]; }
};

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
                                   const double (&bounds)[2]) {
  const Eigen::Matrix3d rotation = motion.RotationMatrix();
  std::vector<const Pair*> following;
  for (const Pair& pair : pairs) {
    if (Measure(pair, witness, rotation, motion.translation).Within(bounds)) {
      following.push_back(&pair);
    }
  }
  return following;
}

template <typename Pairs>
double Area(const Pairs& pairs) {
  double area = 0;
  for (const Pair* pair : pairs) {
    area += pair->area;
  }
  return area;
}

// How well a motion explains the pairs: 1 where each fits exactly, 0 where none is near.
double Score(std::span<const Pair> pairs, const FrameData& witness, const Rigid3& motion) {
  const Eigen::Matrix3d rotation = motion.RotationMatrix();
  double score = 0;
  double area = 0;
  for (const Pair& pair : pairs) {
    const Misfit misfit = Measure(pair, witness, rotation, motion.translation);
    const double squared = (misfit.image * misfit.image + misfit.depth * misfit.depth) / (kFollows[0] * kFollows[0]);
    score += pair.area * std::max(0.0, 1 - squared);
    area += pair.area;
  }
  return score / area;
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
    for (const Pair* pair : Following(pairs, witness, *best, {bound, 2 * bound})) {
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

// Whether the witness has a keypoint like this one where the motion takes it.
bool IsThereToo(const Pair& pair, const FrameData& frame, const FrameData& witness, const Rigid3& motion) {
  const Eigen::Vector3d moved = motion * pair.point;
  if (moved.z() <= 0) {
    return false;
  }
  const Eigen::Vector2d place = witness.camera().Project(moved);
  SearchWindow window;
  window.x = static_cast<float>(place.x());
  window.y = static_cast<float>(place.y());
  window.radius_px = static_cast<float>(kLookAlike_px * pair.sigma_px);
  return FindBest(witness, window, frame.descriptors()[pair.here]).distance < kLookAlike;
}

struct Verdict {
  KeypointLabel label = KeypointLabel::kNone;
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();  // against the motion of most
};

// Static: follows one of the motions, dynamic: is far from all. The first one is that of most.
std::vector<Verdict> Judge(std::span<const Pair> pairs, const FrameData& frame, const FrameData& witness,
                           std::span<const Rigid3> motions) {
  std::vector<Verdict> verdicts(pairs.size(), {KeypointLabel::kDynamic, Eigen::Vector2d::Zero()});
  for (std::size_t m = motions.size(); m-- > 0;) {
    const Eigen::Matrix3d rotation = motions[m].RotationMatrix();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      Verdict& verdict = verdicts[i];
      const Misfit misfit = Measure(pairs[i], witness, rotation, motions[m].translation);
      verdict.shift_px = misfit.shift_px;
      if (misfit.Within(kFollows)) {
        verdict.label = KeypointLabel::kStatic;
      } else if (verdict.label == KeypointLabel::kDynamic &&
                 (misfit.Within(kElsewhere) || IsThereToo(pairs[i], frame, witness, motions[m]))) {
        verdict.label = KeypointLabel::kNone;
      }
    }
  }
  return verdicts;
}

// Whether those beside a dynamic one on the same thing say the same.
bool IsConfirmed(std::span<const Pair> pairs, std::span<const Verdict> verdicts, std::size_t i,
                 const FrameData& frame) {
  const Keypoint& here = frame.keypoints()[pairs[i].here];
  const double reach_px = kNeighborhood * frame.camera().width;
  const double alike_px = std::max(kAlikeShift_px, kAlikeShift * verdicts[i].shift_px.norm());
  int alike = 0;
  int following = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const Keypoint& beside = frame.keypoints()[pairs[k].here];
    if (k == i || (beside.Pixel() - here.Pixel()).norm() > reach_px ||
        !SameSurface(here.depth_m, beside.depth_m, kSameThing)) {
      continue;
    }
    following += verdicts[k].label == KeypointLabel::kStatic ? 1 : 0;
    alike +=
        verdicts[k].label == KeypointLabel::kDynamic && (verdicts[k].shift_px - verdicts[i].shift_px).norm() < alike_px
            ? 1
            : 0;
  }
  return alike >= kLeastAlike && alike > following;
}

}  // namespace

std::optional<MotionSegmentation> SegmentByMotion(const FrameData& frame, std::span<const KeypointLabel> known,
                                                  const FrameData& witness, const std::optional<Rigid3>& expected,
                                                  const ScalePyramid& pyramid) {
  Check(known.empty() || known.size() == frame.size(), "a label for each keypoint");
  const std::vector<Pair> pairs = FindPairs(frame, known, witness, pyramid);
  if (std::ssize(pairs) < kLeastMatches) {
    return std::nullopt;
  }
  const auto motion = MotionOfMost(pairs, witness, pyramid);
  if (!motion) {
    return std::nullopt;
  }
  MotionSegmentation result;
  std::vector<Rigid3> motions = {*motion};
  if (expected) {
    result.contradicts = Score(pairs, witness, *motion) - Score(pairs, witness, *expected) > kContradiction;
    if (!result.contradicts) {
      motions.push_back(*expected);  // of all that is known, and so the better one
    }
  }
  const std::vector<Verdict> verdicts = Judge(pairs, frame, witness, motions);
  double area = 0;
  double following = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    area += pairs[i].area;
    following += verdicts[i].label == KeypointLabel::kStatic ? pairs[i].area : 0;
  }
  if (following < kLeastShare * area) {
    return std::nullopt;
  }
  result.labels.assign(frame.size(), KeypointLabel::kNone);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (verdicts[i].label != KeypointLabel::kDynamic || IsConfirmed(pairs, verdicts, i, frame)) {
      result.labels[pairs[i].here] = verdicts[i].label;
    }
  }
  return result;
}

void DrawSurfaces(const FrameData& data, std::span<const KeypointLabel> labels, Image8& mask) {
  Check(labels.size() == data.size(), "a label for each keypoint");
  Check(mask.width == data.camera().width && mask.height == data.camera().height && mask.channels == 1,
        "the mask has the size of the image");
  const DepthGrid& grid = data.depth_grid();
  if (grid.empty()) {
    return;
  }
  std::vector<KeypointLabel> samples(grid.size(), KeypointLabel::kNone);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const Keypoint& keypoint = data.keypoints()[i];
    const auto sample = grid.IndexOfPixel(keypoint.raw_x, keypoint.raw_y);
    if (labels[i] == KeypointLabel::kNone || !sample || samples[*sample] == KeypointLabel::kDynamic ||
        !SameSurface(keypoint.depth_m, grid[*sample], kSameThing)) {
      continue;
    }
    samples[*sample] = labels[i];
  }
  constexpr int kReach_px = 100;
  SurfaceLabels surfaces({.max_dynamic_distance_px = kReach_px, .max_static_distance_px = kReach_px});
  surfaces.Start(grid);
  surfaces.Add(std::span<const KeypointLabel>(samples));
  surfaces.Spread();
  const std::vector<SurfaceLabel> spread = surfaces.Labels();
  grid.ForEach([&](int column, int row) {
    const SurfaceLabel& label = spread[grid.Index(column, row)];
    if (!label.IsKnown()) {
      return;
    }
    for (int y = row * kDepthGridStep; y < (row + 1) * kDepthGridStep; ++y) {
      std::uint8_t* const pixels = mask.Row(y) + column * kDepthGridStep;
      if (label.dynamic) {
        std::fill_n(pixels, kDepthGridStep, kDynamicPixel);
      } else {
        std::replace(pixels, pixels + kDepthGridStep, kUnsurePixel, kStaticPixel);
      }
    }
  });
}

}  // namespace rds
