// SPDX-License-Identifier: Apache-2.0
// The threads of the threaded executor: what they share and what each runs.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <utility>

#include "map/keyframe_candidate.h"
#include "runtime/bounded_queue.h"
#include "runtime/failure.h"
#include "runtime/monitor.h"
#include "semantic/backlog.h"
#include "system/pipeline.h"

namespace rds {

// Keyframes that wait for labels, as the semantic thread sees them.
struct Waiting {
  explicit Waiting(std::size_t capacity) : backlog(capacity) {}

  Backlog backlog;
  int dropped = 0;         // left unlabeled for want of room
  bool in_flight = false;  // a round is being segmented
  bool closing = false;
};

// What the workers touch. Shared, so that a back end that never answers keeps it alive after the rest is gone.
struct Shared {
  Shared(const Options& options, const ScalePyramid& pyramid, std::shared_ptr<Segmenter> segmenter)
      : pipeline(options, pyramid, std::move(segmenter)),
        keyframes(static_cast<std::size_t>(options.system.keyframe_queue)),
        waiting(static_cast<std::size_t>(options.semantic.backlog)) {}

  Pipeline pipeline;
  BoundedQueue<KeyframeCandidate> keyframes;
  std::atomic<bool> mapping = false;
  Monitor<Waiting> waiting;
  Failure failure;

  // Ends the run: nobody waits for anything any more.
  void Fail(std::exception_ptr error) {
    failure.Set(std::move(error));
    keyframes.Close();
    waiting.Write([](Waiting& state) { state.closing = true; });
  }
};

// Maps keyframes until their queue is closed.
void RunMapping(Shared& shared);

// Labels keyframes until the run is closing: the paper's Algorithm 1.
void RunSemantics(Shared& shared, const SemanticOptions& options);

// What a thread runs: an error ends the run instead of the thread alone.
template <typename Function>
std::function<void()> Lane(std::shared_ptr<Shared> shared, Function run) {
  return [shared = std::move(shared), run = std::move(run)] {
    try {
      run(*shared);
    } catch (...) {
      shared->Fail(std::current_exception());
    }
  };
}

}  // namespace rds
