// SPDX-License-Identifier: Apache-2.0
#include "propagation/motion_comparison.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "feature/matching.h"
#include "geometry/depth_grid.h"
#include "propagation/motion_hypotheses.h"
#include "propagation/surface_labels.h"

namespace rds {
namespace {

constexpr float kFar_m = 8;         // where things without depth are, about
constexpr float kOnSample = 0.15F;  // difference of a keypoint's depth from its sample's, as a ratio
constexpr int kFoundAgain = 60;     // Hamming distance

// Where a motion takes a keypoint.
struct Place {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // in the witness's camera; what has no depth is far
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double reach_px = 0;
};

std::optional<Place> PlaceOf(const Keypoint& here, const PinholeCamera& camera, const Eigen::Matrix3d& rotation,
                             const Eigen::Vector3d& translation, const ScalePyramid& pyramid) {
  Place expected;
  const Eigen::Vector3d point =
      here.HasDepth() ? here.PointIn(camera) : camera.Unproject(here.Pixel(), static_cast<double>(kFar_m));
  expected.point = rotation * point + translation;
  if (expected.point.z() <= 0) {
    return std::nullopt;
  }
  expected.pixel = camera.Project(expected.point);
  // It may be twice as far, or half.
  const double parallax_px = here.HasDepth() ? 0 : camera.fx * translation.norm() / static_cast<double>(kFar_m);
  expected.reach_px = kFollows.image * static_cast<double>(pyramid.scale[here.octave]) + parallax_px;
  return expected;
}

// Whether a keypoint is found again where a motion takes it: more than by appearance alone, for there it need not be
// unlike all others.
bool IsFound(const Keypoint& here, const Descriptor& descriptor, const Place& expected, const FrameData& witness) {
  SearchWindow window;
  window.x = static_cast<float>(expected.pixel.x());
  window.y = static_cast<float>(expected.pixel.y());
  window.radius_px = static_cast<float>(expected.reach_px);
  window.depth_m = here.HasDepth() ? static_cast<float>(expected.point.z()) : 0;
  const Candidate found = FindBest(witness, window, descriptor);
  if (found.distance >= kFoundAgain) {
    return false;
  }
  const Keypoint& there = witness.keypoints()[static_cast<std::size_t>(found.keypoint)];
  if (!here.HasDepth() || !there.HasDepth()) {
    return here.HasDepth() == there.HasDepth();
  }
  return std::abs(static_cast<double>(there.depth_m) - expected.point.z()) <
         kFollows.depth * std::hypot(there.depth_sigma_m, here.depth_sigma_m);
}

// Whether two motions take a keypoint to about the same place.
bool AreAlike(const Keypoint& here, const Place& a, const Place& b) {
  const bool same_depth = !here.HasDepth() || std::abs(a.point.z() - b.point.z()) <
                                                  kElsewhere.depth * static_cast<double>(here.depth_sigma_m);
  return same_depth && (a.pixel - b.pixel).norm() < a.reach_px + b.reach_px;
}

}  // namespace

MotionShares ShareSurfaces(const FrameData& frame, std::span<const KeypointLabel> keypoints) {
  if (frame.depth_grid().empty()) {
    return {};
  }
  std::vector<float> depth_m = frame.depth_grid().depth_m();
  std::ranges::replace(depth_m, 0.0F, kFar_m);
  const DepthGrid grid(frame.depth_grid().columns(), frame.depth_grid().rows(), std::move(depth_m));
  std::vector<KeypointLabel> samples(grid.size(), KeypointLabel::kNone);
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const Keypoint& here = frame.keypoints()[i];
    const auto sample = grid.IndexOfPixel(here.raw_x, here.raw_y);
    if (sample && keypoints[i] != KeypointLabel::kNone &&
        SameSurface(here.HasDepth() ? here.depth_m : kFar_m, grid[*sample], kOnSample)) {
      samples[*sample] = keypoints[i];
    }
  }
  SurfaceLabels surfaces(
      {.max_dynamic_distance_px = SurfaceLabel::kNone - 1, .max_static_distance_px = SurfaceLabel::kNone - 1});
  surfaces.Start(grid);
  surfaces.Add(std::span<const KeypointLabel>(samples));
  surfaces.Spread();
  MotionShares shares;
  for (const SurfaceLabel& label : surfaces.Labels()) {
    (label.dynamic ? shares.other : shares.one) += label.IsKnown() ? 1.0 / static_cast<double>(grid.size()) : 0;
  }
  return shares;
}

MotionShares CompareMotions(const FrameData& frame, std::span<const KeypointLabel> known, const FrameData& witness,
                            const Rigid3& one, const Rigid3& other, const ScalePyramid& pyramid) {
  std::vector<KeypointLabel> labels(frame.size(), KeypointLabel::kNone);
  const Eigen::Matrix3d rotation_one = one.RotationMatrix();
  const Eigen::Matrix3d rotation_other = other.RotationMatrix();
  const PinholeCamera& camera = frame.camera();
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const Keypoint& here = frame.keypoints()[i];
    if (!known.empty() && known[i] == KeypointLabel::kDynamic) {
      continue;
    }
    const auto a = PlaceOf(here, camera, rotation_one, one.translation, pyramid);
    const auto b = PlaceOf(here, camera, rotation_other, other.translation, pyramid);
    if (!a || !b || AreAlike(here, *a, *b)) {
      continue;
    }
    const bool follows_one = IsFound(here, frame.descriptors()[i], *a, witness);
    const bool follows_other = IsFound(here, frame.descriptors()[i], *b, witness);
    if (follows_one != follows_other) {
      labels[i] = follows_one ? KeypointLabel::kStatic : KeypointLabel::kDynamic;
    }
  }
  return ShareSurfaces(frame, labels);
}

}  // namespace rds
