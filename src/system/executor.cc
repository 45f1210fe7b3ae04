// SPDX-License-Identifier: Apache-2.0
#include "system/executor.h"

#include <utility>

#include "system/lockstep_executor.h"
#include "system/threaded_executor.h"

namespace rds {

std::unique_ptr<Executor> MakeExecutor(const Options& options, std::shared_ptr<Lanes> lanes) {
  if (options.system.lockstep) {
    return std::make_unique<LockstepExecutor>(options, std::move(lanes));
  }
  return std::make_unique<ThreadedExecutor>(options, std::move(lanes));
}

bool WantsPropagation(const Options& options, const Lanes& lanes) {
  return lanes.semantics.HasSegmenter() && options.tracking.association.use_semantics && options.propagation.enabled;
}

}  // namespace rds
