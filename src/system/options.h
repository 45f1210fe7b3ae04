// All options of the system: one struct a module, gathered here; and the table that names, bounds and explains them.
#pragma once

#include "feature/orb.h"
#include "optim/bundle_adjustment.h"
#include "optim/pose_optimizer.h"

namespace rds {

struct SystemOptions {
  bool lockstep = false;       // one thread, fixed order, same bytes every time
  bool keep_features = false;  // fill FrameResult::features, for drawing
};

struct Options {
  SystemOptions system;
  OrbOptions orb;
  PoseOptimizerOptions pose;
};

}  // namespace rds
