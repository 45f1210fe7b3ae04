// SPDX-License-Identifier: Apache-2.0
#include "tracking/pose_estimate.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/time.h"
#include "feature/keypoint_observation.h"
#include "optim/reprojection.h"

namespace rds {
namespace {

PoseObservation Observe(const FrameContext& frame, const PointMatch& match) {
  const Keypoint& keypoint = frame.data.keypoints()[match.keypoint];
  return {frame.map.Position(match.point), ObservationOf(keypoint, frame.setup.pyramid, match.weight)};
}

// Optimizes the pose over the matches in use and keeps the inliers there.
void Optimize(const FrameContext& frame, PoseEstimate& estimate) {
  std::vector<PointMatch>& used = estimate.association.used;
  std::vector<PoseObservation> observations;
  observations.reserve(used.size());
  for (const PointMatch& match : used) {
    observations.push_back(Observe(frame, match));
  }
  const PoseResult result = OptimizePose(frame.data.camera(), estimate.camera_from_world, observations,
                                         frame.setup.pose, estimate.prior ? &*estimate.prior : nullptr);
  estimate.camera_from_world = result.camera_from_world;
  std::vector<PointMatch> inliers;
  inliers.reserve(used.size());
  estimate.association.static_count = 0;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (result.inlier[i] != 0) {
      inliers.push_back(used[i]);
      estimate.association.static_count += used[i].state == PointState::kStatic ? 1 : 0;
    } else {
      estimate.outliers.push_back(used[i]);
    }
  }
  used = std::move(inliers);
}

bool Agrees(const FrameContext& frame, const Rigid3& camera_from_world, const PointMatch& match) {
  const PoseObservation observation = Observe(frame, match);
  return IsInlier(observation.keypoint, ReprojectionChi2(frame.data.camera(), observation.keypoint,
                                                         camera_from_world * observation.point_in_world));
}

double SumOfSquaredWeights(std::span<const PointMatch> matches) {
  double sum = 0;
  for (const PointMatch& match : matches) {
    sum += match.weight * match.weight;
  }
  return sum;
}

}  // namespace

Association Select(const FrameContext& frame, std::span<const PointMatch> matches) {
  return SelectMatches(matches, frame.map, frame.probabilities, frame.propagated, frame.options.association);
}

PoseEstimate EstimatePose(const FrameContext& frame, const Rigid3& initial, const std::optional<PosePrior>& prior,
                          std::span<const PointMatch> matches) {
  const Stopwatch watch;
  PoseEstimate estimate{initial, prior, Select(frame, matches), {}};
  Optimize(frame, estimate);
  frame.times.pose_ms += watch.Milliseconds();
  return estimate;
}

void ResolveDeferred(const FrameContext& frame, PoseEstimate& estimate) {
  const Stopwatch watch;
  const AssociationOptions& options = frame.options.association;
  Association& association = estimate.association;
  std::vector<PointMatch> agreeing;
  for (const PointMatch& match : std::exchange(association.deferred, {})) {
    (Agrees(frame, estimate.camera_from_world, match) ? agreeing : estimate.outliers).push_back(match);
  }
  if (options.unknown == UnknownPoints::kDeferred && association.static_count < options.min_static_inliers &&
      !agreeing.empty()) {
    // Together they may weigh as much as the static ones, not more.
    const double scale =
        std::min(1.0, std::sqrt(SumOfSquaredWeights(association.used) / SumOfSquaredWeights(agreeing)));
    for (PointMatch match : agreeing) {
      match.weight *= scale;
      association.used.push_back(match);
    }
    Optimize(frame, estimate);
  } else {
    association.deferred = std::move(agreeing);
  }
  frame.times.pose_ms += watch.Milliseconds();
}

}  // namespace rds
