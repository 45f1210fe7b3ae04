// SPDX-License-Identifier: Apache-2.0
// The arguments that run, bench and ablate share, and what they stand for.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/run_report.h"
#include "geometry/camera.h"
#include "io/dataset.h"
#include "segmentation/segmenter.h"
#include "system/options.h"

namespace rds {

// Where option values come from, weakest first: defaults, a preset, a file, --set in their order.
struct OptionArguments {
  std::string preset;
  std::string config;
  std::vector<std::string> set;
};

// --preset, --config and --set.
void AddOptionArguments(CLI::App& command, OptionArguments& arguments);
// Throws InputError naming file and line, or key and range.
[[nodiscard]] Options ResolveOptions(const OptionArguments& arguments);

struct PlayArguments {
  std::string sequence;
  std::string camera;
  OptionArguments options;
  std::optional<double> rate;
  std::string frames = ":";
  std::string segmenter = "openvino";
  std::string model;
  std::string masks;  // "" = the sequence's
  bool strict = false;
};

// SEQUENCE, --camera, --config, --set, --frames, --segmenter, --model and --masks. `default_segmenter` for the help and
// where none is given.
void AddPlayArguments(CLI::App& command, PlayArguments& arguments, const std::string& default_segmenter);

// Everything that playing needs, opened and checked. Copy `options` to change them for one of several runs.
struct PlaySetup {
  Dataset dataset;
  PinholeCamera camera;
  std::string camera_name;    // "tum_fr3", "file path/camera.yaml"
  std::string camera_reason;  // why it was taken
  Options options;
  PlayOptions play;
};

// Throws InputError for whatever is wrong with the arguments. Without --rate: 1, or 0 (as fast as it goes) in lockstep.
[[nodiscard]] PlaySetup PreparePlay(const PlayArguments& arguments, bool lockstep);

// A new back end as asked for; null for "none". Throws InputError if it cannot be had, saying what would do.
[[nodiscard]] std::unique_ptr<Segmenter> OpenSegmenter(const PlayArguments& arguments, const PlaySetup& setup);

// How the run was asked for, for its report; call it right before Play.
[[nodiscard]] RunDescription Describe(const PlaySetup& setup, const Segmenter* segmenter);

// The end of a command's callback: an exit code other than 0 leaves CLI11's parsing as CLI::RuntimeError.
void EndCommand(int exit_code);

}  // namespace rds
