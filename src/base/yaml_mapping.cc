// SPDX-License-Identifier: Apache-2.0
#include "base/yaml_mapping.h"

#include <spdlog/fmt/fmt.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <map>
#include <type_traits>
#include <utility>

#include "base/error.h"
#include "base/strict_yaml.h"
#include "base/suggest.h"

namespace rds {
namespace {

template <typename T>
constexpr const char* Kind() {
  if constexpr (std::is_same_v<T, bool>) {
    return "true or false";
  } else if constexpr (std::is_arithmetic_v<T>) {
    return "a number";
  } else if constexpr (std::is_same_v<T, std::string>) {
    return "a word";
  } else if constexpr (requires { typename T::mapped_type; }) {
    return "a mapping";
  } else {
    return "a list";
  }
}

}  // namespace

YamlMapping::YamlMapping(std::filesystem::path file, const YAML::Node& node, const std::vector<std::string>& keys,
                         std::string name)
    : file_(std::move(file)),
      name_(std::move(name)),
      node_(std::make_shared<const YAML::Node>(node.IsDefined() ? node : YAML::Node())) {
  if (node_->IsNull()) {
    return;
  }
  if (!node_->IsMap()) {
    throw InputError(fmt::format("{}: {}a mapping is wanted, with the keys {}", WhereInYaml(file_, *node_),
                                 name_.empty() ? "" : name_ + ": ", fmt::join(keys, ", ")));
  }
  for (const auto& entry : *node_) {
    const std::string& key = entry.first.Scalar();  // "" where it is no word
    if (std::ranges::find(keys, key) == keys.end()) {
      throw InputError(fmt::format("{}: unknown key '{}'{}; known: {}", WhereInYaml(file_, entry.first), Path(key),
                                   Suggestion(key, keys), fmt::join(keys, ", ")));
    }
  }
}

YAML::Node YamlMapping::At(const std::string& key) const { return (*node_)[key]; }

template <typename T>
void YamlMapping::Read(const std::string& key, T& value, const std::string& wanted) const {
  if (const YAML::Node node = At(key)) {
    try {
      value = node.as<T>();
    } catch (const YAML::Exception&) {
      Refuse(key, wanted.empty() ? Kind<T>() : wanted);
    }
  }
}

std::string YamlMapping::Need(const std::string& key) const {
  std::string value;
  Read(key, value);
  if (value.empty()) {
    throw InputError(fmt::format("{}: '{}' is missing", WhereInYaml(file_, *node_), Path(key)));
  }
  return value;
}

std::vector<YAML::Node> YamlMapping::List(const std::string& key) const {
  const YAML::Node node = At(key);
  if (!node || node.IsNull()) {
    return {};
  }
  if (!node.IsSequence()) {
    Refuse(key, "a list");
  }
  return {node.begin(), node.end()};
}

void YamlMapping::Refuse(const std::string& key, const std::string& wanted) const {
  const YAML::Node node = At(key);
  throw InputError(fmt::format("{}: {} must be {}", WhereInYaml(file_, node ? node : *node_), Path(key), wanted));
}

template void YamlMapping::Read(const std::string&, bool&, const std::string&) const;
template void YamlMapping::Read(const std::string&, int&, const std::string&) const;
template void YamlMapping::Read(const std::string&, double&, const std::string&) const;
template void YamlMapping::Read(const std::string&, std::string&, const std::string&) const;
template void YamlMapping::Read(const std::string&, std::vector<int>&, const std::string&) const;
template void YamlMapping::Read(const std::string&, std::vector<std::string>&, const std::string&) const;
template void YamlMapping::Read(const std::string&, std::array<int, 2>&, const std::string&) const;
template void YamlMapping::Read(const std::string&, std::array<double, 2>&, const std::string&) const;
template void YamlMapping::Read(const std::string&, std::array<float, 3>&, const std::string&) const;
template void YamlMapping::Read(const std::string&, std::map<std::string, YAML::Node>&, const std::string&) const;
template void YamlMapping::Read(const std::string&, std::map<std::string, std::map<std::string, int>>&,
                                const std::string&) const;

}  // namespace rds
