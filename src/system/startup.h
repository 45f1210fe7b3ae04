// SPDX-License-Identifier: Apache-2.0
// The first frames, which are tracked again once a label tells what moves.
#pragma once

#include <vector>

#include "system/front_end.h"

namespace rds {

// Before the first label nobody can tell what moves, and poses may follow people who fill the picture. So until then
// the first keyframe stays the only one, for a limited number of frames. Once it is labeled, a new tracker goes through
// all frames since, with keyframes where it wants them: of the first one's static points few may be left by then. One
// caller.
class Startup {
 public:
  // 0 frames: nothing is held back.
  explicit Startup(int most_frames) : most_frames_(most_frames), waiting_(most_frames > 0) {}

  // Whether keyframes are held back for now.
  [[nodiscard]] bool HoldsKeyframes() const { return waiting_ && !frames_.empty(); }
  // Once there is a label while frames wait for it: they are tracked again. Takes as long as that.
  void TrackAgainIfLabeled(bool labeled, FrontEnd& front_end);
  // After each frame.
  void Keep(const IncomingFrame& frame, const TrackOutcome& outcome, bool labeled, FrontEnd& front_end);

 private:
  void TrackAgain(FrontEnd& front_end);

  int most_frames_;
  bool waiting_;
  std::vector<IncomingFrame> frames_;  // since the first one that was tracked
};

}  // namespace rds
