// SPDX-License-Identifier: Apache-2.0
#include "system/startup.h"

#include <utility>

namespace rds {
namespace {

constexpr std::uint32_t kFramesBetweenKeyframes = 4;  // at least, among those tracked again
constexpr int kWeakMatches = 30;                      // with fewer the first keyframe does not do any more

}  // namespace

void Startup::TrackAgainIfLabeled(bool labeled, FrontEnd& front_end) {
  if (waiting_ && labeled) {
    waiting_ = false;
    TrackAgain(front_end);
  }
}

void Startup::TrackAgain(FrontEnd& front_end) {
  const std::vector<IncomingFrame> frames = std::move(frames_);
  front_end.StartAgain();
  std::shared_ptr<const LocalMap> map;  // none for the first frame: it is the first keyframe
  FrameId keyframe;
  for (const IncomingFrame& frame : frames) {
    const TrackOutcome outcome = front_end.Track(frame, map, nullptr);
    front_end.Propagate(frame, outcome);
    map = front_end.CurrentLocalMap();
    if (!keyframe.valid()) {
      keyframe = frame.id;
      front_end.HangLastOn(map->FindByFrame(frame.id)->id);
    } else if (outcome.wants_keyframe && frame.id.value - keyframe.value >= kFramesBetweenKeyframes) {
      front_end.MapKeyframeNow(frame);
      map = front_end.CurrentLocalMap();
      keyframe = frame.id;
    }
  }
}

void Startup::Keep(const IncomingFrame& frame, const TrackOutcome& outcome, bool labeled, FrontEnd& front_end) {
  if (!waiting_ || front_end.trajectory().empty()) {
    return;
  }
  frames_.push_back(frame);
  // A lost frame is not weak: the map cannot grow by it, and it may be the label that took its points away.
  const bool weak = frames_.size() > 1 && outcome.tracked && std::ssize(outcome.used) < kWeakMatches;
  // If a label came while this frame was tracked, all are tracked again before the next one.
  waiting_ = labeled || (!weak && std::ssize(frames_) < most_frames_);
  if (!waiting_) {  // the map must grow, labeled or not
    frames_.clear();
  }
}

}  // namespace rds
