// SPDX-License-Identifier: Apache-2.0
#include "tracking/tracker.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/time.h"
#include "place/explained_share.h"

namespace rds {
namespace {

constexpr double kSameView_rad = 0.6;  // to an older keyframe: most of the image is in both views

constexpr int kProbation = 3;        // frames after a recovery that must be as firm as it
constexpr double kPriorChi2 = 22.5;  // 6 degrees of freedom: 99.9 %

// Shares of the depth that must agree with a pose which matches alone may have got wrong: one that is found anew, and
// one that keeps under half of the last frame's matches. A person whom no label tells from the room was seen to be the
// same rigid thing, elsewhere, after a jump: 45 to 75 matches, 0.63 to 0.78 of the depth; right poses had 0.84 or more.
constexpr double kLeastFound = 0.85;
constexpr double kLeastKept = 0.8;
constexpr int kLeastJudged = 200;  // samples, else nothing is said

// With a pose that is wrong, wide windows find many matches, of which some agree by chance.
bool IsOutlierDominated(const PoseEstimate& estimate) {
  return 2 * estimate.association.used.size() < estimate.outliers.size();
}

// Found within the reach of a prior that it contradicts, or that few of the matches there agree with.
bool IsDoubtful(const PoseEstimate& estimate) {
  if (!estimate.prior) {
    return false;
  }
  const auto residual = PriorResidual(*estimate.prior, estimate.camera_from_world);
  return residual.dot(estimate.prior->information * residual) > kPriorChi2 ||
         estimate.outliers.size() > estimate.association.used.size();
}

std::vector<std::uint32_t> PointsOf(const std::vector<PointMatch>& matches) {
  std::vector<std::uint32_t> points(matches.size());
  std::ranges::transform(matches, points.begin(), &PointMatch::point);
  return points;
}

}  // namespace

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
  labels_ = {};
  if (labels != nullptr && last_.tracked) {
    LookUp(std::move(labels));
  }
  if (map_ == nullptr) {
    return Start();
  }
  if (map_changed) {
    Rebase();
  }
  return TrackInMap(status);
}

// Predict, find a coarse pose, refine it with the local map, decide.
TrackOutcome Tracker::TrackInMap(const WorkerStatus& status) {
  StageTimes times;
  const FrameContext frame{*current_.data, *map_,  probabilities_, labels_.keypoints ? &*labels_.keypoints : nullptr,
                           options_,       setup_, times};
  ++frames_since_keyframe_;
  if (frames_since_recovery_) {
    ++*frames_since_recovery_;
  }
  const ExpectedPose expected = Predict();
  std::optional<PoseEstimate> coarse = CoarsePose(frame, expected);
  const bool prior_only = !coarse && expected.prior;
  if (prior_only) {  // a blurred picture, say, matches little that was just seen: the map may hold more
    coarse = PoseEstimate{expected.prior->camera_from_world, expected.prior, {}, {}};
  }
  if (!coarse) {
    return Lost(times);
  }
  const bool wide = prior_only || !last_.tracked;
  PoseEstimate estimate = TrackLocalMap(frame, *coarse, wide ? options_.recovery_window_px : options_.local_window_px);
  const bool recovering = !last_.tracked || (frames_since_recovery_ && *frames_since_recovery_ <= kProbation);
  if (!HasEnoughInliers(estimate.association, recovering) || (prior_only && IsOutlierDominated(estimate)) ||
      IsContradicted(estimate)) {
    return Lost(times);
  }
  return Tracked(std::move(estimate), status, times);
}

void Tracker::Relocate(const KnownFrame& frame) {
  if (current_.tracked) {
    return;
  }
  current_ = Frame{};
  current_.id = frame.id;
  current_.timestamp_s = frame.timestamp_s;
  current_.data = frame.data;
  current_.tracked = true;
  current_.reference = frame.reference;
  current_.camera_from_reference = frame.camera_from_reference;
  current_.points = frame.points;
  motion_.Forget();
  started_ = true;
  frames_since_recovery_ = 0;
  map_ = nullptr;  // whatever comes is another one
}

