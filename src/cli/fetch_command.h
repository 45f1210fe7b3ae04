// SPDX-License-Identifier: Apache-2.0
// rds fetch: downloads published segmentation weights and benchmark sequences.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace rds {

struct FetchArguments {
  std::string what;                // "weights", "tum" or "bonn"
  std::vector<std::string> names;  // none = the usual ones
  std::string url_base;            // a mirror; "" = RDS_WEIGHTS_URL, else the publisher
  std::string out = ".";           // of sequences
};

// Fetches weights into the cache folder, sequences into `out`, showing progress on standard error, and prints paths.
// Throws InputError.
void Fetch(const FetchArguments& arguments);

// Adds the command; parsing it runs it.
void AddFetchCommand(CLI::App& program);

}  // namespace rds
