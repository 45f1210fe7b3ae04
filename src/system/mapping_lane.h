// SPDX-License-Identifier: Apache-2.0
// What happens to a keyframe.
#pragma once

#include <functional>
#include <vector>

#include "mapping/local_mapper.h"
#include "runtime/guarded.h"
#include "system/backend.h"
#include "system/options.h"

namespace rds {

// Knows no thread; one caller at a time.
class MappingLane {
 public:
  MappingLane(const Options& options, bool semantics, Backend& backend);

  // Inserts the keyframe and publishes; then refines and, unless `should_stop()` says that another one waits, adjusts
  // and culls, and publishes again.
  KeyframeId Map(const KeyframeCandidate& candidate, const std::function<bool()>& should_stop);

  [[nodiscard]] std::vector<double> local_ba_ms() const;

 private:
  FreeSpaceOptions free_space_;
  bool semantics_;
  Backend& backend_;
  LocalMapper mapper_;
  Guarded<std::vector<double>> local_ba_ms_;
};

}  // namespace rds
