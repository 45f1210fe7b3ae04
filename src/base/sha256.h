// SPDX-License-Identifier: Apache-2.0
// Digests.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace rds {

// SHA-256 in hexadecimal. Re-entrant.
[[nodiscard]] std::string Sha256OfText(std::string_view text);

// The same of a file's bytes. Throws InputError if it cannot be read.
[[nodiscard]] std::string Sha256(const std::filesystem::path& file);

}  // namespace rds
