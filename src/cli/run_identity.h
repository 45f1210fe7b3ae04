// SPDX-License-Identifier: Apache-2.0
// What tells one run's results from another's, and what made them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace rds {

// A new name for a run, 16 hexadecimal digits, never the same twice.
[[nodiscard]] std::string NewRunId();

// Versions of the program and of the libraries that make its results.
[[nodiscard]] nlohmann::ordered_json VersionsJson();

}  // namespace rds
