// SPDX-License-Identifier: Apache-2.0
// Everything that runs beside tracking, without a thread.
#pragma once

#include <memory>
#include <utility>

#include "runtime/failure.h"
#include "runtime/monitor.h"
#include "semantic/backlog.h"
#include "system/backend.h"
#include "system/loop_lane.h"
#include "system/mapping_lane.h"
#include "system/propagation_lane.h"
#include "system/semantic_lane.h"

namespace rds {

// Keyframes that wait for labels.
struct Waiting {
  explicit Waiting(std::size_t capacity) : backlog(capacity) {}

  Backlog backlog;
  int dropped = 0;    // left unlabeled for want of capacity
  int in_flight = 0;  // keyframes that are being segmented; in the end, those given up
  bool closing = false;
};

// The state that the lanes share, owned together: a segmentation back end that never answers keeps it alive after the
// rest is gone. An executor decides which thread runs what.
struct Lanes {
  Lanes(const Options& options, const ScalePyramid& pyramid, std::shared_ptr<Segmenter> segmenter)
      : finds_places(options.loop.enabled),
        backend(pyramid, options.semantic.probability, options.local_map, options.system.keep_features),
        mapping(options, segmenter != nullptr, backend),
        semantics(options, segmenter, backend),
        loops(options, segmenter != nullptr, backend),
        waiting(static_cast<std::size_t>(options.semantic.backlog)) {}

  // A keyframe is new, or was labeled: its place may have been seen before.
  void Learn(KeyframeId keyframe) {
    if (finds_places && keyframe.valid()) {
      places.Write([&](PlaceWork& work) { work.keyframes.push_back(keyframe); });
    }
  }
  void Learn(const LabeledRound& round) {
    for (const BacklogItem& item : round.items) {
      Learn(backend.Read([&](const Map& map) {
        const Keyframe* const keyframe = map.FindByFrame(item.frame);
        return keyframe != nullptr ? keyframe->id : KeyframeId{};
      }));
    }
  }
  // Tracking is lost.
  void Find(LostFrame frame) {
    if (finds_places) {
      places.Write([&](PlaceWork& work) { work.lost = std::move(frame); });
    }
  }

  bool finds_places;
  Backend backend;
  MappingLane mapping;
  SemanticLane semantics;
  LoopLane loops;
  Monitor<Waiting> waiting;
  Monitor<PlaceWork> places;
  Failure failure;  // the error that ends the run
};

}  // namespace rds