TrackOutcome Tracker::Start() {
  const auto with_depth = std::ranges::count_if(current_.data->keypoints(), &Keypoint::HasDepth);
  started_ = with_depth >= options_.min_start_points;
  TrackOutcome outcome;
  current_.tracked = outcome.tracked = outcome.wants_keyframe = started_;
  return outcome;
}

void Tracker::LookUp(std::shared_ptr<const PropagatedLabels> labels) {
  const Rigid3 expected =
      motion_.Predict(current_.timestamp_s - last_.timestamp_s).value_or(Rigid3{}) * last_.camera_from_world;
  const Rigid3 now_from_labels = expected * labels->camera_from_world.Inverse();
  labels_.static_samples = StaticSamples(*labels, *current_.data, now_from_labels, kExplainedStep);
  labels_.keypoints.emplace(std::move(labels), current_.data, now_from_labels, setup_.surface);
}

void Tracker::Rebase() {
  if (!last_.reference.valid()) {
    const LocalKeyframe* const self = map_->FindByFrame(last_.id);
    Check(self != nullptr, "the frame that started the map is a keyframe of it");
    last_.reference = self->id;
    last_.camera_from_reference = Rigid3{};
  }
  if (const auto reference = map_->CameraFromWorld(last_.reference)) {
    last_.camera_from_world = last_.camera_from_reference * *reference;
  }
  last_.observations = FindObservations(last_.points, *map_);
  uses_.Rebase(map_);
}

ExpectedPose Tracker::Predict() const {
  const double seconds = current_.timestamp_s - last_.timestamp_s;
  const auto current_from_last = motion_.Predict(seconds);
  if (!current_from_last) {
    return {last_.camera_from_world, std::nullopt};
  }
  ExpectedPose expected{*current_from_last * last_.camera_from_world, std::nullopt};
  expected.prior = motion_.Prior(expected.camera_from_world, seconds);
  return expected;
}

std::optional<PoseEstimate> Tracker::CoarsePose(const FrameContext& frame, const ExpectedPose& expected) const {
  if (!last_.tracked) {
    return RecoverPose(frame, last_.camera_from_world);
  }
  auto estimate = TrackLastFrame(frame, *last_.data, last_.observations, expected);
  if (estimate && !IsDoubtful(*estimate)) {
    return estimate;
  }
  // What was expected may be wrong: a camera that turns back or is bumped accelerates more than the prior believes.
  const LocalKeyframe* const reference = map_->Find(last_.reference);
  auto by_appearance =
      TrackKeyframe(frame, reference != nullptr ? *reference : map_->keyframes.back(), last_.camera_from_world);
  // So far from what was expected it must stand as firmly as one that is recovered.
  const bool is_better = by_appearance && (!expected.prior || HasEnoughInliers(by_appearance->association, true)) &&
                         (!estimate || by_appearance->association.used.size() > estimate->association.used.size());
  return is_better ? by_appearance : estimate;
}

PoseEstimate Tracker::TrackLocalMap(const FrameContext& frame, const PoseEstimate& coarse, double window_px) {
  const Stopwatch watch;
  // All points matched so far keep their keypoints, dynamic and unused ones too: a static point must not take those.
  std::vector<PointMatch> matches = coarse.association.used;
  for (const auto* others : {&coarse.association.deferred, &coarse.association.dynamic}) {
    matches.insert(matches.end(), others->begin(), others->end());
  }
  std::vector<std::uint8_t> taken(map_->size(), 0);
  std::vector<std::uint8_t> occupied(current_.data->size(), 0);
  for (const PointMatch& match : matches) {
    taken[match.point] = 1;
    occupied[match.keypoint] = 1;
  }
  const LocalSearch search = SearchLocalMap(frame.data, coarse.camera_from_world, frame.map, setup_.pyramid, taken,
                                            occupied, window_px, options_.local_ratio);
  matches.insert(matches.end(), search.matches.begin(), search.matches.end());
  frame.times.local_map_ms += watch.Milliseconds();
  PoseEstimate estimate = EstimatePose(frame, coarse.camera_from_world, coarse.prior, matches);
  ResolveDeferred(frame, estimate);
  uses_.CountVisible(search.visible);
  for (const auto* found : {&estimate.association.used, &estimate.association.deferred}) {
    for (const PointMatch& match : *found) {
      uses_.CountFound(match.point);
    }
  }
  return estimate;
}

