// SPDX-License-Identifier: Apache-2.0
// rds fetch: downloads the published segmentation weights.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace rds {

struct FetchArguments {
  std::string what;      // "weights"
  std::string name;      // "fast" or "accurate"; "" = accurate
  std::string url_base;  // a mirror; "" = RDS_WEIGHTS_URL, else the publisher
};

// Fetches into the cache folder, showing progress on standard error, and prints the file's path. Throws InputError.
void Fetch(const FetchArguments& arguments);

// Adds the command; parsing it runs it.
void AddFetchCommand(CLI::App& program);

}  // namespace rds
