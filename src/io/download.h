// SPDX-License-Identifier: Apache-2.0
// Downloading a file over HTTP, going on where an earlier try stopped.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace rds {

// Bytes there so far (those of an earlier, interrupted run included), and in all.
using DownloadProgress = std::function<void(std::int64_t done, std::int64_t total)>;

struct DownloadResult {
  bool complete = false;        // the file has the size wanted
  bool worth_retrying = false;  // the connection broke; a refusal (404) is none
  std::string problem{};        // if not complete, for people; names the URL
};

// Appends to `file` what is missing of `bytes` from `url`; starts over where the server cannot continue or the file is
// too long. What has arrived stays on disk. Throws InputError if the file cannot be written (such as a full disk).
// `progress` may be empty.
[[nodiscard]] DownloadResult Download(const std::string& url, const std::filesystem::path& file, std::int64_t bytes,
                                      const DownloadProgress& progress);

// The size in bytes that the server says a file has. InputError naming the address where it cannot be told.
[[nodiscard]] std::int64_t RemoteSize(const std::string& url);

}  // namespace rds
