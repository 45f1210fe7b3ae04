// SPDX-License-Identifier: Apache-2.0
#include "system/threaded_executor.h"

#include <atomic>
#include <exception>
#include <functional>
#include <utility>
#include <vector>

#include "base/log.h"

namespace rds {
namespace {

constexpr std::size_t kMostTracked = 64;  // frames that may wait for propagation

}  // namespace

struct ThreadedExecutor::Shared {
  Shared(std::shared_ptr<Lanes> all, std::size_t capacity) : lanes(std::move(all)), keyframes(capacity) {}

  std::shared_ptr<Lanes> lanes;
  BoundedQueue<KeyframeCandidate> keyframes;
  std::atomic<int> to_map = 0;  // keyframes that wait for mapping or are being mapped

  // Ends the run: nobody waits for anything any more.
  void Fail(std::exception_ptr error) {
    lanes->failure.Set(std::move(error));
    keyframes.Close();
    lanes->waiting.Write([](Waiting& waiting) { waiting.closing = true; });
    lanes->places.Write([](PlaceWork& work) { work.closing = true; });
  }

  // What a thread runs: an error ends the run instead of the thread alone.
  template <typename Function>
  static std::function<void()> Lane(std::shared_ptr<Shared> shared, Function run) {
    return [shared = std::move(shared), run = std::move(run)] {
      try {
        run(*shared);
      } catch (...) {
        shared->Fail(std::current_exception());
      }
    };
  }
};

struct ThreadedExecutor::Propagation {
  Propagation(const Options& options, std::shared_ptr<Shared> shared)
      : lane(options.propagation, options.semantic.free_space),
        worker(Shared::Lane(std::move(shared), [this](Shared& /*shared*/) {
          while (const auto frame = frames.Pop()) {
            lane.Propagate(*frame);
          }
        })) {}
  ~Propagation() { frames.Close(); }

