// SPDX-License-Identifier: Apache-2.0
// All threading on one page: the caller's thread tracks, one worker maps, one labels. In lockstep the caller does all.
#include "system/slam.h"

#include <algorithm>
#include <exception>
#include <optional>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/log.h"
#include "base/time.h"
#include "feature/orb.h"
#include "geometry/distortion.h"
#include "runtime/worker.h"
#include "system/frame_report.h"
#include "system/lanes.h"
#include "system/pipeline.h"
#include "system/propagation_lane.h"
#include "tracking/tracker.h"

namespace rds {
namespace {

constexpr std::uint32_t kStartKeyframes = 4;  // frames from one to the next among those tracked again
constexpr int kWeakStart = 30;                // matches below which the first keyframe does not do any more

// Before anything is built from them.
const PinholeCamera& Checked(const PinholeCamera& camera) {
  if (const auto problem = camera.HasDistortion() ? DistortionProblem(camera) : std::nullopt) {
    throw InputError("camera: " + *problem);
  }
  return camera;
}
const Options& Checked(const Options& options) {
  ValidateOptions(options);
  return options;
}

}  // namespace

class Slam::Impl {
 public:
  Impl(const PinholeCamera& camera, const Options& options, std::shared_ptr<Segmenter> segmenter);
  ~Impl();

  FrameResult Process(const RgbdFrame& frame);
  FrameResult TrackFrame(const RgbdFrame& frame);
  SlamResult Finish();
  [[nodiscard]] const Pipeline& pipeline() const { return shared_->pipeline; }

 private:
  struct TrajectoryEntry {
    double timestamp_s = 0;
    KeyframeId reference;  // invalid: the very first frame, which is the very first keyframe
    Rigid3 camera_from_reference;
  };
  struct StartFrame {
    FrameId frame;
    double timestamp_s = 0;
    std::shared_ptr<const FrameData> data;
    std::shared_ptr<const Image8> image;
  };
  struct DueRound {
    std::uint32_t due_frame = 0;
    LabeledRound round;
  };

  [[nodiscard]] WorkerStatus Status() const;
  [[nodiscard]] std::unique_ptr<Tracker> MakeTracker() const;
  void StartFollowing();
  void Follow(FrameId frame, std::shared_ptr<const FrameData> data, const TrackOutcome& outcome);
  void TrackStartAgain();
  void KeepStart(const FrameResult& result, std::shared_ptr<const FrameData> data, const RgbdFrame& frame);
  void AddEntry(double timestamp_s, const TrackOutcome& outcome);
  bool OfferKeyframe(double timestamp_s, std::shared_ptr<const Image8> image, bool at_once);
  void StepSemantics(FrameId frame);
  void StopSemantics(bool wait_for_labels);

