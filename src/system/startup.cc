// SPDX-License-Identifier: Apache-2.0
#include "system/startup.h"

#include <algorithm>
#include <utility>

#include "base/log.h"

namespace rds {
namespace {

constexpr std::uint32_t kFramesBetweenKeyframes = 4;  // at least, among those tracked again
constexpr int kWeakMatches = 30;                      // with fewer the first keyframe does not do any more
constexpr int kMostVoid = 90;                         // frames more to wait where labels leave less
constexpr int kPatience = 15;                         // frames lost on end while a better label is awaited
constexpr int kYoung = 100;                           // frames tracked: what is older is not begun anew
constexpr int kLeastLost = 5;
constexpr double kGap_s = 0.2;      // a frame counts for so long at most
constexpr double kLeastLeft = 0.4;  // of what the map began with: with less that was something before the lens

}  // namespace

bool Startup::HasUsableLabel(const FrontEnd& front_end) const {
  const auto answer = front_end.NewestAnswer();
  return answer && asked_.valid() && answer->frame == asked_ && answer->usable_keypoints >= front_end.LeastToBegin();
}

bool Startup::WillTrackAgain(const FrontEnd& front_end) const {
  return waiting_ && !frames_.empty() && (HasUsableLabel(front_end) || front_end.IsLabeled(asked_));
}

void Startup::TrackAgainIfLabeled(FrontEnd& front_end) {
  if (!waiting_ || frames_.empty()) {
    return;
  }
  if (HasUsableLabel(front_end)) {
    if (IsFinal(front_end)) {
      waiting_ = false;
      TrackAgain(begin_, front_end);
    }
  } else if (const auto answer = front_end.NewestAnswer(); answer && answer->frame == asked_) {
    ask_ = true;
  }
}

bool Startup::IsFinal(FrontEnd& front_end) {
  if (!compares_ || front_end.NewestAnswer()->compared || waited_again_ >= most_frames_) {
    return true;
  }
  IncomingFrame& first = frames_[begin_];
  if (!asked_again_ && (weak_ || frames_.back().timestamp_s - first.timestamp_s >= RecentFrames::kWitness_s)) {
    asked_again_ = true;
    front_end.AskForLabel(first, true);
    first.image.reset();  // as its keyframe it is not to be labeled once more
  }
  ++waited_again_;
  return false;
}

void Startup::TrackAgain(std::size_t first, FrontEnd& front_end) {
  const bool first_is_mapped = first == 0;
  const std::vector<IncomingFrame> frames(frames_.begin() + static_cast<std::ptrdiff_t>(first), frames_.end());
  frames_.clear();
  front_end.StartAgain(first_, frames.size());
  std::shared_ptr<const LocalMap> map;  // none for the first frame: it is the first keyframe
  FrameId keyframe;
  for (const IncomingFrame& frame : frames) {
    const TrackOutcome outcome = front_end.Track(frame, map, nullptr);
    const bool begins = !keyframe.valid();
    if (begins && !outcome.tracked) {
      continue;  // too little to begin with
    }
    front_end.Propagate(frame, outcome);
    if (begins && first_is_mapped) {
      front_end.HangLastOn(front_end.CurrentLocalMap()->FindByFrame(frame.id)->id);
    } else if (begins || (outcome.wants_keyframe && frame.id.value - keyframe.value >= kFramesBetweenKeyframes)) {
      front_end.MapKeyframeNow(frame);
    } else {
      continue;
    }
    map = front_end.CurrentLocalMap();
    keyframe = frame.id;
  }
}

void Startup::Ask(const IncomingFrame& frame, FrontEnd& front_end) {
  begin_ = frames_.size();
  for (IncomingFrame& earlier : frames_) {
    earlier.image.reset();
  }
  asked_ = frame.id;
  ask_ = false;
  asked_again_ = false;
  waited_again_ = 0;
  front_end.AskForLabel(frame, false);
  frames_.push_back(frame);
  if (!compares_) {
    frames_.back().image.reset();  // as its keyframe it is not to be labeled once more
  }
}

bool Startup::BeginAnewIfLost(const IncomingFrame& frame, FrontEnd& front_end, TrackOutcome& outcome) {
  const double seconds = std::min(frame.timestamp_s - std::exchange(last_s_, frame.timestamp_s), kGap_s);
  if (front_end.trajectory().empty()) {
    return false;
  }
  const bool is_usable = front_end.CanBeginWith(frame);
  tracked_ += outcome.tracked ? 1 : 0;
  lost_ = outcome.tracked ? 0 : lost_ + (is_usable ? 1 : 0);
  lost_s_ = outcome.tracked ? 0 : lost_s_ + (is_usable ? seconds : 0);
  const bool is_young = tracked_ <= kYoung;
  const bool is_lost =
      lost_ >= kLeastLost && ((is_young && lost_ >= tracked_) || (patience_s_ > 0 && lost_s_ >= patience_s_));
  // Before the first label poses may follow what moves, and say nothing of what is left.
  const auto answer = front_end.NewestAnswer();
  const bool is_labeled = !waiting_ || (answer && answer->frame == asked_);
  const bool is_elsewhere = is_young && is_labeled && front_end.LeftOfReference().value_or(1) < kLeastLeft;
  if ((!is_lost && !is_elsewhere) || !is_usable) {
    return false;
  }
  if (waiting_ && HasUsableLabel(front_end)) {  // what there was before the lens may be labeled: tracked again first
    weak_ = asked_again_ = true;
    waited_again_ = most_frames_;
    return false;
  }
  // Poses in a world of which the labels leave nothing are none.
  auto begun = front_end.BeginAnew(frame, waiting_ && AwaitsBetter() ? first_ : frame.id);
  if (!begun) {
    return false;
  }
  log::info("lost after {} frames; another world begins with frame {}", tracked_, frame.id.value);
  outcome = std::move(*begun);
  BeginWorld(frame.id);
  waiting_ = most_frames_ > 0;
  tracked_ = 1;
  return true;
}

void Startup::BeginWorld(FrameId first) {
  frames_.clear();
  first_ = first;
  begin_ = 0;
  asked_ = first;
  ask_ = false;
  asked_again_ = false;
  waited_again_ = 0;
  weak_ = false;
  waited_ = 0;
  lost_waiting_ = 0;
  lost_ = 0;
  lost_s_ = 0;
}

void Startup::GoOnElsewhere() {
  BeginWorld({});
  waiting_ = false;
  tracked_ = kYoung + 1;  // it was tracked in before
}

void Startup::Keep(const IncomingFrame& frame, const TrackOutcome& outcome, FrontEnd& front_end) {
  if (!waiting_ || front_end.trajectory().empty()) {
    return;
  }
  if (!asked_.valid()) {
    asked_ = frame.id;
    first_ = frame.id;
  }
  if (ask_ && front_end.CanBeginWith(frame)) {
    Ask(frame, front_end);
  } else {
    frames_.push_back(frame);
  }
  ++waited_;
  // A lost frame is not weak: the map cannot grow by it, and it may be the label that took its points away.
  const bool weak = frames_.size() > 1 && outcome.tracked && std::ssize(outcome.used) < kWeakMatches;
  weak_ = weak || !outcome.tracked;
  const int most = AwaitsBetter() ? most_frames_ + kMostVoid : most_frames_;
  // If a label came while this frame was tracked, all are tracked again before the next one. It takes points away
  // before the answer says that it is there: what made the frame weak then is the label itself.
  waiting_ = HasUsableLabel(front_end) || (waited_ < most && (!weak || front_end.IsLabeled(asked_)));
  lost_waiting_ = outcome.tracked ? 0 : lost_waiting_ + 1;
  if (waiting_ && AwaitsBetter() && lost_waiting_ >= kPatience && !HasUsableLabel(front_end)) {
    waiting_ = false;
    TrackAgain(0, front_end);
  } else if (!waiting_) {  // the map must grow, labeled or not
    frames_.clear();
  }
}

void Startup::End(FrontEnd& front_end) {
  if (waiting_ && !frames_.empty() && HasUsableLabel(front_end)) {
    waiting_ = false;
    TrackAgain(begin_, front_end);
  } else if (waiting_ && lost_waiting_ > 0 && AwaitsBetter()) {
    waiting_ = false;
    TrackAgain(0, front_end);
  }
}

}  // namespace rds
