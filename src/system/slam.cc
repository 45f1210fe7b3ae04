// SPDX-License-Identifier: Apache-2.0
#include "system/slam.h"

#include <exception>
#include <optional>
#include <span>
#include <utility>

#include "base/error.h"
#include "base/time.h"
#include "feature/orb.h"
#include "geometry/distortion.h"
#include "runtime/lock_times.h"
#include "system/confidence_watch.h"
#include "system/executor.h"
#include "system/front_end.h"
#include "system/lanes.h"
#include "system/reports.h"
#include "system/startup.h"

namespace rds {
namespace {

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
  Impl(const PinholeCamera& camera, const Options& options, std::shared_ptr<Segmenter> segmenter)
      : camera_(Checked(camera)),
        options_(Checked(options)),
        extractor_(options.orb),
        lanes_(std::make_shared<Lanes>(options, extractor_.pyramid(), std::move(segmenter))),
        executor_(MakeExecutor(options, lanes_)),
        front_end_(options, extractor_.pyramid(), *lanes_, *executor_),
        startup_(lanes_->semantics.HasSegmenter() && options.tracking.association.use_semantics
                     ? options.semantic.start_frames
                     : 0,
                 options_.semantic.motion, options.atlas.patience_s) {}

  FrameResult Process(const RgbdFrame& frame);
  SlamResult Finish();
  [[nodiscard]] Lanes& lanes() { return *lanes_; }

 private:
  FrameResult TrackFrame(const RgbdFrame& frame);

  PinholeCamera camera_;
  Options options_;
  OrbExtractor extractor_;
  std::shared_ptr<Lanes> lanes_;
  std::unique_ptr<Executor> executor_;
  FrontEnd front_end_;
  Startup startup_;
  ConfidenceWatch confidence_;
  Rigid3 odometry_from_camera_;
  std::uint32_t frames_ = 0;
  std::optional<double> last_timestamp_s_;
  bool finished_ = false;
};

FrameResult Slam::Impl::Process(const RgbdFrame& frame) {
  const Stopwatch watch;
  const double cpu_start = ThreadCpuSeconds();
  const TrackingScope tracking;
  Check(!finished_, "no Process after Finish");
  CheckFrame(frame, camera_, last_timestamp_s_);
  lanes_->failure.ThrowIfHappened();
  last_timestamp_s_ = frame.timestamp_s;
  try {
    FrameResult result = TrackFrame(frame);
    result.timing.cpu_ms = 1e3 * (ThreadCpuSeconds() - cpu_start);
    result.timing.total_ms = watch.Milliseconds();
    return result;
  } catch (...) {
    lanes_->failure.Set(std::current_exception());
    throw;
  }
}

// Where a frame goes: extract, track, offer, remember.
FrameResult Slam::Impl::TrackFrame(const RgbdFrame& frame) {
  const Stopwatch watch;
  FrameResult result;
  result.frame = FrameId{frames_++};
  result.timestamp_s = frame.timestamp_s;
  lanes_->semantics.SetCurrentFrame(result.frame);
  lanes_->loops.SetCurrentFrame(result.frame, frame.timestamp_s);
  executor_->BeginFrame(result.frame);
  const bool found = !startup_.WillTrackAgain(front_end_) && front_end_.GoOnWhereFound();
  if (!found) {
    startup_.TrackAgainIfLabeled(front_end_);
  }

  const std::shared_ptr<const PropagatedLabels> labels = executor_->NewestLabels(result.frame);
  const std::span<const SampleMotion> motion = labels ? std::span(labels->motion) : std::span<const SampleMotion>();
  const IncomingFrame incoming{result.frame, frame.timestamp_s,
                               std::make_shared<const FrameData>(extractor_.Extract(camera_, *frame.image, *frame.depth,
                                                                                    motion, front_end_.Velocity())),
                               frame.image};
  lanes_->semantics.Remember({incoming.id, incoming.timestamp_s, incoming.data});
  result.timing.extraction_ms = watch.Milliseconds();

  TrackOutcome outcome = front_end_.Track(incoming, front_end_.CurrentLocalMap(), labels);
  if (outcome.current_from_last) {  // here, where each frame comes once: some are tracked again
    odometry_from_camera_ = odometry_from_camera_ * outcome.current_from_last->Inverse();
  }
  if (found && outcome.tracked) {
    startup_.GoOnElsewhere();
  }
  result.is_keyframe = startup_.BeginAnewIfLost(incoming, front_end_, outcome) ||
                       (outcome.wants_keyframe && !startup_.HoldsKeyframes() && front_end_.OfferKeyframe(incoming));
  if (!outcome.tracked && !front_end_.trajectory().empty()) {
    front_end_.AskForPlace(incoming);
  }
  if (!startup_.HoldsKeyframes()) {  // else poses may follow what moves, and space that they empty is not empty
    front_end_.Propagate(incoming, outcome);
  }
  startup_.Keep(incoming, outcome, front_end_);

  result.state = outcome.tracked                   ? TrackingState::kTracked
                 : front_end_.trajectory().empty() ? TrackingState::kNotInitialized
                                                   : TrackingState::kLost;
  confidence_.Add(outcome.confidence, lanes_->semantics.HasSegmenter());
  FillFrameResult(outcome, *incoming.data, *lanes_, options_.system.keep_features, &result);
  if (outcome.tracked) {
    result.odometry_from_camera = odometry_from_camera_;
  }
  return result;
}

SlamResult Slam::Impl::Finish() {
  Check(!finished_, "Finish is called once");
  finished_ = true;
  if (!lanes_->failure.Get()) {
    startup_.End(front_end_);
  }
  executor_->Finish();
  if (!lanes_->failure.Get()) {
    try {
      front_end_.FindLost();
    } catch (...) {  // what was tracked is given all the same
      lanes_->failure.Set(std::current_exception());
    }
  }
  SlamResult result;
  result.error = lanes_->failure.Get();
  result.worlds = lanes_->backend.Read([&](const Map& map) { return front_end_.trajectory().Resolve(map); });
  result.processed_frames = static_cast<int>(frames_);
  result.lost_frames = front_end_.trajectory().lost();
  result.found_frames = front_end_.trajectory().found();
  FillSlamResult(*lanes_, &result);
  return result;
}

Slam::Slam(const PinholeCamera& camera, const Options& options, std::unique_ptr<Segmenter> segmenter)
    : impl_(std::make_unique<Impl>(camera, options, std::shared_ptr<Segmenter>(std::move(segmenter)))) {}

Slam::~Slam() = default;

FrameResult Slam::Process(const RgbdFrame& frame) { return impl_->Process(frame); }

SlamResult Slam::Finish() { return impl_->Finish(); }

std::shared_ptr<const MapView> Slam::ViewMap() const { return impl_->lanes().backend.CurrentView(); }

std::vector<std::string> Slam::ValidateMap() const {
  return impl_->lanes().backend.Read([](const Map& map) { return map.Validate(); });
}

std::vector<SlamEvent> Slam::TakeEvents() { return impl_->lanes().loops.TakeEvents(); }

MaskView Slam::ViewMask() const { return impl_->lanes().semantics.NewestMask(); }

}  // namespace rds
