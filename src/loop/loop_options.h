// SPDX-License-Identifier: Apache-2.0
// Options of loop closing and of worlds.
#pragma once

#include <cstdint>

#include "optim/optim_options.h"

namespace rds {

// Which of two worlds keeps its coordinates when they are merged.
enum class KeptWorld : std::uint8_t {
  kLarger,   // the one with more keyframes, the older of equals
  kCurrent,  // the one that the camera is tracked in: nobody who navigates there is moved
};

struct LoopOptions {
  bool enabled = true;  // loops are closed, worlds merged, lost frames looked for in all of the map
  bool bundle = true;   // full bundle adjustment after each loop and merge
  KeptWorld keep = KeptWorld::kLarger;
  BundleOptions solver;
};

}  // namespace rds
