// SPDX-License-Identifier: Apache-2.0
// Which thread runs which lane, and when.
#pragma once

#include <memory>

#include "map/keyframe_candidate.h"
#include "system/lanes.h"
#include "tracking/tracker.h"

namespace rds {

// What tracking hands on goes through here. One caller, that of Slam. Whatever a lane throws ends the run, in every
// executor: nobody waits for anything any more, Lanes::failure holds the first error, and later offers are refused.
class Executor {
 public:
  Executor() = default;
  virtual ~Executor() = default;  // ends all lanes; labels that are missing are given up
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  // Before a frame is tracked.
  virtual void BeginFrame(FrameId frame) = 0;
  [[nodiscard]] virtual WorkerStatus Status() const = 0;
  // Has a keyframe mapped. False, and the candidate is left as it was: there is no capacity now, or the run has ended.
  [[nodiscard]] virtual bool Map(KeyframeCandidate& candidate) = 0;
  // Has a keyframe labeled, some time.
  virtual void Label(BacklogItem item) = 0;
  // Has labels propagated to a tracked frame; where propagation is far behind, the frame is left out.
  virtual void Propagate(TrackedFrame frame) = 0;
  // Forgets all propagated labels: frames begin anew.
  virtual void RestartPropagation() = 0;
  // Null without propagation; otherwise see PropagationLane.
  [[nodiscard]] virtual std::shared_ptr<const PropagatedLabels> NewestLabels(FrameId frame) const = 0;
  // Lets the lanes finish what is under way (missing labels up to a limit) and ends them. Throws nothing that a lane
  // throws.
  virtual void Finish() = 0;
};

// The executor that the options ask for: threaded in real time, or lockstep on the caller's thread. Throws InputError
// if the system gives no thread.
[[nodiscard]] std::unique_ptr<Executor> MakeExecutor(const Options& options, std::shared_ptr<Lanes> lanes);

// Whether labels are propagated at all.
[[nodiscard]] bool WantsPropagation(const Options& options, const Lanes& lanes);

}  // namespace rds
