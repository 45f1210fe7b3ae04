// SPDX-License-Identifier: Apache-2.0
// Everything that runs beside tracking, without a thread.
#pragma once

#include <memory>
#include <utility>

#include "runtime/failure.h"
#include "runtime/monitor.h"
#include "semantic/backlog.h"
#include "system/backend.h"
#include "system/mapping_lane.h"
#include "system/propagation_lane.h"
#include "system/semantic_lane.h"

namespace rds {

// Keyframes that wait for labels.
struct Waiting {
  explicit Waiting(std::size_t capacity) : backlog(capacity) {}

  Backlog backlog;
  int dropped = 0;         // left unlabeled for want of capacity
  bool in_flight = false;  // a round is being segmented
  bool closing = false;
};

// The state that the lanes share, owned together: a segmentation back end that never answers keeps it alive after the
// rest is gone. An executor decides which thread runs what.
struct Lanes {
  Lanes(const Options& options, const ScalePyramid& pyramid, std::shared_ptr<Segmenter> segmenter)
      : backend(pyramid, options.semantic.probability, options.local_map, options.system.keep_features),
        mapping(options, segmenter != nullptr, backend),
        semantics(options, std::move(segmenter), backend),
        waiting(static_cast<std::size_t>(options.semantic.backlog)) {}

  Backend backend;
  MappingLane mapping;
  SemanticLane semantics;
  Monitor<Waiting> waiting;
  Failure failure;  // the error that ends the run
};

}  // namespace rds
