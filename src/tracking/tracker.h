// SPDX-License-Identifier: Apache-2.0
// Tracking: the pose of each frame against an immutable snapshot of the map.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "base/ids.h"
#include "map/keyframe_candidate.h"
#include "map/local_map.h"
#include "map/moving_probability.h"
#include "optim/pose_optimizer.h"
#include "propagation/label_propagation.h"
#include "tracking/data_association.h"
#include "tracking/depth_registration.h"
#include "tracking/keyframe_policy.h"
#include "tracking/motion_model.h"
#include "tracking/point_uses.h"
#include "tracking/projection_search.h"

namespace rds {

struct TrackerOptions {
  int min_start_points = 100;    // keypoints with depth that a first keyframe needs
  double motion_window_px = 15;  // at most, by what the prediction is worth; doubled if too little is found
  int min_motion_matches = 20;
  int min_motion_inliers = 10;
  double reference_ratio = 0.7;
  int min_reference_matches = 15;
  double local_window_px = 3;
  double recovery_window_px = 10;
  double local_ratio = 0.8;
  int min_inliers = 30;           // of a tracked frame; static ones alone need only tau
  int min_recovery_inliers = 50;  // when recovery; static ones alone need only min_inliers
  int recovery_keyframes = 10;    // nearest keyframes that are tried
  AssociationOptions association;
  MotionOptions motion;
  DepthRegistrationOptions registration;
  KeyframePolicyOptions policy;
};

// What tracking takes over from other modules.
struct TrackerSetup {
  PoseOptimizerOptions pose;
  SurfaceLabelOptions surface;  // of the labels that Track is given
  double depth_threshold = 40;  // in baselines, as in MappingOptions: depth below it is close
  bool semantics = true;        // labels are expected at all
  ScalePyramid pyramid;
};

// What tracking must know of the other threads, read once a frame.
struct WorkerStatus {
  bool mapping_idle = true;
  bool segmenter_idle = false;
};

// Outcome of one frame.
struct TrackOutcome {
  bool tracked = false;
  Rigid3 camera_from_world;  // valid if tracked
  KeyframeId reference;      // the pose hangs on this keyframe; invalid for the very first frame
  Rigid3 camera_from_reference;
  bool wants_keyframe = false;       // MakeCandidate gives it
  std::vector<PointMatch> used;      // the pose stands on these
  std::vector<PointMatch> rejected;  // dynamic points and outliers
  double matching_ms = 0;
  double pose_ms = 0;
  double local_map_ms = 0;
};

// The tracking thread's algorithm (sections III and V of the paper). Knows no thread: reads the snapshot it is given
// and the wait-free table of probabilities, changes only itself. One instance, one caller.
class Tracker {
 public:
  // The table must outlive the tracker.
  Tracker(const TrackerOptions& options, TrackerSetup setup, const MovingProbabilities& probabilities);

  // Tracks one frame. `map` is null before the first keyframe is in the map; `labels` are of an earlier frame, the
  // newest there is, or null.
  TrackOutcome Track(FrameId frame, double timestamp_s, std::shared_ptr<const FrameData> data,
                     std::shared_ptr<const LocalMap> map, const WorkerStatus& status,
                     std::shared_ptr<const PropagatedLabels> labels);

  // The frame just tracked as a keyframe; to be called at most once, after Track said wants_keyframe.
  [[nodiscard]] KeyframeCandidate MakeCandidate();
  // Tells that the candidate was taken: the policy counts anew.
  void KeyframeTaken();

 private:
  struct Frame {
    FrameId id;
    double timestamp_s = 0;
    std::shared_ptr<const FrameData> data;
    Rigid3 camera_from_world;
    KeyframeId reference;
    Rigid3 camera_from_reference;
    std::vector<PointId> points;                // of each keypoint, inliers only
    std::vector<LastObservation> observations;  // the same as the snapshot has them
    bool tracked = false;
  };

  TrackOutcome Start(TrackOutcome outcome);
  void TrackInMap(const WorkerStatus& status, bool map_changed, TrackOutcome* outcome);
  [[nodiscard]] Association Select(std::span<const PointMatch> matches) const;
  // What the labels say of the current frame, where a steady motion would have brought the camera.
  void LookUp(std::shared_ptr<const PropagatedLabels> labels);
  void Rebase();
  // The pose to be expected, and what is known of it before anything is matched.
  void Predict(TrackOutcome* outcome);
  bool TrackLastFrame(TrackOutcome* outcome);
  bool TrackReferenceKeyframe(TrackOutcome* outcome);
  bool Recover(TrackOutcome* outcome);
  void RestorePrior(const PosePrior& expected);
  // `window_px` is searched around each point.
  bool TrackLocalMap(double window_px, TrackOutcome* outcome);
  // Pose from the matches that Algorithm 2 lets through; keeps the inliers in matches_. Returns their number.
  int OptimizeFrom(std::span<const PointMatch> matches, TrackOutcome* outcome);
  // Optimizes the pose over association_.used and keeps the inliers there.
  void OptimizeUsed();
  // Drops unknown matches that were not needed for the pose and do not agree with it; lets the others in where static
  // ones are few (UnknownPoints::kDeferred).
  void ResolveUnknown(TrackOutcome* outcome);
  [[nodiscard]] bool Agrees(const PointMatch& match) const;
  [[nodiscard]] bool HasEnoughInliers() const;
  [[nodiscard]] bool IsOutlierDominated() const;
  void ChooseReference(TrackOutcome* outcome);
  void CountUse(const LocalSearch& search);
  [[nodiscard]] PoseObservation Observe(const PointMatch& match) const;
  [[nodiscard]] KeyframeSituation Situation(const WorkerStatus& status) const;

  TrackerOptions options_;
  TrackerSetup setup_;
  const MovingProbabilities& probabilities_;
  std::function<double(std::uint32_t)> keypoint_probability_;  // of the current frame; none without labels
  std::vector<std::uint8_t> static_samples_;  // of its depth grid, those to be aligned; empty without labels

  std::shared_ptr<const LocalMap> map_;
  Frame last_;
  Frame current_;
  MotionModel motion_;
  std::optional<PosePrior> prior_;  // of the current frame
  Association association_;         // of the latest pose optimization; `used` are inliers
  std::vector<PointMatch> outliers_;
  bool started_ = false;
  bool recovering_ = false;
  int frames_since_keyframe_ = 0;
  int frames_since_recovery_ = 1 << 20;
  PointUses uses_;
};

}  // namespace rds