  PinholeCamera camera_;
  Options options_;
  OrbExtractor extractor_;
  std::shared_ptr<Shared> shared_;
  std::unique_ptr<Tracker> tracker_;
  std::optional<PropagationLane> follower_;  // none if nothing asks for labels
  std::vector<TrajectoryEntry> entries_;
  std::vector<StartFrame> start_;  // frames before the first label, to be tracked again with it
  bool starting_ = false;
  std::uint32_t next_frame_ = 0;
  std::uint32_t processed_ = 0;
  std::optional<double> last_timestamp_s_;
  bool tracked_before_ = false;
  bool finished_ = false;
  int lost_ = 0;
  std::optional<DueRound> due_;  // lockstep: the round in flight
  std::unique_ptr<Worker> mapping_;
  std::unique_ptr<Worker> semantics_;
};

Slam::Impl::Impl(const PinholeCamera& camera, const Options& options, std::shared_ptr<Segmenter> segmenter)
    : camera_(camera),
      options_(options),
      extractor_(options.orb),
      shared_(std::make_shared<Shared>(options, extractor_.pyramid(), std::move(segmenter))),
      tracker_(MakeTracker()) {
  starting_ = shared_->pipeline.HasSegmenter() && options.tracking.association.use_semantics &&
              options.semantic.start_frames > 0;
  StartFollowing();
  if (!options_.system.lockstep) {
    try {
      mapping_ = std::make_unique<Worker>(Lane(shared_, RunMapping));
      if (shared_->pipeline.HasSegmenter()) {
        semantics_ = std::make_unique<Worker>(
            Lane(shared_, [semantic = options_.semantic](Shared& shared) { RunSemantics(shared, semantic); }));
      }
    } catch (...) {
      shared_->keyframes.Close();  // the one that runs is joined
      throw;
    }
  }
}

std::unique_ptr<Tracker> Slam::Impl::MakeTracker() const {
  TrackerOptions tracking = options_.tracking;
  tracking.association.probability = options_.semantic.probability;
  tracking.association.use_semantics &= shared_->pipeline.HasSegmenter();
  tracking.surface = options_.propagation.surface;
  return std::make_unique<Tracker>(tracking, options_.pose, extractor_.pyramid(), shared_->pipeline.probabilities());
}

void Slam::Impl::StartFollowing() {
  if (shared_->pipeline.HasSegmenter() && options_.tracking.association.use_semantics && options_.propagation.enabled) {
    follower_.emplace(options_.propagation, options_.semantic.free_space, options_.system.lockstep,
                      [shared = shared_](std::exception_ptr error) { shared->Fail(std::move(error)); });
  }
}

void Slam::Impl::Follow(FrameId frame, std::shared_ptr<const FrameData> data, const TrackOutcome& outcome) {
  if (follower_ && outcome.tracked) {
    follower_->Offer({frame, std::move(data), outcome.camera_from_world, shared_->pipeline.LabeledViews()});
  }
}

// Before the first label nobody can tell what moves, and poses may follow people who fill the picture. So until then
// the first keyframe stays the only one, and once it is labeled a new tracker goes through all frames since, with
// keyframes where it wants them: of the first one's static points few may be left by then.
void Slam::Impl::TrackStartAgain() {
  tracker_ = MakeTracker();
  entries_.clear();
  lost_ = 0;
  tracked_before_ = false;
  StartFollowing();
  std::shared_ptr<const LocalMap> map;  // none for the first frame: it is the first keyframe
  FrameId keyframe = start_.front().frame;
  for (StartFrame& frame : start_) {
    const TrackOutcome outcome = tracker_->Track(frame.frame, frame.timestamp_s, frame.data, map, Status(), nullptr);
    AddEntry(frame.timestamp_s, outcome);
    Follow(frame.frame, std::move(frame.data), outcome);
    if (outcome.wants_keyframe && frame.frame.value - keyframe.value >= kStartKeyframes) {
      OfferKeyframe(frame.timestamp_s, std::move(frame.image), true);
      keyframe = frame.frame;
    }
    map = shared_->pipeline.CurrentLocalMap();
  }
  start_.clear();
}

void Slam::Impl::KeepStart(const FrameResult& result, std::shared_ptr<const FrameData> data, const RgbdFrame& frame) {
  start_.push_back({result.frame, result.timestamp_s, std::move(data), frame.image});
  // Came while this frame was tracked: all frames are tracked again before the next one.
  const bool labeled = shared_->pipeline.newest_labeled() >= 0;
  // A lost frame is none: the map cannot grow by it, and it may be the label that took its points away.
  const bool weak = start_.size() > 1 && result.state == TrackingState::kTracked &&
                    result.static_matches + result.unknown_matches < kWeakStart;
  starting_ = labeled || (!weak && std::ssize(start_) < options_.semantic.start_frames);
  if (!starting_) {  // the map must grow, labeled or not
    start_.clear();
  }
}

void Slam::Impl::AddEntry(double timestamp_s, const TrackOutcome& outcome) {
  if (outcome.tracked) {
    tracked_before_ = true;
    entries_.push_back({timestamp_s, outcome.reference, outcome.camera_from_reference});
  }
  lost_ += tracked_before_ && !outcome.tracked ? 1 : 0;
}

Slam::Impl::~Impl() {
  shared_->keyframes.Close();
  StopSemantics(false);
}

WorkerStatus Slam::Impl::Status() const {
  WorkerStatus status;
  status.mapping_idle = options_.system.lockstep || (!shared_->mapping && shared_->keyframes.Size() == 0);
  status.segmenter_idle = shared_->pipeline.HasSegmenter() && shared_->waiting.Read([&](const Waiting& waiting) {
    return waiting.backlog.empty() && !waiting.in_flight;
  }) && !due_;
  return status;
}

FrameResult Slam::Impl::Process(const RgbdFrame& frame) {
  const Stopwatch watch;
  const double cpu_start = ThreadCpuSeconds();
  Check(!finished_, "no Process after Finish");
  CheckFrame(frame, camera_, last_timestamp_s_);
  shared_->failure.ThrowIfHappened();
  last_timestamp_s_ = frame.timestamp_s;
  try {
    FrameResult result = TrackFrame(frame);
    result.timing.cpu_ms = 1e3 * (ThreadCpuSeconds() - cpu_start);
    result.timing.total_ms = watch.Milliseconds();
    return result;
  } catch (...) {
    shared_->Fail(std::current_exception());
    throw;
  }
}

FrameResult Slam::Impl::TrackFrame(const RgbdFrame& frame) {
  const Stopwatch watch;
  FrameResult result;
  result.frame = FrameId{next_frame_++};
  processed_ = next_frame_;
  result.timestamp_s = frame.timestamp_s;
  shared_->pipeline.SetCurrentFrame(result.frame);
  if (options_.system.lockstep) {
    StepSemantics(result.frame);
  }
  if (starting_ && shared_->pipeline.newest_labeled() >= 0) {
    starting_ = false;
    TrackStartAgain();
  }
  const std::shared_ptr<const PropagatedLabels> labels = follower_ ? follower_->Newest(result.frame) : nullptr;
  auto data = std::make_shared<const FrameData>(extractor_.Extract(
      camera_, *frame.image, *frame.depth, labels ? std::span(labels->motion) : std::span<const SampleMotion>()));
  result.timing.extraction_ms = watch.Milliseconds();
  const TrackOutcome outcome =
      tracker_->Track(result.frame, frame.timestamp_s, data, shared_->pipeline.CurrentLocalMap(), Status(), labels);
  AddEntry(frame.timestamp_s, outcome);
  const bool hold = starting_ && !start_.empty();
  result.is_keyframe = outcome.wants_keyframe && !hold && OfferKeyframe(frame.timestamp_s, frame.image, false);
  result.state = outcome.tracked   ? TrackingState::kTracked
                 : tracked_before_ ? TrackingState::kLost
                                   : TrackingState::kNotInitialized;
  FillFrameResult(outcome, *data, shared_->pipeline, options_.system.keep_features, &result);
  Follow(result.frame, data, outcome);
  if (starting_ && tracked_before_) {
    KeepStart(result, std::move(data), frame);
  }
  return result;
}

bool Slam::Impl::OfferKeyframe(double timestamp_s, std::shared_ptr<const Image8> image, bool at_once) {
  KeyframeCandidate candidate = tracker_->MakeCandidate();
  BacklogItem item{candidate.frame, timestamp_s, std::move(image), candidate.data, false};
  at_once |= options_.system.lockstep || !candidate.reference.valid();
  for (const auto* worker : {&mapping_, &semantics_}) {
    if (*worker) {
      (*worker)->LeaveCallersCore();
    }
  }
  if (at_once) {
    // The first keyframe is the map: the second frame must find it there. So must frames that are tracked again.
    shared_->pipeline.MapKeyframe(candidate, [] { return false; });
  } else if (options_.system.wait_for_mapping ? !shared_->keyframes.Push(std::move(candidate))
                                              : !shared_->keyframes.TryPush(std::move(candidate))) {
    return false;
  }
  tracker_->KeyframeTaken();
  if (shared_->pipeline.HasSegmenter()) {
    shared_->waiting.Write([&](Waiting& waiting) { waiting.dropped += waiting.backlog.Push(std::move(item)); });
  }
  return true;
}

// Lockstep: labels arrive a set number of frames after their request, and the next request follows at once.
void Slam::Impl::StepSemantics(FrameId frame) {
  if (due_ && due_->due_frame <= frame.value) {
    shared_->pipeline.ApplyRound(due_->round);
    due_.reset();
  }
  if (!due_ && shared_->pipeline.HasSegmenter()) {
    auto selected = shared_->waiting.Write([&](Waiting& waiting) {
      return waiting.backlog.Select(options_.semantic.selection, static_cast<std::size_t>(options_.semantic.per_round));
    });
    if (!selected.empty()) {
      const std::uint32_t asked = selected.back().frame.value;
      due_ = DueRound{
          std::max(asked, frame.value - 1) + static_cast<std::uint32_t>(options_.semantic.lockstep_delay_frames) + 1,
          shared_->pipeline.Segment(std::move(selected))};
    }
  }
}

void Slam::Impl::StopSemantics(bool wait_for_labels) {
  if (!semantics_) {
    return;
  }
  if (wait_for_labels) {
    const bool done = shared_->waiting.WaitFor(options_.semantic.finish_timeout_s, [](const Waiting& waiting) {
      return waiting.backlog.empty() && !waiting.in_flight;
    });
    if (!done) {
      log::warn("labels still missing after {} s are given up", options_.semantic.finish_timeout_s);
    }
  }
  shared_->waiting.Write([](Waiting& waiting) { waiting.closing = true; });
  shared_->pipeline.CancelSegmenter();
  if (semantics_->WaitFor(options_.semantic.cancel_timeout_s)) {
    semantics_->Join();
  } else {
    log::warn("the segmentation back end does not answer; its thread is left behind");
    semantics_->Abandon();
  }
  semantics_.reset();
}

SlamResult Slam::Impl::Finish() {
  Check(!finished_, "Finish is called once");
  finished_ = true;
  shared_->keyframes.Close();
  if (mapping_) {
    mapping_->Join();
  }
  StopSemantics(!shared_->failure.Happened());
  while (options_.system.lockstep && !shared_->failure.Happened() && shared_->pipeline.HasSegmenter() &&
         (due_ || !shared_->waiting.Read([](const Waiting& waiting) { return waiting.backlog.empty(); }))) {
    try {
      StepSemantics(FrameId{next_frame_ += 1000});
    } catch (...) {
      shared_->Fail(std::current_exception());
    }
  }
  follower_.reset();
  SlamResult result;
  result.error = shared_->failure.Get();
  const bool any_keyframe = shared_->pipeline.CurrentLocalMap() != nullptr;
  Check(any_keyframe || entries_.empty() || result.error != nullptr, "a tracked frame has a keyframe");
  for (const TrajectoryEntry& entry : any_keyframe ? entries_ : std::vector<TrajectoryEntry>()) {
    const KeyframeId reference = entry.reference.valid() ? entry.reference : KeyframeId{0};
    const Rigid3 camera_from_world = entry.camera_from_reference * shared_->pipeline.CameraFromWorld(reference);
    result.frames.push_back({entry.timestamp_s, camera_from_world.Inverse()});
  }
  shared_->pipeline.FillResult(&result);
  result.processed_frames = static_cast<int>(processed_);
  result.tracked_frames = static_cast<int>(result.frames.size());
  result.lost_frames = lost_;
  result.keyframes_left_unlabeled = shared_->waiting.Read(
      [](const Waiting& waiting) { return waiting.dropped + static_cast<int>(waiting.backlog.size()); });
  return result;
}

Slam::Slam(const PinholeCamera& camera, const Options& options, std::unique_ptr<Segmenter> segmenter)
    : impl_(std::make_unique<Impl>(Checked(camera), Checked(options),
                                   std::shared_ptr<Segmenter>(std::move(segmenter)))) {}

Slam::~Slam() = default;

FrameResult Slam::Process(const RgbdFrame& frame) { return impl_->Process(frame); }

SlamResult Slam::Finish() { return impl_->Finish(); }

std::shared_ptr<const MapView> Slam::ViewMap() const { return impl_->pipeline().ViewMap(); }

MaskView Slam::ViewMask() const { return impl_->pipeline().ViewMask(); }

}  // namespace rds
