// SPDX-License-Identifier: Apache-2.0
// Headers of TIFF images, and whether what they compress is whole: the decoder hands out what it could not decode as it
// found its memory.
#include <array>
#include <optional>

#include "io/image_bytes.h"
#include "io/image_numbers.h"

namespace rds {
namespace {

// An entry of the directory: values of 1, 2 or 4 bytes, in place or elsewhere.
class Entry {
 public:
  Entry(const Numbers& numbers, std::size_t at) : numbers_(numbers) {
    const std::uint32_t type = numbers.U16(at + 2);
    size_ = type == 3 ? 2 : type == 4 ? 4 : 1;
    count_ = numbers.U32(at + 4);
    values_at_ = std::uint64_t{count_} * size_ <= 4 ? at + 8 : numbers.U32(at + 8);
  }
  [[nodiscard]] std::uint32_t count() const { return count_; }
  [[nodiscard]] std::uint32_t Value(std::size_t i = 0) const { return numbers_.At(values_at_ + i * size_, size_); }

 private:
  const Numbers& numbers_;
  std::size_t size_ = 1;
  std::uint32_t count_ = 0;
  std::size_t values_at_ = 0;
};

// Whether LZW codes (TIFF 6.0, section 13) unpack to so many bytes. Nothing is unpacked: the length of each code's
// string is enough.
bool UnpacksTo(std::string_view packed, std::size_t bytes) {
  constexpr std::uint32_t kClear = 256;
  constexpr std::uint32_t kEnd = 257;
  constexpr std::size_t kMostCodes = 4096;
  std::array<std::uint32_t, kMostCodes> length{};
  std::fill_n(length.begin(), kClear, 1U);
  std::uint32_t next = kEnd + 1;
  std::uint32_t before = 0;  // length of the string before; 0 = none since the table was cleared
  std::size_t bit = 0;
  std::size_t unpacked = 0;
  while (unpacked < bytes) {
    const std::uint32_t width = next < 511 ? 9 : next < 1023 ? 10 : next < 2047 ? 11 : 12;
    std::uint32_t code = 0;
    for (std::uint32_t i = 0; i < width; ++i, ++bit) {
      if (bit / 8 >= packed.size()) {
        return false;
      }
      code = (code << 1U) | ((static_cast<std::uint8_t>(packed[bit / 8]) >> (7 - bit % 8)) & 1U);
    }
    if (code == kClear) {
      next = kEnd + 1;
      before = 0;
      continue;
    }
    if (code == kEnd || code > next || (code == next && before == 0) || (before == 0 && code >= kClear)) {
      return false;
    }
    const std::uint32_t now = code == next ? before + 1 : length[code];
    if (before > 0) {
      if (next >= kMostCodes) {
        return false;
      }
      length[next++] = before + 1;
    }
    before = now;
    unpacked += now;
  }
  return true;
}

}  // namespace

// TIFF 6.0: header, then the first directory of tagged values.
ImageHeader InspectTiff(const std::filesystem::path& path, std::string_view bytes) {
  const Numbers numbers(path, bytes, bytes[0] == 'M');
  if (numbers.U16(2) != 42) {
    throw OfImage(path, "a BigTIFF image, which is not read; convert it to PNG");
  }
  const std::size_t directory = numbers.U32(4);
  const std::size_t count = numbers.U16(directory);
  std::array<std::optional<Entry>, 85> entries;  // by tag, from 256
  constexpr std::uint32_t kFirstTag = 256;
  constexpr std::uint32_t kAscii = 2;
  constexpr std::uint32_t kShort = 3;
  constexpr std::uint32_t kLong = 4;
  constexpr std::uint32_t kRational = 5;
  std::uint32_t before = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = directory + 2 + 12 * i;
    const std::uint32_t tag = numbers.U16(at);
    const std::uint32_t type = numbers.U16(at + 2);
    const bool known = tag >= kFirstTag && tag < kFirstTag + entries.size();
    if (tag <= before || (known && type != kShort && type != kLong && type != kRational && type != kAscii)) {
      throw Damaged(path);  // readers differ in what they make of it
    }
    before = tag;
    if (known) {
      entries[tag - kFirstTag].emplace(numbers, at);
    }
  }
  const auto value = [&](std::uint32_t tag, std::uint32_t fallback) {
    const auto& entry = entries[tag - kFirstTag];
    return entry && entry->count() > 0 ? entry->Value() : fallback;
  };
  ImageHeader header;
  header.format = ImageFormat::kTiff;
  header.width = SideOf(value(256, 0));
  header.height = SideOf(value(257, 0));
  header.bits = static_cast<int>(std::min(value(258, 1), 64U));
  header.channels = static_cast<int>(std::min(value(277, 1), 8U));
  const std::uint32_t compression = value(259, 1);
  const std::uint32_t photometric = value(262, 99);
  const std::uint32_t sample_format = value(339, 1);
  header.is_float = sample_format == 3;
  const auto& offsets = entries[273 - kFirstTag];
  const auto& sizes = entries[279 - kFirstTag];
  constexpr std::uint32_t kNone = 1;
  constexpr std::uint32_t kLzw = 5;
  const bool kind =
      (sample_format == 1 && (header.bits == 8 || header.bits == 16)) || (header.is_float && header.bits == 32);
  if (!kind || !offsets || !sizes || value(284, 1) != 1 || value(266, 1) != 1 || value(274, 1) != 1 ||
      !(photometric == 1 || (photometric == 2 && header.channels >= 3)) || value(317, 1) > 3 ||
      (compression != kNone && compression != kLzw)) {
    throw OfImage(path,
                  "a TIFF image of a kind that is not read (tiles, planes, a palette, turned, compressed otherwise "
                  "than by LZW); convert it to PNG");
  }
  const auto& bits = entries[258 - kFirstTag];  // of each channel; they must agree
  if (!bits || static_cast<int>(bits->count()) != header.channels) {
    throw Damaged(path);
  }
  for (std::uint32_t i = 1; i < bits->count(); ++i) {
    if (static_cast<int>(bits->Value(i)) != header.bits) {
      throw Damaged(path);
    }
  }
  if (header.width <= 0 || header.height <= 0) {
    throw Damaged(path);
  }
  const auto height = static_cast<std::uint32_t>(header.height);
  const std::uint32_t rows = std::min(value(278, height), height);
  if (rows == 0 || offsets->count() != (height + rows - 1) / rows || sizes->count() != offsets->count()) {
    throw Damaged(path);
  }
  const std::uint64_t row_bytes = static_cast<std::uint64_t>(header.width) *
                                  static_cast<std::uint64_t>(header.channels) *
                                  static_cast<std::uint64_t>(header.bits / 8);
  for (std::uint32_t k = 0; k < offsets->count(); ++k) {
    const std::uint64_t at = offsets->Value(k);
    const std::uint64_t size = sizes->Value(k);
    if (at + size > bytes.size()) {
      throw Truncated(path);
    }
    const std::uint64_t wanted = row_bytes * std::min(rows, height - k * rows);
    if ((compression == kNone && size < wanted) ||
        (compression == kLzw && !UnpacksTo(bytes.substr(at, size), wanted))) {
      throw Damaged(path);
    }
  }
  return header;
}

}  // namespace rds