  PropagationLane lane;
  BoundedQueue<TrackedFrame> frames{kMostTracked};
  Worker worker;
};

ThreadedExecutor::ThreadedExecutor(const Options& options, std::shared_ptr<Lanes> lanes)
    : options_(options),
      shared_(std::make_shared<Shared>(std::move(lanes), static_cast<std::size_t>(options.system.keyframe_queue))) {
  try {
    RestartPropagation();
    mapping_.emplace(Shared::Lane(shared_, RunMapping));
    if (shared_->lanes->semantics.HasSegmenter()) {
      semantics_.emplace(
          Shared::Lane(shared_, [semantic = options_.semantic](Shared& shared) { RunSemantics(shared, semantic); }));
    }
    if (shared_->lanes->finds_places) {
      loops_.emplace(Shared::Lane(shared_, RunLoops));
      if (options_.loop.bundle) {
        bundles_.emplace(Shared::Lane(shared_, RunBundles));
      }
    }
  } catch (...) {
    shared_->keyframes.Close();  // those that run are joined
    shared_->lanes->waiting.Write([](Waiting& waiting) { waiting.closing = true; });
    shared_->lanes->places.Write([](PlaceWork& work) { work.closing = true; });
    throw;
  }
}

ThreadedExecutor::~ThreadedExecutor() {
  shared_->keyframes.Close();
  StopSemantics(false);
  StopLoops(false);
}

void ThreadedExecutor::RunMapping(Shared& shared) {
  while (auto candidate = shared.keyframes.Pop()) {
    const KeyframeId id = shared.lanes->mapping.Map(*candidate, [&] { return shared.keyframes.Size() > 0; });
    --shared.to_map;
    shared.lanes->Learn(id);
  }
}

// The paper's Algorithm 1.
void ThreadedExecutor::RunSemantics(Shared& shared, const SemanticOptions& options) {
  Lanes& lanes = *shared.lanes;
  for (;;) {
    std::vector<BacklogItem> selected = lanes.waiting.WaitAndWrite(
        [](const Waiting& waiting) { return waiting.closing || !waiting.backlog.empty(); },
        [&](Waiting& waiting) {
          auto items = waiting.closing
                           ? std::vector<BacklogItem>{}
                           : waiting.backlog.Select(options.selection, static_cast<std::size_t>(options.per_round));
          waiting.in_flight = static_cast<int>(items.size());
          return items;
        });
    if (selected.empty()) {
      return;
    }
    Worker::UseAllCores();
    std::vector<std::vector<BacklogItem>> requests;
    if (options.batch) {
      requests.push_back(std::move(selected));
    } else {  // the newest first: its label is the one that tracking waits for
      for (auto item = selected.rbegin(); item != selected.rend(); ++item) {
        requests.push_back({std::move(*item)});
      }
    }
    for (auto& request : requests) {
      const auto keyframes = static_cast<int>(request.size());
      const LabeledRound round = lanes.semantics.Segment(std::move(request));
      if (lanes.waiting.Read([](const Waiting& waiting) { return waiting.closing; })) {
        return;
      }
      lanes.semantics.Apply(round);
      lanes.Learn(round);
      lanes.waiting.Write([&](Waiting& waiting) { waiting.in_flight -= keyframes; });
    }
  }
}

void ThreadedExecutor::RunLoops(Shared& shared) {
  constexpr std::size_t kMostBehind = 8;  // keyframes; of more, the oldest are only indexed
  Lanes& lanes = *shared.lanes;
  for (;;) {
    std::optional<LostFrame> lost;
    std::optional<KeyframeId> keyframe;
    bool only_index = false;
    lanes.places.WaitAndWrite([](const PlaceWork& work) { return work.closing || work.HasWork(); },
                              [&](PlaceWork& work) {
                                if (work.closing) {
                                  return;
                                }
                                work.in_flight = true;
                                lost = std::exchange(work.lost, std::nullopt);
                                if (!lost) {
                                  only_index = work.keyframes.size() > kMostBehind;
                                  keyframe = work.keyframes.front();
                                  work.keyframes.pop_front();
                                }
                              });
    if (!lost && !keyframe) {
      return;
    }
    bool bundle_due = false;
    if (lost) {
      lanes.loops.Find(*lost);
    } else {
      bundle_due = lanes.loops.Learn(*keyframe, only_index);
    }
    lanes.places.Write([&](PlaceWork& work) {
      work.in_flight = false;
      work.bundle_due = work.bundle_due || bundle_due;
    });
  }
}

void ThreadedExecutor::RunBundles(Shared& shared) {
  Lanes& lanes = *shared.lanes;
  for (;;) {
    const bool due = lanes.places.WaitAndWrite([](const PlaceWork& work) { return work.closing || work.bundle_due; },
                                               [](PlaceWork& work) {
                                                 work.adjusting =
                                                     !work.closing && std::exchange(work.bundle_due, false);
                                                 return work.adjusting;
                                               });
    if (!due) {
      return;
    }
    lanes.loops.Adjust([&] { return lanes.places.Read([](const PlaceWork& work) { return work.closing; }); });
    lanes.places.Write([](PlaceWork& work) { work.adjusting = false; });
  }
}

void ThreadedExecutor::StopLoops(bool wait_for_places) {
  if (!loops_) {
    return;
  }
  constexpr double kMost_s = 60;
  Monitor<PlaceWork>& places = shared_->lanes->places;
  const bool bundles = bundles_.has_value();
  const auto is_done = [&](const PlaceWork& work) {
    return work.closing || (bundles ? work.IsIdle() : !work.HasWork() && !work.in_flight);
  };
  if (wait_for_places && !places.WaitFor(kMost_s, is_done)) {
    log::warn("full bundle adjustment is given up after {} s", kMost_s);
  }
  places.Write([](PlaceWork& work) { work.closing = true; });
  loops_->Join();
  loops_.reset();
  if (bundles_) {
    bundles_->Join();
    bundles_.reset();
  }
}

WorkerStatus ThreadedExecutor::Status() const {
  WorkerStatus status;
  status.mapping_idle = shared_->to_map == 0;
  status.segmenter_idle = semantics_ && shared_->lanes->waiting.Read([](const Waiting& waiting) {
    return waiting.backlog.empty() && waiting.in_flight == 0;
  });
  return status;
}

void ThreadedExecutor::BeginFrame(FrameId /*frame*/) {
  mapping_->StayOffCallersCore();
  if (loops_) {
    loops_->StayOffCallersCore();
  }
  if (bundles_) {
    bundles_->StayOffCallersCore();
  }
  if (propagation_) {
    propagation_->worker.StayOffCallersCore();
  }
}

bool ThreadedExecutor::Map(KeyframeCandidate& candidate) {
  ++shared_->to_map;  // before mapping can be done with it
  const bool taken = options_.system.wait_for_mapping ? shared_->keyframes.Push(std::move(candidate))
                                                      : shared_->keyframes.TryPush(std::move(candidate));
  shared_->to_map -= taken ? 0 : 1;
  return taken;
}

void ThreadedExecutor::Label(BacklogItem item) {
  if (semantics_) {
    semantics_->LeaveCallersCore();
  }
  shared_->lanes->waiting.Write([&](Waiting& waiting) { waiting.dropped += waiting.backlog.Push(std::move(item)); });
}

void ThreadedExecutor::RestartPropagation() {
  propagation_.reset();
  if (WantsPropagation(options_, *shared_->lanes)) {
    propagation_ = std::make_unique<Propagation>(options_, shared_);
  }
}

void ThreadedExecutor::Propagate(TrackedFrame frame) {
  if (propagation_) {
    static_cast<void>(propagation_->frames.TryPush(std::move(frame)));
  }
}

std::shared_ptr<const PropagatedLabels> ThreadedExecutor::NewestLabels(FrameId frame) const {
  return propagation_ ? propagation_->lane.Newest(frame) : nullptr;
}

void ThreadedExecutor::StopSemantics(bool wait_for_labels) {
  if (!semantics_) {
    return;
  }
  Lanes& lanes = *shared_->lanes;
  if (wait_for_labels) {
    const bool done = lanes.waiting.WaitFor(options_.semantic.finish_timeout_s, [](const Waiting& waiting) {
      return waiting.closing || (waiting.backlog.empty() && waiting.in_flight == 0);
    });
    if (!done) {
      log::warn("labels still missing after {} s are given up", options_.semantic.finish_timeout_s);
    }
  }
  lanes.waiting.Write([](Waiting& waiting) { waiting.closing = true; });
  lanes.semantics.Cancel();
  if (semantics_->WaitFor(options_.semantic.cancel_timeout_s)) {
    semantics_->Join();
  } else {
    log::warn("the segmentation back end does not answer; its thread is left behind");
    semantics_->Abandon();
  }
  semantics_.reset();
}

void ThreadedExecutor::Finish() {
  shared_->keyframes.Close();
  mapping_->Join();
  StopSemantics(!shared_->lanes->failure.Happened());
  StopLoops(!shared_->lanes->failure.Happened());
  propagation_.reset();
}

}  // namespace rds