// Static points are known to be what they seem, so fewer of them make a pose.
bool Tracker::HasEnoughInliers(const Association& association, bool recovering) const {
  const auto inliers = static_cast<int>(association.used.size());
  const int enough = recovering ? options_.min_recovery_inliers : options_.min_inliers;
  const int enough_static = recovering ? options_.min_inliers : options_.association.tau;
  return inliers >= enough || association.static_count >= std::max(enough_static, 1);
}

bool Tracker::IsContradicted(const PoseEstimate& estimate) const {
  const std::vector<PointMatch>& used = estimate.association.used;
  if (last_.tracked && 2 * used.size() >= last_.association.used.size()) {
    return false;
  }
  const LocalKeyframe& reference = map_->MostShared(PointsOf(used));
  const Rigid3 reference_from_camera = reference.camera_from_world * estimate.camera_from_world.Inverse();
  // Either way will do: people may stand before the one or before the other.
  std::optional<double> share;
  for (const SurfaceAgreement& way :
       {CompareSurfaces(*current_.data, labels_.static_samples, *reference.data, reference_from_camera, kExplainedStep),
        CompareSurfaces(*reference.data, {}, *current_.data, reference_from_camera.Inverse(), kExplainedStep)}) {
    if (way.Judged() >= kLeastJudged) {
      share = std::max(share.value_or(0), way.Share());
    }
  }
  return share && *share < (last_.tracked ? kLeastKept : kLeastFound);
}

// The last known pose stays the place to search from; the frame itself has none.
TrackOutcome Tracker::Lost(const StageTimes& times) {
  current_.camera_from_world = last_.camera_from_world;
  current_.reference = last_.reference;
  current_.camera_from_reference = last_.camera_from_reference;
  motion_.Forget();
  TrackOutcome outcome;
  outcome.times = times;
  return outcome;
}

TrackOutcome Tracker::Tracked(PoseEstimate estimate, const WorkerStatus& status, const StageTimes& times) {
  current_.tracked = true;
  current_.camera_from_world = estimate.camera_from_world;
  current_.association = std::move(estimate.association);
  if (!last_.tracked) {
    frames_since_recovery_ = 0;
    motion_.Forget();
  } else if (frames_since_recovery_ != 1) {  // a pose found anew is too coarse to take a velocity from
    motion_.Observe(current_.camera_from_world * last_.camera_from_world.Inverse(),
                    current_.timestamp_s - last_.timestamp_s);
  }
  const Association& association = current_.association;
  for (const auto* matches : {&association.used, &association.deferred}) {
    for (const PointMatch& match : *matches) {
      current_.points[match.keypoint] = map_->ids[match.point];
      current_.observations.push_back({match.keypoint, match.point});
    }
  }
  const LocalKeyframe& reference = map_->MostShared(PointsOf(association.used));
  current_.reference = reference.id;
  current_.camera_from_reference = current_.camera_from_world * reference.camera_from_world.Inverse();

  TrackOutcome outcome;
  outcome.tracked = true;
  outcome.camera_from_world = current_.camera_from_world;
  outcome.world = map_->world;
  outcome.epoch = map_->epoch;
  if (last_.tracked) {
    outcome.current_from_last = current_.camera_from_world * last_.camera_from_world.Inverse();
  }
  // What moves may have made an old keyframe the reference, from which the pose is then wrong: what comes later
  // corrects the new ones.
  const LocalKeyframe& newest = map_->keyframes.back();
  outcome.reference = newest.id;
  outcome.camera_from_reference = current_.camera_from_world * newest.camera_from_world.Inverse();
  const LocalKeyframe* const oldest = OldestOfThisView();
  outcome.confidence = oldest != nullptr ? ExplainedBy(*oldest) : std::nullopt;
  outcome.wants_keyframe = WantsKeyframe(Situation(status), options_.policy);
  outcome.used = association.used;
  outcome.rejected = association.dynamic;
  outcome.rejected.insert(outcome.rejected.end(), estimate.outliers.begin(), estimate.outliers.end());
  outcome.times = times;
  return outcome;
}

