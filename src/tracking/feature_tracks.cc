#include "tracking/feature_tracks.h"

#include <cmath>
#include <utility>

#include "feature/matching.h"

namespace rds {
namespace {

constexpr double kVotedDynamic = 0.8;

}  // namespace

void FeatureTracks::Advance(std::shared_ptr<const FrameData> frame, MovingProbabilities& labels) {
  std::vector<PointId> ids(frame->size());
  std::vector<Flow> flows(frame->size());
  if (frame_ != nullptr) {
    MatchSet set(frame->size());
    for (std::size_t i = 0; i < frame_->size(); ++i) {
      const Keypoint& old = frame_->keypoints()[i];
      const Candidate best = FindBest(*frame,
                                      {old.x + flows_[i].x, old.y + flows_[i].y, -1,
                                       static_cast<float>(options_.window_px), old.octave - 1, old.octave + 1},
                                      frame_->descriptors()[i]);
      if (best.keypoint >= 0 && best.distance <= kStrictDistance) {
        set.Add({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(best.keypoint), best.distance});
      }
    }
    for (const Match& match : set.Take()) {
      const Keypoint& old = frame_->keypoints()[match.query];
      const Keypoint& now = frame->keypoints()[match.keypoint];
      ids[match.keypoint] = ids_[match.query];
      flows[match.keypoint] = {now.x - old.x, now.y - old.y};
    }
  }
  for (PointId& id : ids) {
    if (!id.valid()) {
      id = PointId{next_};
      next_ = (next_ + 1) % kMostTracks;
      labels.Set(id, kUnknownProbability);
    }
  }
  frame_ = std::move(frame);
  ids_ = std::move(ids);
  flows_ = std::move(flows);
}

std::vector<double> FeatureTracks::Probabilities(const MovingProbabilities& labels,
                                                 const MovingProbabilityOptions& options) const {
  std::vector<double> own;
  std::vector<PointState> states;
  own.reserve(ids_.size());
  for (const PointId id : ids_) {
    own.push_back(labels.Get(id));
    states.push_back(StateOf(own.back(), options));
  }
  std::vector<double> result = own;
  for (std::size_t i = 0; i < result.size(); ++i) {
    const Keypoint& keypoint = frame_->keypoints()[i];
    if (states[i] != PointState::kUnknown || !keypoint.HasDepth()) {
      continue;
    }
    const float depth_window_m = keypoint.depth_m * static_cast<float>(options_.vote_depth);
    int dynamic = 0;
    int still = 0;
    frame_->ForEachInWindow(keypoint.x, keypoint.y, static_cast<float>(options_.vote_window_px), 0, 255,
                            [&](std::size_t j) {
                              const Keypoint& other = frame_->keypoints()[j];
                              if (other.HasDepth() && std::abs(other.depth_m - keypoint.depth_m) < depth_window_m) {
                                dynamic += states[j] == PointState::kDynamic ? 1 : 0;
                                still += states[j] == PointState::kStatic ? 1 : 0;
                              }
                            });
    if (dynamic >= options_.votes && dynamic >= 2 * still) {
      result[i] = kVotedDynamic;
    }
  }
  return result;
}

}  // namespace rds
