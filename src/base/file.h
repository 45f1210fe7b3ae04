// SPDX-License-Identifier: Apache-2.0
// Whole files, read safely.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace rds {

inline constexpr std::size_t kLargestFile_bytes = std::size_t{1} << 30U;

// All bytes of a regular file. InputError naming it and the reason if it cannot be read, is none (a pipe, a device, a
// folder: those may have no end) or has more than `most_bytes`. Any thread.
[[nodiscard]] std::string ReadFile(const std::filesystem::path& path, std::size_t most_bytes = kLargestFile_bytes);

}  // namespace rds
