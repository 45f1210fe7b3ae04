// SPDX-License-Identifier: Apache-2.0
#include "system/front_end.h"

#include <algorithm>
#include <utility>

namespace rds {
namespace {

constexpr std::size_t kMostLost = 150;  // frames that are kept to be found at the end: 20 MB, some seconds

}  // namespace

FrontEnd::FrontEnd(const Options& options, const ScalePyramid& pyramid, Lanes& lanes, Executor& executor)
    : options_(options), pyramid_(pyramid), lanes_(lanes), executor_(executor), tracker_(MakeTracker()) {}

std::unique_ptr<Tracker> FrontEnd::MakeTracker() const {
  TrackerSetup setup;
  setup.pose = options_.pose;
  setup.surface = options_.propagation.surface;
  setup.semantics = lanes_.semantics.HasSegmenter();
  setup.pyramid = pyramid_;
  return std::make_unique<Tracker>(options_.tracking, setup, lanes_.backend.probabilities());
}

TrackOutcome FrontEnd::Track(const IncomingFrame& frame, std::shared_ptr<const LocalMap> map,
                             std::shared_ptr<const PropagatedLabels> labels) {
  if (map != nullptr) {
    epoch_ = map->epoch;
    if (labels != nullptr && labels->epoch != epoch_) {
      labels = nullptr;  // they lie where the map was
    }
  }
  TrackOutcome outcome =
      tracker_->Track(frame.id, frame.timestamp_s, frame.data, std::move(map), executor_.Status(), std::move(labels));
  trajectory_.Add(frame.id, frame.timestamp_s, outcome);
  if (outcome.tracked) {
    lost_since_.reset();
  } else if (!lost_since_) {
    lost_since_ = frame.id;
  }
  return outcome;
}

void FrontEnd::Map(KeyframeCandidate& candidate) {
  const bool starts_world = !candidate.reference.valid();
  const KeyframeId id = lanes_.mapping.Map(candidate, [] { return false; });
  lanes_.Learn(id);
  if (starts_world) {
    trajectory_.HangLastOn(id);
    Record(SlamEventKind::kWorldStarted, lanes_.backend.Read([&](const rds::Map& map) { return map.WorldOf(id); }), 0);
  }
}

void FrontEnd::Label(const IncomingFrame& frame) {
  tracker_->KeyframeTaken();
  if (lanes_.semantics.HasSegmenter() && frame.image != nullptr) {
    AskForLabel(frame, false);
  }
}

bool FrontEnd::OfferKeyframe(const IncomingFrame& frame) {
  KeyframeCandidate candidate = tracker_->MakeCandidate();
  if (!candidate.reference.valid()) {  // it is the map: the next frame must find it there
    Map(candidate);
  } else if (!executor_.Map(candidate)) {
    return false;
  }
  Label(frame);
  return true;
}

void FrontEnd::MapKeyframeNow(const IncomingFrame& frame) {
  KeyframeCandidate candidate = tracker_->MakeCandidate();
  Map(candidate);
  Label(frame);
}

bool FrontEnd::CanBeginWith(const IncomingFrame& frame) const {
  return std::ranges::count_if(frame.data->keypoints(), &Keypoint::HasDepth) >= LeastToBegin();
}

std::optional<TrackOutcome> FrontEnd::BeginAnew(const IncomingFrame& frame, FrameId first) {
  if (!executor_.Status().mapping_idle) {
    return std::nullopt;
  }
  StartAgain(first, 1);
  TrackOutcome outcome = Track(frame, nullptr, nullptr);
  MapKeyframeNow(frame);
  outcome.wants_keyframe = false;  // it is one
  return outcome;
}

bool FrontEnd::IsLabeled(FrameId frame) const {
  return lanes_.backend.Read([&](const rds::Map& map) {
    const Keyframe* const keyframe = map.FindByFrame(frame);
    return keyframe != nullptr && keyframe->IsLabeled();
  });
}

void FrontEnd::AskForLabel(const IncomingFrame& frame, bool again) {
  executor_.Label({frame.id, frame.timestamp_s, frame.image, frame.data, false, again});
}

void FrontEnd::Propagate(const IncomingFrame& frame, const TrackOutcome& outcome) {
  if (outcome.tracked) {
    executor_.Propagate(
        {frame.id, frame.data, outcome.camera_from_world, lanes_.semantics.LabeledViews(epoch_), epoch_});
  }
}

void FrontEnd::AskForPlace(const IncomingFrame& frame) {
  lanes_.Find({frame.id, frame.timestamp_s, frame.data});
  if (lanes_.finds_places) {
    lost_frames_.push_back({frame.id, frame.timestamp_s, frame.data});
    if (lost_frames_.size() > kMostLost) {
      lost_frames_.pop_front();
    }
  }
}

void FrontEnd::FindLost() {
  for (const LostFrame& lost : lost_frames_) {
    if (trajectory_.Has(lost.frame) || !trajectory_.HasAfter(lost.frame)) {
      continue;  // it was tracked again, or the map has learned nothing since
    }
    if (const auto place = lanes_.loops.Place(lost)) {
      trajectory_.AddFound(lost.frame, lost.timestamp_s, place->frame.reference, place->frame.camera_from_reference);
    }
  }
  lost_frames_.clear();
}

bool FrontEnd::GoOnWhereFound() {
  const auto place = lanes_.loops.NewestPlace();
  if (!lost_since_ || place == nullptr || place->frame.id < *lost_since_ || !executor_.Status().mapping_idle) {
    return false;
  }
  lost_since_.reset();  // it is used once
  const auto present = CurrentLocalMap();
  if (present != nullptr && present->epoch > place->map->epoch) {
    return false;  // the map has been corrected since
  }
  lanes_.backend.Publish(place->map);
  tracker_->Relocate(place->frame);
  Record(SlamEventKind::kRelocalized, place->map->world, place->matches);
  return true;
}

void FrontEnd::Record(SlamEventKind kind, WorldId world, int matches) {
  SlamEvent event;
  event.kind = kind;
  event.world = world;
  event.matches = matches;
  lanes_.loops.Record(event);
}

void FrontEnd::StartAgain(FrameId first, std::size_t frames) {
  tracker_ = MakeTracker();
  trajectory_.GiveUp(first, frames);
  executor_.RestartPropagation();
}

}  // namespace rds
