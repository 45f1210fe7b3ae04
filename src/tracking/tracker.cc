// SPDX-License-Identifier: Apache-2.0
#include "tracking/tracker.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/error.h"
#include "base/time.h"
#include "feature/keypoint_observation.h"
#include "tracking/recovery.h"

namespace rds {
Tracker::Tracker(const TrackerOptions& options, TrackerSetup setup, const MovingProbabilities& probabilities)
    : options_(options), setup_(std::move(setup)), probabilities_(probabilities), motion_(options.motion) {
  options_.association.use_semantics &= setup_.semantics;
}

TrackOutcome Tracker::Track(FrameId frame, double timestamp_s, std::shared_ptr<const FrameData> data,
                            std::shared_ptr<const LocalMap> map, const WorkerStatus& status,
                            std::shared_ptr<const PropagatedLabels> labels) {
  const bool map_changed = map != map_;
  map_ = std::move(map);
  if (started_) {
    last_ = std::move(current_);
  }
  current_ = Frame{};
  current_.id = frame;
  current_.timestamp_s = timestamp_s;
  current_.data = std::move(data);
  current_.points.assign(current_.data->size(), PointId{});
  association_ = {};
  outliers_.clear();
  keypoint_probability_ = nullptr;
  static_samples_.clear();
  if (labels != nullptr && last_.tracked) {
    LookUp(std::move(labels));
  }
  TrackOutcome outcome;
  if (map_ == nullptr) {
    outcome = Start(std::move(outcome));
  } else {
    TrackInMap(status, map_changed, &outcome);
  }
  return outcome;
}

void Tracker::LookUp(std::shared_ptr<const PropagatedLabels> labels) {
  const Rigid3 expected =
      motion_.Predict(current_.timestamp_s - last_.timestamp_s).value_or(Rigid3{}) * last_.camera_from_world;
  const Rigid3 now_from_labels = expected * labels->camera_from_world.Inverse();
  if (options_.registration.enabled) {
    static_samples_ = StaticSamples(*labels, *current_.data, now_from_labels, kRegistrationStep);
  }
  keypoint_probability_ = [probabilities = KeypointProbabilities(std::move(labels), current_.data, now_from_labels,
                                                                 setup_.surface)](std::uint32_t keypoint) {
    return probabilities[keypoint];
  };
}

Association Tracker::Select(std::span<const PointMatch> matches) const {
  return SelectMatches(matches, *map_, probabilities_, keypoint_probability_, options_.association);
}

void Tracker::TrackInMap(const WorkerStatus& status, bool map_changed, TrackOutcome* outcome) {
  if (map_changed) {
    Rebase();
  }
  ++frames_since_keyframe_;
  ++frames_since_recovery_;
  current_.camera_from_world = last_.camera_from_world;
  current_.reference = last_.reference;
  recovering_ = !last_.tracked;
  Predict(outcome);
  const std::optional<PosePrior> expected = prior_;
  double window_px = recovering_ ? options_.recovery_window_px : options_.local_window_px;
  const bool coarse_ok = last_.tracked ? TrackLastFrame(outcome) || TrackReferenceKeyframe(outcome) : Recover(outcome);
  const bool prior_only = !coarse_ok && expected;
  if (prior_only) {  // a blurred picture, say, matches little that was just seen: the map may hold more
    RestorePrior(*expected);
    window_px = options_.recovery_window_px;
  }
  current_.tracked =
      (coarse_ok || prior_only) && TrackLocalMap(window_px, outcome) && !(prior_only && IsOutlierDominated());
  if (!current_.tracked) {
    // The last known pose stays the place to search from; the frame itself has none.
    current_.camera_from_world = last_.camera_from_world;
    current_.reference = last_.reference;
    current_.camera_from_reference = last_.camera_from_reference;
    motion_.Forget();
    return;
  }
  if (recovering_) {
    frames_since_recovery_ = 0;
    motion_.Forget();
  } else {
    motion_.Observe(current_.camera_from_world * last_.camera_from_world.Inverse(),
                    current_.timestamp_s - last_.timestamp_s);
  }
  for (const auto* matches : {&association_.used, &association_.deferred}) {
    for (const PointMatch& match : *matches) {
      current_.points[match.keypoint] = map_->ids[match.point];
      current_.observations.push_back({match.keypoint, match.point});
    }
  }
  ChooseReference(outcome);
  outcome->tracked = true;
  outcome->camera_from_world = current_.camera_from_world;
  outcome->wants_keyframe = WantsKeyframe(Situation(status), options_.policy);
  outcome->used = association_.used;
  outcome->rejected = association_.dynamic;
  outcome->rejected.insert(outcome->rejected.end(), outliers_.begin(), outliers_.end());
}

TrackOutcome Tracker::Start(TrackOutcome outcome) {
  const auto with_depth = std::ranges::count_if(current_.data->keypoints(), &Keypoint::HasDepth);
  started_ = with_depth >= options_.min_start_points;
  current_.tracked = outcome.tracked = outcome.wants_keyframe = started_;
  return outcome;
}

// The last frame as the new snapshot has it: the reference keyframe may have been corrected since, points fused.
void Tracker::Rebase() {
  if (!last_.reference.valid()) {
    const LocalKeyframe* const self = map_->FindByFrame(last_.id);
    Check(self != nullptr, "the frame that started the map is a keyframe of it");
    last_.reference = self->id;
    last_.camera_from_reference = Rigid3{};
  }
  if (const LocalKeyframe* reference = map_->Find(last_.reference)) {
    last_.camera_from_world = last_.camera_from_reference * reference->camera_from_world;
  }
  last_.observations = FindObservations(last_.points, *map_);
  uses_.Rebase(map_);
}

// Surfaces say where the camera is without knowing a point; with semantics only static ones do.
void Tracker::Predict(TrackOutcome* outcome) {
  prior_.reset();
  const double seconds = current_.timestamp_s - last_.timestamp_s;
  const auto current_from_last = motion_.Predict(seconds);
  if (!current_from_last) {
    return;
  }
  const Stopwatch watch;
  current_.camera_from_world = *current_from_last * last_.camera_from_world;
  prior_ = motion_.Prior(current_.camera_from_world, seconds);
  const LocalKeyframe* reference = map_->Find(last_.reference);
  if (prior_ && options_.registration.enabled && reference != nullptr &&
      !(options_.association.use_semantics && static_samples_.empty())) {
    prior_ = RegisterDepth(*current_.data, static_samples_, *reference->data, reference->camera_from_world, *prior_,
                           options_.registration);
    current_.camera_from_world = prior_->camera_from_world;
  }
  outcome->pose_ms += watch.Milliseconds();
}

PoseObservation Tracker::Observe(const PointMatch& match) const {
  const Keypoint& keypoint = current_.data->keypoints()[match.keypoint];
  return {map_->Position(match.point), ObservationOf(keypoint, setup_.pyramid, match.weight)};
}

int Tracker::OptimizeFrom(std::span<const PointMatch> matches, TrackOutcome* outcome) {
  const Stopwatch watch;
  association_ = Select(matches);
  OptimizeUsed();
  outcome->pose_ms += watch.Milliseconds();
  return static_cast<int>(association_.used.size());
}

void Tracker::OptimizeUsed() {
  std::vector<PoseObservation> observations;
  observations.reserve(association_.used.size());
  for (const PointMatch& match : association_.used) {
    observations.push_back(Observe(match));
  }
  const PoseResult result = OptimizePose(current_.data->camera(), current_.camera_from_world, observations, setup_.pose,
                                         prior_ ? &*prior_ : nullptr);
  current_.camera_from_world = result.camera_from_world;
  std::vector<PointMatch> inliers;
  inliers.reserve(association_.used.size());
  association_.static_count = 0;
  for (std::size_t i = 0; i < association_.used.size(); ++i) {
    if (result.inlier[i] != 0) {
      inliers.push_back(association_.used[i]);
      association_.static_count += inliers.back().state == PointState::kStatic ? 1 : 0;
    } else {
      outliers_.push_back(association_.used[i]);
    }
  }
  association_.used = std::move(inliers);
}

bool Tracker::TrackLastFrame(TrackOutcome* outcome) {
  Stopwatch watch;
  const auto search = [&](double window_px) {
    return SearchLastFrame(*last_.data, last_.observations, *current_.data, current_.camera_from_world, *map_,
                           setup_.pyramid, window_px);
  };
  const double most_px = options_.motion_window_px;
  std::vector<PointMatch> matches =
      search(prior_ ? std::min(most_px, SearchRadius(*prior_, current_.data->camera().fx)) : most_px);
  if (std::ssize(matches) < options_.min_motion_matches) {
    matches = search(2 * most_px);
  }
  outcome->matching_ms += watch.Milliseconds();
  return std::ssize(matches) >= options_.min_motion_matches &&
         OptimizeFrom(matches, outcome) >= options_.min_motion_inliers;
}

bool Tracker::TrackReferenceKeyframe(TrackOutcome* outcome) {
  const LocalKeyframe* reference = map_->Find(last_.reference);
  if (reference == nullptr) {
    reference = &map_->keyframes.back();
  }
  Stopwatch watch;
  outliers_.clear();
  prior_.reset();  // what was expected may be wrong
  current_.camera_from_world = last_.camera_from_world;
  std::vector<PointMatch> matches = MatchKeyframe(*reference, *current_.data, options_.reference_ratio);
  outcome->matching_ms += watch.Milliseconds();
  return std::ssize(matches) >= options_.min_reference_matches &&
         OptimizeFrom(matches, outcome) >= options_.min_motion_inliers;
}

bool Tracker::Recover(TrackOutcome* outcome) {
  Stopwatch watch;
  const Eigen::Vector3d last_center = last_.camera_from_world.Inverse().translation;
  for (const LocalKeyframe* keyframe : NearestKeyframes(*map_, last_center, options_.recovery_keyframes)) {
    outliers_.clear();
    std::vector<PointMatch> matches = MatchKeyframe(*keyframe, *current_.data, options_.reference_ratio);
    const Association selected = Select(matches);
    if (std::ssize(selected.used) < options_.min_reference_matches) {
      continue;
    }
    const auto pose = RansacPose(*current_.data, selected.used, *map_, setup_.pyramid, options_.min_motion_inliers);
    current_.camera_from_world = pose ? *pose : keyframe->camera_from_world;
    if (OptimizeFrom(matches, outcome) >= options_.min_motion_inliers) {
      outcome->matching_ms += watch.Milliseconds();
      return true;
    }
  }
  outcome->matching_ms += watch.Milliseconds();
  return false;
}

// Back to the pose that was expected before anything was matched.
void Tracker::RestorePrior(const PosePrior& expected) {
  prior_ = expected;
  current_.camera_from_world = expected.camera_from_world;
  association_ = {};
  outliers_.clear();
}

bool Tracker::TrackLocalMap(double window_px, TrackOutcome* outcome) {
  Stopwatch watch;
  // All points matched so far keep their keypoints, dynamic and unused ones too: a static point must not take those.
  std::vector<PointMatch> matches = association_.used;
  matches.insert(matches.end(), association_.deferred.begin(), association_.deferred.end());
  matches.insert(matches.end(), association_.dynamic.begin(), association_.dynamic.end());
  std::vector<std::uint8_t> taken(map_->size(), 0);
  std::vector<std::uint8_t> occupied(current_.data->size(), 0);
  for (const PointMatch& match : matches) {
    taken[match.point] = 1;
    occupied[match.keypoint] = 1;
  }
  const LocalSearch search = SearchLocalMap(*current_.data, current_.camera_from_world, *map_, setup_.pyramid, taken,
                                            occupied, window_px, options_.local_ratio);
  matches.insert(matches.end(), search.matches.begin(), search.matches.end());
  outliers_.clear();
  outcome->local_map_ms += watch.Milliseconds();
  OptimizeFrom(matches, outcome);
  ResolveUnknown(outcome);
  CountUse(search);
  return HasEnoughInliers();
}

bool Tracker::Agrees(const PointMatch& match) const {
  const PoseObservation observation = Observe(match);
  Eigen::Vector3d residual_px;
  Eigen::Matrix<double, 3, 6> jacobian;
  const double bound = observation.keypoint.HasDepth() ? kChi2Depth : kChi2Mono;
  return PoseResidual(current_.data->camera(), current_.camera_from_world, observation, &residual_px, &jacobian) &&
         residual_px.squaredNorm() * observation.keypoint.inverse_sigma2 < bound;
}

void Tracker::ResolveUnknown(TrackOutcome* outcome) {
  const Stopwatch watch;
  std::vector<PointMatch> agreeing;
  for (const PointMatch& match : association_.deferred) {
    (Agrees(match) ? agreeing : outliers_).push_back(match);
  }
  association_.deferred.clear();
  if (options_.association.unknown == UnknownPoints::kDeferred &&
      association_.static_count < options_.association.min_static_inliers && !agreeing.empty()) {
    // Together they may weigh as much as the static ones, not more.
    double static_weight2 = 0;
    double unknown_weight2 = 0;
    for (const PointMatch& match : association_.used) {
      static_weight2 += match.weight * match.weight;
    }
    for (const PointMatch& match : agreeing) {
      unknown_weight2 += match.weight * match.weight;
    }
    const double share = std::min(1.0, std::sqrt(static_weight2 / unknown_weight2));
    for (PointMatch match : agreeing) {
      match.weight *= share;
      association_.used.push_back(match);
    }
    OptimizeUsed();
  } else {
    association_.deferred = std::move(agreeing);
  }
  outcome->pose_ms += watch.Milliseconds();
}

// Static points are known to be what they seem, so fewer of them make a pose.
bool Tracker::HasEnoughInliers() const {
  const auto inliers = static_cast<int>(association_.used.size());
  const int enough = recovering_ ? options_.min_recovery_inliers : options_.min_inliers;
  const int enough_static = recovering_ ? options_.min_inliers : options_.association.tau;
  return inliers >= enough || association_.static_count >= std::max(enough_static, 1);
}

// With a pose that is wrong, wide windows find many matches, of which some agree by chance.
bool Tracker::IsOutlierDominated() const { return 2 * association_.used.size() < outliers_.size(); }

void Tracker::CountUse(const LocalSearch& search) {
  uses_.CountVisible(search.visible);
  for (const auto* matches : {&association_.used, &association_.deferred}) {
    for (const PointMatch& match : *matches) {
      uses_.CountFound(match.point);
    }
  }
}

void Tracker::ChooseReference(TrackOutcome* outcome) {
  std::vector<std::uint32_t> seen;
  seen.reserve(association_.used.size());
  std::ranges::transform(association_.used, std::back_inserter(seen), &PointMatch::point);
  const LocalKeyframe& best = map_->MostShared(seen);
  current_.reference = best.id;
  current_.camera_from_reference = current_.camera_from_world * best.camera_from_world.Inverse();
  outcome->reference = current_.reference;
  outcome->camera_from_reference = current_.camera_from_reference;
}

KeyframeSituation Tracker::Situation(const WorkerStatus& status) const {
  KeyframeSituation situation;
  situation.frames_since_keyframe = frames_since_keyframe_;
  situation.frames_since_recovery = frames_since_recovery_;
  situation.mapping_idle = status.mapping_idle;
  situation.segmenter_idle = status.segmenter_idle;
  situation.inliers = static_cast<int>(association_.used.size() + association_.deferred.size());
  const LocalKeyframe* reference = map_->Find(current_.reference);
  Check(reference != nullptr, "the reference keyframe is in the snapshot");
  const AssociationOptions& association = options_.association;
  for (const LocalKeyframe::Link& link : reference->links) {
    const bool dynamic =
        association.use_semantics && probabilities_.State(map_->ids[link.point]) == PointState::kDynamic;
    situation.reference_tracked_points += map_->confirmed[link.point] != 0 && !dynamic ? 1 : 0;
  }
  const double close_m = setup_.depth_threshold * current_.data->camera().baseline_m;
  std::vector<std::uint8_t> rejected(current_.data->size(), 0);
  for (const PointMatch& match : association_.dynamic) {
    rejected[match.keypoint] = 1;
  }
  for (std::size_t i = 0; i < current_.data->size(); ++i) {
    const Keypoint& keypoint = current_.data->keypoints()[i];
    if (keypoint.HasDepth() && static_cast<double>(keypoint.depth_m) < close_m && rejected[i] == 0) {
      ++(current_.points[i].valid() ? situation.close_tracked : situation.close_untracked);
    }
  }
  return situation;
}

KeyframeCandidate Tracker::MakeCandidate() {
  KeyframeCandidate candidate;
  candidate.frame = current_.id;
  candidate.timestamp_s = current_.timestamp_s;
  candidate.data = current_.data;
  candidate.reference = current_.reference;
  candidate.camera_from_reference = current_.camera_from_reference;
  candidate.points = current_.points;
  std::ranges::transform(association_.dynamic, std::back_inserter(candidate.blocked), &PointMatch::keypoint);
  for (std::uint32_t i = 0; keypoint_probability_ && i < current_.data->size(); ++i) {
    candidate.probabilities.push_back(keypoint_probability_(i));
  }
  candidate.uses = uses_.List();
  return candidate;
}

void Tracker::KeyframeTaken() {
  frames_since_keyframe_ = 0;
  uses_.Clear();
}

}  // namespace rds
