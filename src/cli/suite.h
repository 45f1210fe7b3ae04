// SPDX-License-Identifier: Apache-2.0
// An evaluation suite: which sequences to run how often in which configurations, and what to hold the results against.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "io/dataset.h"

namespace rds {

struct SuiteSequence {
  std::string name;            // in tables: "fr3/w/xyz"
  std::filesystem::path path;  // absolute, or from the working folder
  std::string camera;          // as --camera takes it; "" = as the folder says
  std::string frames = ":";    // as --frames takes it
};

struct SuiteConfiguration {
  std::string name;
  std::string segmenter = "openvino";
  std::string model;     // weights; "" = what is there
  std::string masks_by;  // weights whose masks are made first and then played back; "" = none
  std::string preset;
  double rate = 1;  // of playing; 0.5: a sequence of 30 Hz at 15 Hz
  bool lockstep = false;
  std::vector<std::string> set;  // "key=value"
};

// Trajectories of another system, one or more for each sequence.
struct SuiteMethod {
  std::string name;
  std::map<std::string, std::vector<std::filesystem::path>> trajectories;  // by the sequence's name
};

// RMSE and standard deviation as published; the latter may be missing.
struct PublishedValue {
  double rmse = 0;
  std::optional<double> std;
};

struct PublishedMethod {
  std::string name;
  std::string source;
  std::string hardware;
  std::string semantics;
  std::string track_ms;  // as published
  std::string segmentation_ms;
  std::string other_ms;
  std::map<std::string, PublishedValue> ate_m;  // by the sequence's name
  std::map<std::string, PublishedValue> rpe_translation_m;
  std::map<std::string, PublishedValue> rpe_rotation_deg;
  std::map<std::string, std::map<std::string, int>> labeled_keyframes;  // by sequence, then by what else was set
};

struct Suite {
  std::string title;
  int repetitions = 5;
  std::vector<SuiteSequence> sequences;
  std::vector<SuiteConfiguration> configurations;
  std::vector<SuiteMethod> methods;
  std::vector<PublishedMethod> published;
  std::vector<int> pictures;  // frames to show, of each sequence and configuration
};

// Reads SUITE.yaml, as evaluation/README.md tells. Paths in it start from `data`, or where that is empty from the
// suite's own folder. InputError naming file and line for what is no suite: unknown keys, doubled names, no sequence.
[[nodiscard]] Suite ReadSuite(const std::filesystem::path& file, const std::filesystem::path& data);

// Opens what a suite calls a sequence. InputError as Dataset::Open.
[[nodiscard]] Dataset OpenSequence(const SuiteSequence& sequence);

// A name as a name of a file.
[[nodiscard]] std::string AsFileName(const std::string& name);

}  // namespace rds
