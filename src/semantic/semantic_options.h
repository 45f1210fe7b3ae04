// SPDX-License-Identifier: Apache-2.0
// Options of the paper's semantic thread.
#pragma once

#include <cstdint>

namespace rds {

enum class SelectionMode : std::uint8_t {
  kBidirectional,  // the oldest and the newest
  kSequential,     // the oldest ones
  kNewest,         // the newest ones
};

struct SemanticOptimizerOptions {
  bool enabled = true;
  int most_keyframes = 30;         // a labeled one and those after it, whose poses hang on its own
  int min_static = 50;             // static matches that a keyframe needs
  double min_shift_m = 0.002;      // smaller corrections are not applied: they are noise ...
  double min_rotation_deg = 0.05;  // ... unless the rotation is larger than this
};

}  // namespace rds
