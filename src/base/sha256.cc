// SPDX-License-Identifier: Apache-2.0
#include "base/sha256.h"

#include <openssl/evp.h>
#include <spdlog/fmt/fmt.h>

#include <array>

#include "base/error.h"
#include "base/file.h"

namespace rds {

std::string Sha256OfText(std::string_view text) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  Check(EVP_Digest(text.data(), text.size(), digest.data(), &size, EVP_sha256(), nullptr) == 1, "OpenSSL has SHA-256");
  return fmt::format("{:02x}", fmt::join(digest.begin(), digest.begin() + size, ""));
}

std::string Sha256(const std::filesystem::path& file) { return Sha256OfText(ReadFile(file)); }

}  // namespace rds
