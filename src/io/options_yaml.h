// SPDX-License-Identifier: Apache-2.0
// Options as YAML: nested keys ("orb: {features: 1000}"), read strictly and written so that they read back the same.
#pragma once

#include <filesystem>
#include <string>

#include "system/options.h"

namespace rds {

// Sets the options that a YAML file names; the others keep their values. Throws InputError with file and line for a
// file that cannot be read, an unknown key, a key given twice, a wrong type or a value out of range.
void ApplyOptionsFile(const std::filesystem::path& file, Options& options);

// All options with their values, as YAML text.
[[nodiscard]] std::string OptionsYaml(const Options& options);

// The same with a comment before each option: its meaning, range and default.
[[nodiscard]] std::string DocumentedOptionsYaml(const Options& options);

}  // namespace rds
