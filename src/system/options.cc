#include "system/options.h"

#include "base/error.h"

namespace rds {
namespace {

void BindSystem(SystemOptions& options, OptionTable& table) {
  table.Flag("system.lockstep", options.lockstep,
             "run everything on one thread in a fixed order: same bytes every time");
  table.Flag("system.keep_features", options.keep_features, "keep each frame's features for drawing");
}

void BindOrb(OrbOptions& options, OptionTable& table) {
  table.Int("orb.features", options.features, 100, 10000, "keypoints wanted in a frame");
  table.Int("orb.levels", options.levels, 1, 16, "levels of the scale pyramid");
  table.Real("orb.scale_factor", options.scale_factor, 1.01, 2.0, "scale between levels of the pyramid");
  table.Int("orb.fast_threshold", options.fast_threshold, 1, 255, "contrast of a FAST corner, in grey values");
  table.Int("orb.min_fast_threshold", options.min_fast_threshold, 1, 255,
            "contrast used where orb.fast_threshold finds nothing, in grey values");
}

void BindPose(PoseOptimizerOptions& options, OptionTable& table) {
  table.Int("pose.rounds", options.rounds, 1, 10, "rounds of pose optimisation; inliers are classified after each");
  table.Int("pose.iterations_per_round", options.iterations_per_round, 1, 100, "steps in a round, at most");
  table.Int("pose.robust_rounds", options.robust_rounds, 0, 10, "first rounds that use the Huber kernel");
}

void CheckConsistent(const Options& options) {
  if (options.orb.min_fast_threshold > options.orb.fast_threshold) {
    throw InputError("option orb.min_fast_threshold must not be above orb.fast_threshold");
  }
}

}  // namespace

OptionTable BindOptions(Options& options) {
  OptionTable table;
  BindSystem(options.system, table);
  BindOrb(options.orb, table);
  BindPose(options.pose, table);
  return table;
}

void SetOption(Options& options, std::string_view key, const std::string& value) {
  BindOptions(options).Find(key).set(value);
}

void SetOption(Options& options, const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw InputError("option '" + assignment + "': expected key=value");
  }
  SetOption(options, assignment.substr(0, equals), assignment.substr(equals + 1));
}

void ValidateOptions(const Options& options) {
  Options copy = options;
  const OptionTable table = BindOptions(copy);
  for (const OptionEntry& entry : table.entries()) {
    entry.set(entry.get());
  }
  CheckConsistent(options);
}

}  // namespace rds
