// SPDX-License-Identifier: Apache-2.0
// Tracking: the pose of each frame against an immutable snapshot of the map.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "base/ids.h"
#include "map/keyframe_candidate.h"
#include "map/local_map.h"
#include "map/moving_probability.h"
#include "tracking/coarse_pose.h"
#include "tracking/keyframe_policy.h"
#include "tracking/motion_model.h"
#include "tracking/point_uses.h"
#include "tracking/pose_estimate.h"
#include "tracking/tracker_options.h"

namespace rds {

// What tracking must know of the other threads, read once a frame.
struct WorkerStatus {
  bool mapping_idle = true;
  bool segmenter_idle = false;
};

// Outcome of one frame.
struct TrackOutcome {
  bool tracked = false;
  Rigid3 camera_from_world;  // valid if tracked
  WorldId world;             // of the map that it was tracked in, invalid for a frame that starts a world
  std::uint32_t epoch = 0;   // of that map
  KeyframeId reference;  // the pose hangs on this keyframe, the newest around; invalid for a frame that starts a world
  Rigid3 camera_from_reference;
  std::optional<Rigid3> current_from_last;  // motion since the last frame, if that was tracked, too
  // Share of the depth image that the pose explains (ExplainedShare) by the view of the oldest keyframe that looks the
  // same way; with semantics of what is known as static.
  std::optional<double> confidence;
  bool wants_keyframe = false;       // MakeCandidate gives it
  std::vector<PointMatch> used;      // the pose stands on these
  std::vector<PointMatch> rejected;  // dynamic points and outliers
  StageTimes times;
};

// A frame that was placed by something else.
struct KnownFrame {
  FrameId id;
  double timestamp_s = 0;
  std::shared_ptr<const FrameData> data;
  KeyframeId reference;
  Rigid3 camera_from_reference;
  std::vector<PointId> points;  // of each keypoint, invalid where there is none
};

// The tracking thread's algorithm (sections III and V of the paper). Knows no thread: reads the snapshot it is given
// and the wait-free table of probabilities, changes only itself. One instance, one caller.
class Tracker {
 public:
  // The table must outlive the tracker.
  Tracker(const TrackerOptions& options, TrackerSetup setup, const MovingProbabilities& probabilities);

  // Tracks one frame. `map` is null before the first keyframe is in the map; `labels` are propagated ones of an earlier
  // frame, the newest there are, or null.
  TrackOutcome Track(FrameId frame, double timestamp_s, std::shared_ptr<const FrameData> data,
                     std::shared_ptr<const LocalMap> map, const WorkerStatus& status,
                     std::shared_ptr<const PropagatedLabels> labels);

  // Tells a lost tracker where an earlier frame was taken, as if it had tracked it: the next frame is looked for from
  // there, in a map that holds the reference.
  void Relocate(const KnownFrame& frame);
  // The frame just tracked as a keyframe; to be called at most once, after Track said wants_keyframe.
  [[nodiscard]] KeyframeCandidate MakeCandidate();
  // Share of what the reference keyframe saw that the newest frame still shows (ExplainedShare), by its pose, or by
  // that of the frame before if it is just lost. Nothing where that says too little.
  [[nodiscard]] std::optional<double> LeftOfReference() const;
  // Expected of points at rest in the frame of the camera, m/s and rad/s; 0 where nothing is known.
  [[nodiscard]] Tangent6 Velocity() const { return motion_.Velocity(); }
  // Tells that the candidate was taken: the policy counts anew.
  void KeyframeTaken();

 private:
  struct Frame {
    FrameId id;
    double timestamp_s = 0;
    std::shared_ptr<const FrameData> data;
    bool tracked = false;
    Rigid3 camera_from_world;  // the last known one where it is not tracked
    KeyframeId reference;
    Rigid3 camera_from_reference;
    std::vector<PointId> points;                // of each keypoint, inliers only
    std::vector<LastObservation> observations;  // the same as the snapshot has them
    Association association;                    // of the final pose
  };
  // The most points of the reference keyframe among the inliers of a frame, since it is the reference.
  struct Seen {
    KeyframeId reference;
    int points = 0;
  };
  // What propagated labels say of a frame.
  struct FrameLabels {
    std::optional<KeypointProbabilities> keypoints;  // none without labels
    std::vector<std::uint8_t> static_samples;        // of its depth grid, those that keep still; empty without labels
  };

  TrackOutcome Start();
  TrackOutcome TrackInMap(const WorkerStatus& status);
  // What the labels say of the current frame, where a steady motion would have brought the camera.
  void LookUp(std::shared_ptr<const PropagatedLabels> labels);
  // The last frame as the new snapshot has it: the reference keyframe may have been corrected since, points fused.
  void Rebase();
  [[nodiscard]] ExpectedPose Predict() const;
  [[nodiscard]] std::optional<PoseEstimate> CoarsePose(const FrameContext& frame, const ExpectedPose& expected) const;
  // The pose from all points of the local map, `window_px` searched around each.
  [[nodiscard]] PoseEstimate TrackLocalMap(const FrameContext& frame, const PoseEstimate& coarse, double window_px);
  [[nodiscard]] bool HasEnoughInliers(const Association& association, bool recovering) const;
  // Whether depth images speak against a pose that matches alone may have got wrong: one that is found anew, or that
  // keeps few of the last frame's matches.
  [[nodiscard]] bool IsContradicted(const PoseEstimate& estimate) const;
  [[nodiscard]] TrackOutcome Lost(const StageTimes& times);
  [[nodiscard]] TrackOutcome Tracked(PoseEstimate estimate, const WorkerStatus& status, const StageTimes& times);
  [[nodiscard]] std::optional<double> ExplainedBy(const LocalKeyframe& keyframe) const;
  [[nodiscard]] const LocalKeyframe* OldestOfThisView() const;
  [[nodiscard]] KeyframeSituation Situation(const WorkerStatus& status);

  TrackerOptions options_;
  TrackerSetup setup_;
  const MovingProbabilities& probabilities_;

  std::shared_ptr<const LocalMap> map_;
  Frame last_;
  Frame current_;
  FrameLabels labels_;  // of the current frame
  MotionModel motion_;
  bool started_ = false;
  int frames_since_keyframe_ = 0;
  Seen seen_;
  std::optional<int> frames_since_recovery_;  // none before the first
  PointUses uses_;
};

}  // namespace rds
