// SPDX-License-Identifier: Apache-2.0
// Tracking, and what it hands on: the lane of the caller's thread.
#pragma once

#include <deque>
#include <memory>

#include "system/executor.h"
#include "system/trajectory_recorder.h"
#include "tracking/tracker.h"

namespace rds {

// A frame on its way.
struct IncomingFrame {
  FrameId id;
  double timestamp_s = 0;
  std::shared_ptr<const FrameData> data;
  std::shared_ptr<const Image8> image;
};

// Tracks frames, records their poses and offers keyframes. One caller.
class FrontEnd {
 public:
  // All must outlive the front end.
  FrontEnd(const Options& options, const ScalePyramid& pyramid, Lanes& lanes, Executor& executor);

  // `labels` are propagated ones of an earlier frame, or null.
  TrackOutcome Track(const IncomingFrame& frame, std::shared_ptr<const LocalMap> map,
                     std::shared_ptr<const PropagatedLabels> labels);
  // Offers the frame just tracked as a keyframe. False: there is no capacity for it now.
  bool OfferKeyframe(const IncomingFrame& frame);
  // Maps the frame just tracked before it returns, and has it labeled if it still has its image: on this thread, which
  // is safe only while no keyframe waits for mapping or is being mapped, so that the mapping lane has one caller at a
  // time. Such is the start: keyframes are not offered until the first one is mapped, nor while the first frames wait
  // for a label.
  void MapKeyframeNow(const IncomingFrame& frame);
  // Keypoints with depth, static if that is known, that a map needs to begin with.
  [[nodiscard]] int LeastToBegin() const { return options_.tracking.min_start_points; }
  [[nodiscard]] bool CanBeginWith(const IncomingFrame& frame) const;
  // Begins another world of the map with a frame just lost, giving up the poses of `first` and those after it. Nothing
  // while mapping is busy.
  [[nodiscard]] std::optional<TrackOutcome> BeginAnew(const IncomingFrame& frame, FrameId first);
  // Has a frame labeled that is no keyframe yet, or is labeled `again`.
  void AskForLabel(const IncomingFrame& frame, bool again);
  // Hands a tracked frame to the propagation of labels.
  void Propagate(const IncomingFrame& frame, const TrackOutcome& outcome);
  // Forgets the poses of a frame and of those after it, of which so many are to come again, and propagated labels. The
  // map stays.
  void StartAgain(FrameId first, std::size_t frames);
  // Looks for a frame just lost in all of the map.
  void AskForPlace(const IncomingFrame& frame);
  // Gives the newest lost frames poses where they are found in the map as it is at the end, of which much was not there
  // when they were lost. After the executor has finished.
  void FindLost();
  // Goes on where an earlier frame was found, if one was since tracking was lost. Whether it was.
  bool GoOnWhereFound();
  // The pose of the last frame is that of a keyframe.
  void HangLastOn(KeyframeId keyframe) { trajectory_.HangLastOn(keyframe); }

  // As the tracker's.
  [[nodiscard]] Tangent6 Velocity() const { return tracker_->Velocity(); }
  [[nodiscard]] std::optional<double> LeftOfReference() const { return tracker_->LeftOfReference(); }
  [[nodiscard]] std::optional<SemanticLane::Answer> NewestAnswer() const { return lanes_.semantics.NewestAnswer(); }
  // Whether the keyframe of a frame is labeled in the map, be its answer there yet or not. Takes the map's lock.
  [[nodiscard]] bool IsLabeled(FrameId frame) const;
  [[nodiscard]] const TrajectoryRecorder& trajectory() const { return trajectory_; }
  [[nodiscard]] std::shared_ptr<const LocalMap> CurrentLocalMap() const { return lanes_.backend.CurrentLocalMap(); }

 private:
  [[nodiscard]] std::unique_ptr<Tracker> MakeTracker() const;
  void Record(SlamEventKind kind, WorldId world, int matches);
  void Map(KeyframeCandidate& candidate);
  void Label(const IncomingFrame& frame);

  Options options_;
  ScalePyramid pyramid_;
  Lanes& lanes_;
  Executor& executor_;
  std::unique_ptr<Tracker> tracker_;
  TrajectoryRecorder trajectory_;
  std::optional<FrameId> lost_since_;
  std::deque<LostFrame> lost_frames_;
  std::uint32_t epoch_ = 0;  // of the map that the last frame was tracked in
};

}  // namespace rds
