// SPDX-License-Identifier: Apache-2.0
#include "io/image_bytes.h"

#include <array>
#include <cstring>
#include <string_view>

#include "base/error.h"
#include "io/image_numbers.h"

namespace rds {
namespace {

constexpr std::string_view kPngSignature("\x89PNG\r\n\x1A\n", 8);
constexpr std::string_view kJpegSignature("\xFF\xD8\xFF", 3);

// Tables of CRC-32 (ISO 3309, as PNG has it) for eight bytes at a time.
constexpr auto kCrcTables = [] {
  std::array<std::array<std::uint32_t, 256>, 8> tables{};
  for (std::uint32_t n = 0; n < 256; ++n) {
    std::uint32_t c = n;
    for (int k = 0; k < 8; ++k) {
      c = (c & 1U) != 0 ? 0xEDB88320U ^ (c >> 1) : c >> 1;
    }
    tables[0][n] = c;
  }
  for (std::size_t t = 1; t < 8; ++t) {
    for (std::size_t n = 0; n < 256; ++n) {
      tables[t][n] = (tables[t - 1][n] >> 8) ^ tables[0][tables[t - 1][n] & 0xFFU];
    }
  }
  return tables;
}();

std::uint8_t Byte(std::string_view bytes, std::size_t at) { return static_cast<std::uint8_t>(bytes[at]); }

// Big-endian, as in both formats.
std::uint32_t Read16(std::string_view bytes, std::size_t at) {
  return (static_cast<std::uint32_t>(Byte(bytes, at)) << 8) | Byte(bytes, at + 1);
}
std::uint32_t Read32(std::string_view bytes, std::size_t at) {
  return (Read16(bytes, at) << 16) | Read16(bytes, at + 2);
}

std::uint32_t Crc32(std::string_view bytes) {
  const auto& t = kCrcTables;
  std::uint32_t crc = 0xFFFFFFFFU;
  std::size_t i = 0;
  for (; i + 8 <= bytes.size(); i += 8) {
    const auto at = [&](std::size_t k) { return Byte(bytes, i + k); };
    const std::uint32_t low = crc ^ (static_cast<std::uint32_t>(at(0)) | static_cast<std::uint32_t>(at(1)) << 8 |
                                     static_cast<std::uint32_t>(at(2)) << 16 | static_cast<std::uint32_t>(at(3)) << 24);
    crc = t[7][low & 0xFFU] ^ t[6][(low >> 8) & 0xFFU] ^ t[5][(low >> 16) & 0xFFU] ^ t[4][low >> 24] ^ t[3][at(4)] ^
          t[2][at(5)] ^ t[1][at(6)] ^ t[0][at(7)];
  }
  for (; i < bytes.size(); ++i) {
    crc = t[0][(crc ^ Byte(bytes, i)) & 0xFFU] ^ (crc >> 8);
  }
  return crc ^ 0xFFFFFFFFU;
}

ImageHeader ParsePngHeader(const std::filesystem::path& path, std::string_view data) {
  constexpr std::array<int, 7> kChannels = {1, 0, 3, 1, 2, 0, 4};  // by color type
  if (data.size() != 13 || Byte(data, 9) >= kChannels.size()) {
    throw Damaged(path);
  }
  return {ImageFormat::kPng, static_cast<int>(Read32(data, 0)), static_cast<int>(Read32(data, 4)), Byte(data, 8),
          kChannels[Byte(data, 9)]};
}

// PNG (ISO/IEC 15948): signature, then chunks of length, type, data and CRC of type and data, up to IEND.
ImageHeader InspectPng(const std::filesystem::path& path, std::string& bytes) {
  ImageHeader header;
  const std::string_view view = bytes;
  std::size_t kept = kPngSignature.size();
  for (std::size_t at = kept;;) {
    if (at + 12 > view.size()) {
      throw Truncated(path);
    }
    const std::size_t length = Read32(view, at);
    const std::size_t size = length + 12;
    if (size > view.size() - at) {
      throw Truncated(path);
    }
    const std::string_view type = view.substr(at + 4, 4);
    if (Crc32(view.substr(at + 4, length + 4)) != Read32(view, at + 8 + length)) {
      throw Damaged(path);
    }
    if (type == "IHDR") {
      header = ParsePngHeader(path, view.substr(at + 8, length));
    }
    const bool end = type == "IEND";
    const bool critical = (Byte(type, 0) & 0x20U) == 0;  // bit 5 of the first letter: ancillary
    if (critical) {
      std::memmove(bytes.data() + kept, bytes.data() + at, size);  // `at` and what follows stays as it is
      kept += size;
    }
    at += size;
    if (end) {
      bytes.resize(kept);
      return header;
    }
  }
}

// Position of the next marker's second byte in entropy-coded data: 0xFF not followed by 0 (a stuffed byte), a restart
// marker or another 0xFF (filling).
std::size_t SkipScan(const std::filesystem::path& path, std::string_view view, std::size_t at) {
  for (;;) {
    at = view.find('\xFF', at);
    if (at == std::string_view::npos || at + 1 >= view.size()) {
      throw Truncated(path);
    }
    const std::uint8_t next = Byte(view, ++at);
    if (next != 0 && next != 0xFF && (next < 0xD0 || next > 0xD7)) {
      return at;
    }
  }
}

// JPEG (ITU-T T.81, annex B): segments of marker, length and data, one right after the other; scans follow SOS; EOI
// ends the file.
ImageHeader InspectJpeg(const std::filesystem::path& path, std::string_view view) {
  ImageHeader header;
  header.format = ImageFormat::kJpeg;
  std::size_t at = 2;
  bool in_scan = false;
  for (;;) {
    const std::size_t next = SkipScan(path, view, at);
    const bool filled = view.substr(at, next - at).find_first_not_of('\xFF') == std::string_view::npos;
    at = next;
    const std::uint8_t marker = Byte(view, at++);
    if (marker == 0xD9) {
      return header;
    }
    if (marker < 0xC0 || marker == 0xD8 || (!in_scan && !filled)) {
      throw Damaged(path);
    }
    if (at + 2 > view.size() || Read16(view, at) > view.size() - at) {
      throw Truncated(path);
    }
    const std::size_t length = Read16(view, at);
    const bool is_frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (length < 2 || (is_frame && length < 8)) {
      throw Damaged(path);
    }
    if (is_frame) {
      header.bits = Byte(view, at + 2);
      header.height = static_cast<int>(Read16(view, at + 3));
      header.width = static_cast<int>(Read16(view, at + 5));
      header.channels = Byte(view, at + 7);
      if (header.channels != 1 && header.channels != 3) {
        throw InputError(path.string() + ": a JPEG image of " + std::to_string(header.channels) +
                         " channels, which is not read; convert it to PNG");
      }
    }
    in_scan = marker == 0xDA;
    at += length;
  }
}

}  // namespace

ImageHeader InspectImage(const std::filesystem::path& path, std::string& bytes) {
  if (bytes.empty()) {
    throw InputError(path.string() + ": the image file is empty; fetch or copy it again");
  }
  const std::string_view view = bytes;
  ImageHeader header;
  if (view.starts_with(kPngSignature)) {
    header = InspectPng(path, bytes);
  } else if (view.starts_with(kJpegSignature)) {
    header = InspectJpeg(path, view);
  } else if (kPngSignature.starts_with(view) || kJpegSignature.starts_with(view)) {
    throw Truncated(path);
  } else if (const auto other = InspectOtherImage(path, view)) {
    header = *other;
  } else {
    throw InputError(path.string() +
                     ": no image that is read here (PNG, JPEG, BMP, binary PPM and PGM, TIFF, WebP; depth also .npy)");
  }
  constexpr int kMostPixels = 20000;  // a side; more is no camera's picture but a damaged header
  if (header.width <= 0 || header.height <= 0 || header.width > kMostPixels || header.height > kMostPixels) {
    throw Damaged(path);
  }
  return header;
}

}  // namespace rds
