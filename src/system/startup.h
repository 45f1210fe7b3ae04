// SPDX-License-Identifier: Apache-2.0
// The first frames: which of them the map begins with, and that they are tracked again once a label tells what moves.
#pragma once

#include <vector>

#include "system/front_end.h"

namespace rds {

// A map is begun before anybody knows what moves, and from whatever is in view: it is not final. One caller.
//
// Until the first label the first keyframe stays the only one, for a limited number of frames, as poses may follow
// people who fill the picture. Once it is labeled, a new tracker goes through all frames since, with keyframes where it
// wants them: of the first one's static points few may be left by then. Where the label leaves next to nothing static,
// the map begins with a later frame, the first whose label does; the frames before it have no pose. If tracking stays
// lost first, all of them are tracked again with keyframes: whatever the labels say, it is all there is.
//
// Another world begins with what is in view once tracking has been lost for as long as it lasted, or for `patience_s`;
// a young one also when most of what it began with is gone: something was before the lens. What was tracked stays.
class Startup {
 public:
  // 0 frames: nothing is held back.
  // `compares`: labels are worth more once there are later frames to compare theirs with.
  // `patience_s`: 0 = a world that is not young is never left.
  Startup(int most_frames, bool compares, double patience_s)
      : most_frames_(most_frames), compares_(compares), patience_s_(patience_s), waiting_(most_frames > 0) {}

  // Whether keyframes are held back for now.
  [[nodiscard]] bool HoldsKeyframes() const { return waiting_ && !frames_.empty(); }
  // Whether a label has come with which the frames since are to be tracked again: a frame that it made lost is no
  // reason to go elsewhere.
  [[nodiscard]] bool WillTrackAgain(const FrontEnd& front_end) const;
  // Tracking goes on in a world that is known.
  void GoOnElsewhere();
  // Before each frame. If a label has come that frames wait for, they are tracked again. Takes as long as that.
  void TrackAgainIfLabeled(FrontEnd& front_end);
  // After each frame, with its outcome: begins the map anew with it if that is due, which makes it a tracked keyframe.
  // Whether it was.
  [[nodiscard]] bool BeginAnewIfLost(const IncomingFrame& frame, FrontEnd& front_end, TrackOutcome& outcome);
  // After that.
  void Keep(const IncomingFrame& frame, const TrackOutcome& outcome, FrontEnd& front_end);
  // After the last frame: what still waits for a better label is tracked with what there is.
  void End(FrontEnd& front_end);

 private:
  [[nodiscard]] bool HasUsableLabel(const FrontEnd& front_end) const;
  // Whether a label has come that left nothing to begin with.
  [[nodiscard]] bool AwaitsBetter() const { return ask_ || begin_ > 0; }
  // The frames from `first` on.
  void TrackAgain(std::size_t first, FrontEnd& front_end);
  // Forgets what was awaited.
  void BeginWorld(FrameId first);
  void Ask(const IncomingFrame& frame, FrontEnd& front_end);
  // Whether the label that has come is the best to be had.
  [[nodiscard]] bool IsFinal(FrontEnd& front_end);

  int most_frames_;
  bool compares_;
  double patience_s_;
  bool waiting_;
  std::vector<IncomingFrame> frames_;  // since the first one that was tracked
  std::size_t begin_ = 0;              // of those: the one that the map is to begin with. The ones before have no image
  FrameId asked_;                      // that one: its label is awaited
  bool asked_again_ = false;           // for what has moved since
  int waited_again_ = 0;               // frames
  bool weak_ = false;                  // the last frame can hardly be tracked any more
  bool ask_ = false;                   // its label leaves nothing: the next frame's is wanted
  int waited_ = 0;                     // frames
  int lost_waiting_ = 0;               // frames on end
  int tracked_ = 0;                    // frames of this world
  int lost_ = 0;                       // frames on end that had what a map can begin with
  double lost_s_ = 0;                  // the time of those
  double last_s_ = 0;                  // when the last frame was
  FrameId first_;                      // of this world
};

}  // namespace rds
