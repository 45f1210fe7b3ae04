#include "tracking/feature_tracks.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "feature/matching.h"

namespace rds {
namespace {

// Moving probability of what is dynamic for sure and of what a label just about reaches; static ones mirror them.
constexpr double kNear = 0.88;
constexpr double kFar = 0.62;
constexpr float kDepthStep = 0.1F;  // share by which the depth of a track may change from frame to frame

// Whether a keypoint can have become the other one since the last frame, by depth.
bool OnOneSurface(const Keypoint& last, const Keypoint& now) {
  return !last.HasDepth() || !now.HasDepth() || std::abs(last.depth_m - now.depth_m) < kDepthStep * last.depth_m;
}

}  // namespace

KeypointLabels FeatureTracks::Follow(std::shared_ptr<const FrameData> frame, std::span<const KeypointLabel> judged,
                                     MovingProbabilities& labels, const MovingProbabilityOptions& options) {
  ContinueTracks(std::move(frame));
  StartTracks(labels);
  std::vector<double> probabilities = SpreadLabels(judged, labels, options);
  return {ids_, std::move(probabilities), surface_.Moving()};
}

void FeatureTracks::ContinueTracks(std::shared_ptr<const FrameData> frame) {
  std::vector<PointId> ids(frame->size());
  std::vector<Track> tracks;
  if (frame_ != nullptr) {
    MatchSet set(frame->size());
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
      const Track& track = tracks_[i];
      const Keypoint& old = frame_->keypoints()[track.keypoint];
      const Candidate best = FindBest(*frame,
                                      {old.x + track.flow_x, old.y + track.flow_y, -1,
                                       static_cast<float>(options_.window_px), old.octave - 1, old.octave + 1},
                                      frame_->descriptors()[track.keypoint]);
      if (best.keypoint >= 0 && best.distance <= kStrictDistance &&
          OnOneSurface(old, frame->keypoints()[static_cast<std::size_t>(best.keypoint)])) {
        set.Add({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(best.keypoint), best.distance});
      }
    }
    for (const Match& match : set.Take()) {
      const Track& track = tracks_[match.query];
      const Keypoint& old = frame_->keypoints()[track.keypoint];
      const Keypoint& now = frame->keypoints()[match.keypoint];
      ids[match.keypoint] = ids_[track.keypoint];
      tracks.push_back({match.keypoint, now.x - old.x, now.y - old.y, track.inherited});
      if (track.inherited) {
        tracks.back().inherited->distance_px += options_.frame_cost_px;
      }
    }
  }
  frame_ = std::move(frame);
  ids_ = std::move(ids);
  tracks_ = std::move(tracks);
}

void FeatureTracks::StartTracks(MovingProbabilities& labels) {
  const PinholeCamera& camera = frame_->camera();
  const int columns = camera.width / options_.spacing_px + 1;
  const int rows = camera.height / options_.spacing_px + 1;
  occupied_.assign(static_cast<std::size_t>(columns * rows), 0);
  const auto place_of = [&](const Keypoint& keypoint) -> std::uint8_t& {
    const int column = std::clamp(static_cast<int>(keypoint.raw_x) / options_.spacing_px, 0, columns - 1);
    const int row = std::clamp(static_cast<int>(keypoint.raw_y) / options_.spacing_px, 0, rows - 1);
    return occupied_[static_cast<std::size_t>(row * columns + column)];
  };
  for (const Track& track : tracks_) {
    place_of(frame_->keypoints()[track.keypoint]) = 1;
  }
  const std::size_t continued = tracks_.size();
  for (std::size_t i = 0; i < ids_.size(); ++i) {
    std::uint8_t& place = place_of(frame_->keypoints()[i]);
    if (place == 0) {
      place = 1;
      ids_[i] = PointId{next_};
      next_ = (next_ + 1) % kMostTracks;
      labels.Set(ids_[i], kUnknownProbability);
      tracks_.push_back({static_cast<std::uint32_t>(i), 0, 0, std::nullopt});
    }
  }
  std::ranges::inplace_merge(tracks_, tracks_.begin() + static_cast<std::ptrdiff_t>(continued), {}, &Track::keypoint);
}

std::vector<double> FeatureTracks::SpreadLabels(std::span<const KeypointLabel> judged,
                                                const MovingProbabilities& labels,
                                                const MovingProbabilityOptions& options) {
  const std::span<const Keypoint> keypoints = frame_->keypoints();
  std::vector<double> result(keypoints.size(), kUnknownProbability);
  surface_.Start(frame_->depth_grid());
  for (const Track& track : tracks_) {
    const double own = labels.Get(ids_[track.keypoint]);
    const PointState state = StateOf(own, options);
    if (state != PointState::kUnknown) {
      result[track.keypoint] = own;
      surface_.Add(keypoints[track.keypoint], {state == PointState::kDynamic, 0});
    } else if (track.inherited) {
      surface_.Add(keypoints[track.keypoint], *track.inherited);
    }
  }
  surface_.AddSamples(judged);
  surface_.Spread();
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    if (result[i] == kUnknownProbability) {
      if (const auto label = surface_.At(keypoints[i])) {
        const double p = kNear + (kFar - kNear) * label->distance_px / surface_.Reach(label->dynamic);
        result[i] = label->dynamic ? p : 1 - p;
      }
    }
  }
  for (Track& track : tracks_) {
    track.inherited = surface_.At(keypoints[track.keypoint]);
  }
  return result;
}

}  // namespace rds
