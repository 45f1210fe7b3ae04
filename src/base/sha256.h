// Digests of files.
#pragma once

#include <filesystem>
#include <string>

namespace rds {

// SHA-256 of a file's bytes, in hexadecimal. Throws InputError if it cannot be read. Re-entrant.
[[nodiscard]] std::string Sha256(const std::filesystem::path& file);

}  // namespace rds
