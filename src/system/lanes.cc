// SPDX-License-Identifier: Apache-2.0
#include "system/lanes.h"

#include <utility>
#include <vector>

#include "runtime/worker.h"

namespace rds {

void RunMapping(Shared& shared) {
  while (auto candidate = shared.keyframes.Pop()) {
    Worker::UseAllCores();
    shared.mapping = true;
    shared.pipeline.MapKeyframe(*candidate, [&] { return shared.keyframes.Size() > 0; });
    shared.mapping = false;
  }
}

void RunSemantics(Shared& shared, const SemanticOptions& options) {
  for (;;) {
    std::vector<BacklogItem> selected = shared.waiting.WaitAndWrite(
        [](const Waiting& waiting) { return waiting.closing || !waiting.backlog.empty(); },
        [&](Waiting& waiting) {
          auto items = waiting.closing
                           ? std::vector<BacklogItem>{}
                           : waiting.backlog.Select(options.selection, static_cast<std::size_t>(options.per_round));
          waiting.in_flight = !items.empty();
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
      const LabeledRound round = shared.pipeline.Segment(std::move(request));
      if (shared.waiting.Read([](const Waiting& waiting) { return waiting.closing; })) {
        return;
      }
      shared.pipeline.ApplyRound(round);
    }
    shared.waiting.Write([](Waiting& waiting) { waiting.in_flight = false; });
  }
}

}  // namespace rds
