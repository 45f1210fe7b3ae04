// SPDX-License-Identifier: Apache-2.0
// YAML files as people write options and cameras: one document, small, without aliases.
#pragma once

#include <filesystem>
#include <string>

namespace YAML {
class Node;
}

namespace rds {

// Reads one YAML document (JSON is YAML too). InputError, naming file and line, for what is no YAML, for a second
// document, aliases (their expansion has no bound), nesting deeper than 16, more than 20,000 values, a file above 1 MB,
// and a key that stands twice in one mapping. An empty file gives a null node. A first line "%YAML:1.0", which OpenCV
// writes and YAML does not know, is passed over.
[[nodiscard]] YAML::Node ReadStrictYaml(const std::filesystem::path& path);

// "file:line", for messages about a node of that file.
[[nodiscard]] std::string WhereInYaml(const std::filesystem::path& path, const YAML::Node& node);

}  // namespace rds
