// SPDX-License-Identifier: Apache-2.0
// Each lane on a thread of its own, in real time.
#pragma once

#include <memory>
#include <optional>

#include "runtime/bounded_queue.h"
#include "runtime/worker.h"
#include "system/executor.h"

namespace rds {

// The caller never waits for a lane, unless the options ask it to wait for mapping.
class ThreadedExecutor final : public Executor {
 public:
  ThreadedExecutor(const Options& options, std::shared_ptr<Lanes> lanes);
  ~ThreadedExecutor() override;

  void BeginFrame(FrameId /*frame*/) override;
  [[nodiscard]] WorkerStatus Status() const override;
  [[nodiscard]] bool Map(KeyframeCandidate& candidate) override;
  void Label(BacklogItem item) override;
  void Propagate(TrackedFrame frame) override;
  void RestartPropagation() override;
  [[nodiscard]] std::shared_ptr<const PropagatedLabels> NewestLabels(FrameId frame) const override;
  void Finish() override;

 private:
  struct Shared;       // what the threads of mapping and semantics touch
  struct Propagation;  // a lane with its queue and thread

  static void RunMapping(Shared& shared);
  static void RunSemantics(Shared& shared, const SemanticOptions& options);
  static void RunLoops(Shared& shared);
  static void RunBundles(Shared& shared);
  void StopSemantics(bool wait_for_labels);
  void StopLoops(bool wait_for_places);

  Options options_;
  std::shared_ptr<Shared> shared_;
  std::optional<Worker> mapping_;
  std::optional<Worker> semantics_;
  std::optional<Worker> loops_;
  std::optional<Worker> bundles_;
  std::unique_ptr<Propagation> propagation_;
};

}  // namespace rds
