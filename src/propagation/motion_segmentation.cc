// SPDX-License-Identifier: Apache-2.0
#include "propagation/motion_segmentation.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "feature/matching.h"
#include "propagation/motion_comparison.h"
#include "propagation/motion_hypotheses.h"
#include "propagation/surface_labels.h"
#include "segmentation/mask.h"

namespace rds {
namespace {

constexpr int kLeastMatches = 60;
constexpr double kClearly = 1.25;        // times what follows a rival must follow the motion of most
constexpr double kNothing = 0.02;        // shares of the picture below this
constexpr double kContradiction = 0.15;  // of the picture, by which more must follow it than the expected one
constexpr int kThere = 60;               // Hamming distance up to which a keypoint may be the one looked for ...
constexpr double kThere_px = 6;          // ... within this of the place where it should be, at level 0
constexpr double kNeighborhood = 0.08;   // of the width of the image
constexpr float kSameThing = 0.15F;      // difference in depth within it, as a ratio
constexpr int kLeastAlike = 6;           // neighbors that contradict alike
constexpr double kAlikeShift_px = 4;     // difference of their shifts ...
constexpr double kAlikeShift = 0.25;     // ... or this share of them

// Of several motions that which most of the picture follows; nothing where two have about the same share of it.
std::optional<Rigid3> MotionOfMost(std::span<const Rigid3> candidates, const FrameData& frame,
                                   std::span<const KeypointLabel> known, const FrameData& witness,
                                   const ScalePyramid& pyramid) {
  Rigid3 best = candidates.front();
  bool clear = true;
  for (const Rigid3& rival : candidates.subspan(1)) {
    const MotionShares shares = CompareMotions(frame, known, witness, rival, best, pyramid);
    const auto [less, more] = std::minmax(shares.one, shares.other);
    clear = clear && (more < kNothing || more >= kClearly * less);
    best = shares.one > shares.other ? rival : best;
  }
  return clear ? std::optional(best) : std::nullopt;
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
  window.depth_m = static_cast<float>(moved.z());
  window.radius_px = static_cast<float>(kThere_px * pair.sigma_px);
  return FindBest(witness, window, frame.descriptors()[pair.here]).distance < kThere;
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

// Whether what follows a motion without a rival has more of the picture than what does not.
bool IsOfMost(std::span<const Pair> pairs, std::span<const Verdict> verdicts, const FrameData& frame) {
  std::vector<KeypointLabel> labels(frame.size(), KeypointLabel::kNone);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    labels[pairs[i].here] =
        verdicts[i].label == KeypointLabel::kStatic ? KeypointLabel::kStatic : KeypointLabel::kDynamic;
  }
  const MotionShares shares = ShareSurfaces(frame, labels);
  return shares.one >= shares.other;
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
  const std::vector<Rigid3> candidates = FindMotions(pairs, witness, pyramid);
  if (candidates.empty()) {
    return std::nullopt;
  }
  const auto best = MotionOfMost(candidates, frame, known, witness, pyramid);
  if (!best) {
    return std::nullopt;
  }
  MotionSegmentation result;
  std::vector<Rigid3> motions = {*best};
  if (expected) {
    const MotionShares shares = CompareMotions(frame, known, witness, *best, *expected, pyramid);
    result.contradicts = shares.one - shares.other > kContradiction;
    if (!result.contradicts) {
      motions.push_back(*expected);  // of all that is known, and so the better one
    }
  }
  const std::vector<Verdict> verdicts = Judge(pairs, frame, witness, motions);
  if (candidates.size() == 1 && !IsOfMost(pairs, verdicts, frame)) {
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
  constexpr int kReach_px = 100;
  const std::vector<SurfaceLabel> spread = SpreadLabels(data, labels, kReach_px);
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
