// SPDX-License-Identifier: Apache-2.0
#include "system/presets.h"

#include <spdlog/fmt/fmt.h>

#include "base/error.h"
#include "base/suggest.h"

namespace rds {

std::vector<std::string> PresetNames() { return {"paper"}; }

void ApplyPreset(Options& options, std::string_view name) {
  if (name != "paper") {
    const std::vector<std::string> names = PresetNames();
    throw InputError(fmt::format("--preset: '{}' is unknown{}; there is: {}", name,
                                 Suggestion(std::string(name), names), fmt::join(names, ", ")));
  }
  TrackerOptions& tracking = options.tracking;
  tracking.policy.semantic_frames = 0;
  tracking.association.unknown = UnknownPoints::kPaper;
  tracking.association.min_observations = 1;
  tracking.motion.acceleration_m_s2 = 0;
  options.orb.depth_edges = false;
  options.propagation.enabled = false;
  options.mapping.bundle.labeled_only = true;
  options.semantic.selection = SelectionMode::kBidirectional;
  options.semantic.start_frames = 0;
  options.semantic.free_space.enabled = false;
  options.semantic.motion = false;
}

}  // namespace rds
