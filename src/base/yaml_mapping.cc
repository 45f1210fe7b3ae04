// SPDX-License-Identifier: Apache-2.0
#include "base/yaml_mapping.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "base/error.h"
#include "base/suggest.h"

namespace rds {

YamlMapping::YamlMapping(std::filesystem::path file, const YAML::Node& node, const std::vector<std::string>& keys,
                         std::string name)
    : file_(std::move(file)), name_(std::move(name)), node_(node.IsDefined() ? node : YAML::Node()) {
  if (node_.IsNull()) {
    return;
  }
  if (!node_.IsMap()) {
    throw InputError(fmt::format("{}: {}a mapping is wanted, with the keys {}", WhereInYaml(file_, node_),
                                 name_.empty() ? "" : name_ + ": ", fmt::join(keys, ", ")));
  }
  for (const auto& entry : node_) {
    const std::string& key = entry.first.Scalar();  // "" where it is no word
    if (std::ranges::find(keys, key) == keys.end()) {
      throw InputError(fmt::format("{}: unknown key '{}'{}; known: {}", WhereInYaml(file_, entry.first), Path(key),
                                   Suggestion(key, keys), fmt::join(keys, ", ")));
    }
  }
}

std::string YamlMapping::Need(const std::string& key) const {
  std::string value;
  Read(key, value);
  if (value.empty()) {
    throw InputError(fmt::format("{}: '{}' is missing", WhereInYaml(file_, node_), Path(key)));
  }
  return value;
}

std::vector<YAML::Node> YamlMapping::List(const std::string& key) const {
  const YAML::Node node = node_[key];
  if (!node || node.IsNull()) {
    return {};
  }
  if (!node.IsSequence()) {
    Refuse(key, "a list");
  }
  return {node.begin(), node.end()};
}

void YamlMapping::Refuse(const std::string& key, const std::string& wanted) const {
  const YAML::Node node = node_[key];
  throw InputError(fmt::format("{}: {} must be {}", WhereInYaml(file_, node ? node : node_), Path(key), wanted));
}

}  // namespace rds
