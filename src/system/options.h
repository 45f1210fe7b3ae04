// All options of the system: one struct a module, gathered here; and the table that names, bounds and explains them.
//
// To add an option: a member with its default in its module's struct, and one line in BindOptions (options.cc).
#pragma once

#include <string>
#include <string_view>

#include "feature/orb.h"
#include "optim/bundle_adjustment.h"
#include "optim/pose_optimizer.h"
#include "system/option_table.h"

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

// The table of all options, bound to `options`, which must outlive it. The order is the order of printing; keys with
// the same first part stand together.
[[nodiscard]] OptionTable BindOptions(Options& options);

// Sets one option from text. Throws InputError naming the key, the value and the range, or the nearest known key.
void SetOption(Options& options, std::string_view key, const std::string& value);

// The same for "key=value", as on the command line.
void SetOption(Options& options, const std::string& assignment);

// Throws InputError if a value lies out of its range or two options contradict each other.
void ValidateOptions(const Options& options);

}  // namespace rds
