// SPDX-License-Identifier: Apache-2.0
// A mapping of a YAML file: typed access, unknown keys refused, errors that name file, line and key.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace YAML {
class Node;
}

namespace rds {

// What is wrong throws InputError.
class YamlMapping {
 public:
  // `name`: where in the file, for messages ("input" of "input.size"). A node that is null or undefined has no keys.
  YamlMapping(std::filesystem::path file, const YAML::Node& node, const std::vector<std::string>& keys,
              std::string name = "");

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  [[nodiscard]] YAML::Node At(const std::string& key) const;

  // Leaves `value` where the key is not there. `wanted` completes "... must be". For the types at the end of the .cc
  // file.
  template <typename T>
  void Read(const std::string& key, T& value, const std::string& wanted = "") const;
  // A word that must be there.
  [[nodiscard]] std::string Need(const std::string& key) const;
  // The elements of a list; none where there is no such key.
  [[nodiscard]] std::vector<YAML::Node> List(const std::string& key) const;

  [[noreturn]] void Refuse(const std::string& key, const std::string& wanted) const;

 private:
  [[nodiscard]] std::string Path(const std::string& key) const { return name_.empty() ? key : name_ + "." + key; }

  std::filesystem::path file_;
  std::string name_;
  std::shared_ptr<const YAML::Node> node_;  // const: a node that is not asks for a key by adding it
};

}  // namespace rds