std::optional<double> Tracker::LeftOfReference() const {
  const LocalKeyframe* const reference = map_ != nullptr ? map_->Find(current_.reference) : nullptr;
  return reference != nullptr && (current_.tracked || last_.tracked)
             ? ExplainedShare(*reference->data, {}, *current_.data, current_.camera_from_reference)
             : std::nullopt;
}

std::optional<double> Tracker::ExplainedBy(const LocalKeyframe& keyframe) const {
  return ExplainedShare(*current_.data, labels_.static_samples, *keyframe.data,
                        keyframe.camera_from_world * current_.camera_from_world.Inverse());
}

// The views of the last keyframes follow the pose wherever it goes; the oldest one of the same view does not.
const LocalKeyframe* Tracker::OldestOfThisView() const {
  const auto found = std::ranges::find_if(map_->keyframes, [&](const LocalKeyframe& keyframe) {
    return AngleOf((keyframe.camera_from_world * current_.camera_from_world.Inverse()).rotation) < kSameView_rad;
  });
  return found == map_->keyframes.end() ? nullptr : &*found;
}

KeyframeSituation Tracker::Situation(const WorkerStatus& status) {
  const Association& association = current_.association;
  KeyframeSituation situation;
  situation.frames_since_keyframe = frames_since_keyframe_;
  situation.frames_since_recovery = frames_since_recovery_.value_or(std::numeric_limits<int>::max());
  situation.mapping_idle = status.mapping_idle;
  situation.segmenter_idle = status.segmenter_idle;
  situation.inliers = static_cast<int>(association.used.size() + association.deferred.size());
  const LocalKeyframe* reference = map_->Find(current_.reference);
  Check(reference != nullptr, "the reference keyframe is in the snapshot");
  std::vector<std::uint8_t> inlier(map_->size(), 0);
  for (const auto* matches : {&association.used, &association.deferred}) {
    for (const PointMatch& match : *matches) {
      inlier[match.point] = 1;
    }
  }
  for (const LocalKeyframe::Link& link : reference->links) {
    const bool dynamic =
        options_.association.use_semantics && probabilities_.State(map_->ids[link.point]) == PointState::kDynamic;
    situation.reference_inliers += !dynamic && inlier[link.point] != 0 ? 1 : 0;
    situation.reference_tracked_points += map_->confirmed[link.point] != 0 && !dynamic ? 1 : 0;
  }
  if (seen_.reference != current_.reference) {
    seen_ = {current_.reference, 0};
  }
  seen_.points = std::max(seen_.points, situation.reference_inliers);
  situation.reference_seen = seen_.points;
  std::vector<std::uint8_t> rejected(current_.data->size(), 0);
  for (const PointMatch& match : association.dynamic) {
    rejected[match.keypoint] = 1;
  }
  for (std::size_t i = 0; i < current_.data->size(); ++i) {
    const Keypoint& keypoint = current_.data->keypoints()[i];
    if (keypoint.HasDepth() && rejected[i] == 0) {
      ++(current_.points[i].valid() ? situation.depth_tracked : situation.depth_untracked);
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
  std::ranges::transform(current_.association.dynamic, std::back_inserter(candidate.blocked), &PointMatch::keypoint);
  for (std::uint32_t i = 0; labels_.keypoints && i < current_.data->size(); ++i) {
    candidate.probabilities.push_back((*labels_.keypoints)[i]);
  }
  candidate.uses = uses_.List();
  return candidate;
}

void Tracker::KeyframeTaken() {
  frames_since_keyframe_ = 0;
  uses_.Clear();
}

}  // namespace rds
