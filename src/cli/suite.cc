// SPDX-License-Identifier: Apache-2.0
#include "cli/suite.h"

#include <spdlog/fmt/fmt.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <utility>

#include "base/error.h"
#include "base/strict_yaml.h"
#include "base/yaml_mapping.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

template <typename T>
void CheckNames(const fs::path& file, const std::vector<T>& all, const char* what) {
  std::set<std::string> seen;
  for (const T& one : all) {
    if (!seen.insert(AsFileName(one.name)).second) {
      throw InputError(
          fmt::format("{}: two {} are called '{}' (or differ in signs only)", file.string(), what, one.name));
    }
  }
}

fs::path From(const fs::path& base, const std::string& path) {
  return fs::path(path).is_absolute() ? fs::path(path) : base / path;
}

SuiteSequence ReadSequence(const YamlMapping& map, const fs::path& base) {
  SuiteSequence sequence;
  const std::string path = map.Need("path");
  sequence.path = From(base, path);
  sequence.name = fs::path(path).filename().string();
  map.Read("name", sequence.name);
  map.Read("camera", sequence.camera);
  map.Read("frames", sequence.frames);
  return sequence;
}

SuiteConfiguration ReadConfiguration(const YamlMapping& map) {
  SuiteConfiguration configuration;
  configuration.name = map.Need("name");
  map.Read("segmenter", configuration.segmenter);
  map.Read("model", configuration.model);
  map.Read("masks_by", configuration.masks_by);
  map.Read("preset", configuration.preset);
  map.Read("rate", configuration.rate);
  map.Read("lockstep", configuration.lockstep);
  map.Read("set", configuration.set);
  if (!configuration.masks_by.empty()) {
    configuration.segmenter = "stored";
  }
  if (!(configuration.rate >= 0.01 && configuration.rate <= 1000)) {
    map.Refuse("rate", "0.01 to 1000 times as recorded");
  }
  return configuration;
}

SuiteMethod ReadMethod(const YamlMapping& map, const fs::path& base) {
  SuiteMethod method;
  method.name = map.Need("name");
  std::map<std::string, YAML::Node> trajectories;
  map.Read("trajectories", trajectories);
  for (const auto& [sequence, files] : trajectories) {
    std::vector<fs::path>& list = method.trajectories[sequence];
    if (files.IsScalar()) {
      list.push_back(From(base, files.Scalar()));
    }
    for (std::size_t i = 0; files.IsSequence() && i < files.size(); ++i) {
      list.push_back(From(base, files[i].as<std::string>("")));
    }
  }
  return method;
}

// {sequence: rmse} or {sequence: [rmse, standard deviation]}.
std::map<std::string, PublishedValue> ReadValues(const YamlMapping& map, const std::string& key) {
  std::map<std::string, PublishedValue> values;
  const YAML::Node node = map.At(key);
  if (!node) {
    return values;
  }
  try {
    for (const auto& entry : node) {
      PublishedValue& value = values[entry.first.as<std::string>()];
      if (entry.second.IsSequence()) {
        value.rmse = entry.second[0].as<double>();
        value.std = entry.second[1].as<double>();
      } else {
        value.rmse = entry.second.as<double>();
      }
    }
  } catch (const YAML::Exception&) {
    map.Refuse(key, "a mapping from sequences to numbers, or to pairs of them (RMSE, S.D.)");
  }
  return values;
}

std::vector<PublishedMethod> ReadPublished(const fs::path& file) {
  const YAML::Node root = ReadStrictYaml(file);
  const YamlMapping top(file, root, {"methods"});
  std::vector<PublishedMethod> published;
  for (const YAML::Node& node : top.List("methods")) {
    const YamlMapping map(file, node,
                          {"name", "source", "hardware", "semantics", "track_ms", "segmentation_ms", "other_ms",
                           "ate_m", "rpe_translation_m", "rpe_rotation_deg", "labeled_keyframes"});
    PublishedMethod method;
    method.name = map.Need("name");
    method.source = map.Need("source");
    map.Read("hardware", method.hardware);
    map.Read("semantics", method.semantics);
    map.Read("track_ms", method.track_ms);
    map.Read("segmentation_ms", method.segmentation_ms);
    map.Read("other_ms", method.other_ms);
    map.Read("labeled_keyframes", method.labeled_keyframes);
    method.ate_m = ReadValues(map, "ate_m");
    method.rpe_translation_m = ReadValues(map, "rpe_translation_m");
    method.rpe_rotation_deg = ReadValues(map, "rpe_rotation_deg");
    published.push_back(std::move(method));
  }
  return published;
}

}  // namespace

Dataset OpenSequence(const SuiteSequence& sequence) {
  DatasetOptions options;
  options.frames = ParseFrameRange(sequence.frames);
  return Dataset::Open(sequence.path, options);
}

std::string AsFileName(const std::string& name) {
  std::string text;
  for (const char c : name) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0;
    if (plain || (!text.empty() && text.back() != '_')) {
      text += plain ? c : '_';
    }
  }
  while (!text.empty() && text.back() == '_') {
    text.pop_back();
  }
  return text.empty() ? "unnamed" : text;
}

Suite ReadSuite(const fs::path& file, const fs::path& data) {
  const YAML::Node root = ReadStrictYaml(file);
  const YamlMapping top(file, root,
                        {"title", "repetitions", "sequences", "configurations", "methods", "published", "pictures"});
  const fs::path own = file.parent_path();
  const fs::path base = data.empty() ? own : data;
  Suite suite;
  suite.title = file.stem().string();
  top.Read("title", suite.title);
  top.Read("repetitions", suite.repetitions);
  top.Read("pictures", suite.pictures);
  if (suite.repetitions < 1 || suite.repetitions > 1000) {
    top.Refuse("repetitions", "1 to 1000");
  }
  if (std::ranges::any_of(suite.pictures, [](int frame) { return frame < 0; })) {
    top.Refuse("pictures", "of frames from 0 on");
  }
  for (const YAML::Node& node : top.List("sequences")) {
    suite.sequences.push_back(ReadSequence(YamlMapping(file, node, {"name", "path", "camera", "frames"}), base));
  }
  for (const YAML::Node& node : top.List("configurations")) {
    suite.configurations.push_back(ReadConfiguration(
        YamlMapping(file, node, {"name", "segmenter", "model", "masks_by", "preset", "rate", "lockstep", "set"})));
  }
  for (const YAML::Node& node : top.List("methods")) {
    suite.methods.push_back(ReadMethod(YamlMapping(file, node, {"name", "trajectories"}), base));
  }
  if (std::string name; top.Read("published", name), !name.empty()) {
    suite.published = ReadPublished(From(own, name));
  }
  if (suite.sequences.empty() || (suite.configurations.empty() && suite.methods.empty())) {
    throw InputError(file.string() + ": a suite has sequences, and configurations or methods");
  }
  CheckNames(file, suite.sequences, "sequences");
  CheckNames(file, suite.configurations, "configurations");
  CheckNames(file, suite.methods, "methods");
  return suite;
}

}  // namespace rds
