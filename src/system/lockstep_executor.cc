// SPDX-License-Identifier: Apache-2.0
#include "system/lockstep_executor.h"

#include <algorithm>
#include <exception>
#include <utility>

namespace rds {

LockstepExecutor::LockstepExecutor(const Options& options, std::shared_ptr<Lanes> lanes)
    : options_(options), lanes_(std::move(lanes)) {
  RestartPropagation();
}

void LockstepExecutor::RestartPropagation() {
  if (WantsPropagation(options_, *lanes_)) {
    propagation_.emplace(options_.propagation, options_.semantic.free_space);
  }
}

void LockstepExecutor::BeginFrame(FrameId frame) {
  SeePlaces();
  if (round_ && round_->due_frame <= frame.value) {
    Deliver();
  }
  SelectNext(frame);
}

void LockstepExecutor::SeePlaces() {
  for (bool more = true; more;) {
    PlaceWork work;
    lanes_->places.Write([&](PlaceWork& waiting) { std::swap(work, waiting); });
    more = work.HasWork();
    if (work.lost) {
      lanes_->loops.Find(*work.lost);
    }
    bool bundle_due = false;
    for (const KeyframeId keyframe : work.keyframes) {
      bundle_due = lanes_->loops.Learn(keyframe, false) || bundle_due;
    }
    if (bundle_due && options_.loop.bundle) {
      lanes_->loops.Adjust({});
    }
  }
}

void LockstepExecutor::Deliver() {
  std::vector<BacklogItem> items = std::move(round_->items);
  round_.reset();
  const LabeledRound round = lanes_->semantics.Segment(std::move(items));
  lanes_->semantics.Apply(round);
  lanes_->Learn(round);
}

void LockstepExecutor::SelectNext(FrameId frame) {
  if (round_ || !lanes_->semantics.HasSegmenter()) {
    return;
  }
  auto selected = lanes_->waiting.Write([&](Waiting& waiting) {
    return waiting.backlog.Select(options_.semantic.selection, static_cast<std::size_t>(options_.semantic.per_round));
  });
  if (!selected.empty()) {
    const std::uint32_t asked = std::max(selected.back().frame.value + 1, frame.value);
    round_ = Round{asked + static_cast<std::uint32_t>(options_.semantic.lockstep_delay_frames), std::move(selected)};
  }
}

WorkerStatus LockstepExecutor::Status() const {
  WorkerStatus status;
  status.mapping_idle = true;
  status.segmenter_idle = lanes_->semantics.HasSegmenter() && !round_ &&
                          lanes_->waiting.Read([](const Waiting& waiting) { return waiting.backlog.empty(); });
  return status;
}

bool LockstepExecutor::Map(KeyframeCandidate& candidate) {
  lanes_->Learn(lanes_->mapping.Map(candidate, [] { return false; }));
  return true;
}

void LockstepExecutor::Label(BacklogItem item) {
  lanes_->waiting.Write([&](Waiting& waiting) { waiting.dropped += waiting.backlog.Push(std::move(item)); });
}

void LockstepExecutor::Propagate(TrackedFrame frame) {
  if (propagation_) {
    propagation_->Propagate(frame);
  }
}

std::shared_ptr<const PropagatedLabels> LockstepExecutor::NewestLabels(FrameId frame) const {
  return propagation_ ? propagation_->Newest(frame) : nullptr;
}

void LockstepExecutor::Finish() {
  try {
    while (!lanes_->failure.Happened() && lanes_->semantics.HasSegmenter()) {
      if (round_) {
        Deliver();
      }
      SelectNext(FrameId{0});
      if (!round_) {
        break;
      }
    }
    if (!lanes_->failure.Happened()) {
      SeePlaces();
    }
  } catch (...) {
    lanes_->failure.Set(std::current_exception());
  }
}

}  // namespace rds
