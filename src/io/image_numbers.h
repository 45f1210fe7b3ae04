// SPDX-License-Identifier: Apache-2.0
// What the readers of image headers share.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/error.h"

namespace rds {

inline InputError OfImage(const std::filesystem::path& path, const std::string& what) {
  return InputError(path.string() + ": " + what);
}
inline InputError Truncated(const std::filesystem::path& path) {
  return OfImage(path, "the image file is truncated; fetch or copy it again");
}
inline InputError Damaged(const std::filesystem::path& path) {
  return OfImage(path, "the image file is damaged; fetch or copy it again");
}

// Unsigned numbers of a file, from a position that must lie in it.
class Numbers {
 public:
  Numbers(const std::filesystem::path& path, std::string_view bytes, bool big_endian)
      : path_(path), bytes_(bytes), big_endian_(big_endian) {}

  [[nodiscard]] std::uint32_t At(std::size_t at, std::size_t size) const {
    if (at > bytes_.size() || size > bytes_.size() - at) {
      throw Truncated(path_);
    }
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t byte = big_endian_ ? i : size - 1 - i;
      value = (value << 8U) | static_cast<std::uint8_t>(bytes_[at + byte]);
    }
    return value;
  }
  [[nodiscard]] std::uint32_t U16(std::size_t at) const { return At(at, 2); }
  [[nodiscard]] std::uint32_t U32(std::size_t at) const { return At(at, 4); }

 private:
  const std::filesystem::path& path_;
  std::string_view bytes_;
  bool big_endian_;
};

inline int SideOf(std::uint32_t value) {
  constexpr std::uint32_t kMost = 1U << 24U;  // the caller's bound is lower
  return static_cast<int>(std::min(value, kMost));
}

}  // namespace rds
