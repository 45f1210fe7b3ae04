// SPDX-License-Identifier: Apache-2.0
// All lanes on the caller's thread, in a fixed order.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "system/executor.h"

namespace rds {

// Keyframes are mapped and labels propagated at once; masks are delivered a set number of frames after they were asked
// for (and only then segmented: what has been seen until then is there to compare with), and the next round begins
// then: the same input gives the same bytes. What a lane throws leaves the method that ran it.
class LockstepExecutor final : public Executor {
 public:
  LockstepExecutor(const Options& options, std::shared_ptr<Lanes> lanes);

  void BeginFrame(FrameId frame) override;
  [[nodiscard]] WorkerStatus Status() const override;
  [[nodiscard]] bool Map(KeyframeCandidate& candidate) override;
  void Label(BacklogItem item) override;
  void Propagate(TrackedFrame frame) override;
  void RestartPropagation() override;
  [[nodiscard]] std::shared_ptr<const PropagatedLabels> NewestLabels(FrameId frame) const override;
  void Finish() override;

 private:
  struct Round {
    std::uint32_t due_frame = 0;
    std::vector<BacklogItem> items;
  };

  void Deliver();
  // What the loop lane has to do.
  void SeePlaces();
  // Selects what goes next; the labels are due some frames after `frame`.
  void SelectNext(FrameId frame);

  Options options_;
  std::shared_ptr<Lanes> lanes_;
  std::optional<PropagationLane> propagation_;
  std::optional<Round> round_;  // in flight
};

}  // namespace rds
