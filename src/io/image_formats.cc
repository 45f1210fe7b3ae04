// SPDX-License-Identifier: Apache-2.0
// Headers of the image formats beside PNG and JPEG.
#include <array>
#include <charconv>
#include <limits>
#include <string_view>

#include "base/error.h"
#include "base/text.h"
#include "io/image_bytes.h"
#include "io/image_numbers.h"

namespace rds {
namespace {

void NeedBytes(const std::filesystem::path& path, const ImageHeader& header, std::size_t there) {
  const std::uint64_t wanted = static_cast<std::uint64_t>(header.width) * static_cast<std::uint64_t>(header.height) *
                               static_cast<std::uint64_t>(header.channels) *
                               static_cast<std::uint64_t>(header.bits / 8);
  if (wanted > there) {
    throw Truncated(path);
  }
}

// Binary PGM (P5) and PPM (P6): words with comments between them, one blank, pixels.
ImageHeader InspectPnm(const std::filesystem::path& path, std::string_view bytes) {
  constexpr std::string_view kBlanks = " \t\r\n";
  if (bytes.size() < 3 || kBlanks.find(bytes[2]) == std::string_view::npos) {
    throw Damaged(path);
  }
  std::size_t at = 2;
  const auto number = [&] {
    while (at < bytes.size() && (kBlanks.find(bytes[at]) != std::string_view::npos || bytes[at] == '#')) {
      at = bytes[at] == '#' ? std::min(bytes.find('\n', at), bytes.size()) : at + 1;
    }
    int value = 0;
    const char* const end = bytes.data() + bytes.size();
    const auto [stop, error] = std::from_chars(bytes.data() + std::min(at, bytes.size()), end, value);
    if (error != std::errc{} || value <= 0 || (stop != end && kBlanks.find(*stop) == std::string_view::npos)) {
      throw Damaged(path);
    }
    at = static_cast<std::size_t>(stop - bytes.data());
    return value;
  };
  ImageHeader header;
  header.format = ImageFormat::kPnm;
  header.channels = bytes[1] == '6' ? 3 : 1;
  header.width = number();
  header.height = number();
  const int largest = number();
  if (largest > 65535 || (largest < 255 && header.channels == 3)) {
    throw OfImage(path, "its largest value is " + std::to_string(largest) + "; 255 or 65535 is wanted");
  }
  header.bits = largest > 255 ? 16 : 8;
  header.data_at = at + 1;
  NeedBytes(path, header, bytes.size() - std::min(header.data_at, bytes.size()));
  return header;
}

ImageHeader InspectBmp(const std::filesystem::path& path, std::string_view bytes) {
  const Numbers numbers(path, bytes, false);
  const std::uint32_t pixels_at = numbers.U32(10);
  ImageHeader header;
  header.format = ImageFormat::kBmp;
  header.width = SideOf(numbers.U32(18));
  const auto height = static_cast<std::int32_t>(numbers.U32(22));
  header.height = SideOf(static_cast<std::uint32_t>(std::abs(static_cast<std::int64_t>(height))));
  const std::uint32_t bits = numbers.U16(28);
  const std::uint32_t compression = numbers.U32(30);
  const std::uint32_t kind = numbers.U32(14);  // by the size of its header
  const std::uint32_t colors = std::min(numbers.U32(46), 256U);
  const std::uint32_t masks = compression == 3 && kind == 40 ? 3 : 0;
  const std::uint32_t between = bits == 8 ? (colors == 0 ? 256 : colors) : masks;  // words before the pixels
  if ((kind != 40 && kind != 108 && kind != 124) || numbers.U16(26) != 1 || (bits != 8 && bits != 24 && bits != 32) ||
      !(compression == 0 || (compression == 3 && bits == 32)) || pixels_at != 14 + kind + 4 * between) {
    throw OfImage(path, "a BMP image of a kind that is not read; convert it to PNG");
  }
  header.channels = bits == 8 ? 1 : static_cast<int>(bits / 8);
  const std::uint64_t row = (static_cast<std::uint64_t>(header.width) * bits + 31) / 32 * 4;
  if (pixels_at > bytes.size() || row * static_cast<std::uint64_t>(header.height) > bytes.size() - pixels_at) {
    throw Truncated(path);
  }
  return header;
}

// WebP: a RIFF file whose first chunk says the size.
ImageHeader InspectWebp(const std::filesystem::path& path, std::string_view bytes) {
  const Numbers numbers(path, bytes, false);
  if (std::uint64_t{numbers.U32(4)} + 8 > bytes.size()) {
    throw Truncated(path);
  }
  ImageHeader header;
  header.format = ImageFormat::kWebp;
  header.channels = 3;
  const std::string_view kind = bytes.substr(12, 4);
  const std::uint64_t chunk = numbers.U32(16);
  if (kind != "VP8X" && chunk + chunk % 2 + 12 != numbers.U32(4)) {  // it is all that the file holds
    throw Damaged(path);
  }
  if (kind == "VP8 ") {
    header.width = SideOf(numbers.U16(26) & 0x3FFFU);
    header.height = SideOf(numbers.U16(28) & 0x3FFFU);
  } else if (kind == "VP8L") {
    const std::uint32_t sizes = numbers.U32(21);
    header.width = SideOf((sizes & 0x3FFFU) + 1);
    header.height = SideOf(((sizes >> 14U) & 0x3FFFU) + 1);
  } else if (kind == "VP8X" && (numbers.At(20, 1) & 2U) == 0) {  // not animated
    header.width = SideOf(numbers.At(24, 3) + 1);
    header.height = SideOf(numbers.At(27, 3) + 1);
  } else {
    throw Damaged(path);
  }
  return header;
}

// NumPy's .npy: a dictionary in Python's words, as NumPy writes it, filled up with blanks; then the array.
ImageHeader InspectNpy(const std::filesystem::path& path, std::string_view bytes) {
  const Numbers numbers(path, bytes, false);
  const std::uint32_t version = numbers.At(6, 1);
  const std::size_t text_at = version == 1 ? 10 : 12;
  const std::size_t length = version == 1 ? numbers.U16(8) : numbers.U32(8);
  if (text_at > bytes.size() || length > bytes.size() - text_at) {
    throw Truncated(path);
  }
  std::string_view text = bytes.substr(text_at, length);
  text = Trimmed(text);
  constexpr std::string_view kBegin = "{'descr': '";
  constexpr std::string_view kMiddle = "', 'fortran_order': False, 'shape': (";
  const std::string_view type = text.substr(std::min(kBegin.size(), text.size()), 3);
  const std::string_view shape = text.substr(std::min(kBegin.size() + type.size() + kMiddle.size(), text.size()));
  ImageHeader header;
  header.format = ImageFormat::kNpy;
  const char* const end = shape.data() + shape.size();
  const char* const width_at = std::min(std::from_chars(shape.data(), end, header.height).ptr + 2, end);
  std::from_chars(width_at, end, header.width);
  const std::string as_written = std::string(kBegin) + std::string(type) + std::string(kMiddle) +
                                 std::to_string(header.height) + ", " + std::to_string(header.width) + "), }";
  header.big_endian = type.starts_with('>');
  header.is_float = type.ends_with("f4") || type.ends_with("f8");
  header.bits = type.ends_with("f8") ? 64 : type.ends_with("f4") ? 32 : 16;
  const bool known = (type.starts_with('<') || type.starts_with('>')) && (header.is_float || type.ends_with("u2"));
  if (version < 1 || version > 3 || numbers.At(7, 1) != 0 || !known || text != as_written || header.width <= 0 ||
      header.height <= 0) {
    throw OfImage(path,
                  "a NumPy array of a kind that is not read: wanted is one of height x width, by rows, of float32, "
                  "float64 (meters) or uint16");
  }
  header.data_at = text_at + length;
  NeedBytes(path, header, bytes.size() - header.data_at);
  return header;
}

// What is known by its first bytes, and not read.
void RefuseKnown(const std::filesystem::path& path, std::string_view bytes) {
  struct Known {
    std::string_view signature;
    const char* what;
  };
  static constexpr std::array<Known, 8> kKnown = {{
      {std::string_view("\x76\x2F\x31\x01", 4), "an OpenEXR image, which is not read; convert depth to 16-bit PNG"},
      {"version https://git-lfs", "a Git LFS pointer, not the image itself; run `git lfs pull` in its repository"},
      {"GIF8", "a GIF image, which is not read; convert it to PNG"},
      {"Pf", "a PFM image, which is not read; convert depth to 16-bit PNG, float TIFF or .npy"},
      {"P2", "a PGM image written as text, which is not read; convert it to PNG"},
      {"P3", "a PPM image written as text, which is not read; convert it to PNG"},
      {"<!DOCTYPE", "a web page, not an image; fetch it again"},
      {"<html", "a web page, not an image; fetch it again"},
  }};
  for (const Known& known : kKnown) {
    if (bytes.starts_with(known.signature)) {
      throw OfImage(path, known.what);
    }
  }
}

}  // namespace

std::optional<ImageHeader> InspectOtherImage(const std::filesystem::path& path, std::string_view bytes) {
  RefuseKnown(path, bytes);
  if (bytes.starts_with("P5") || bytes.starts_with("P6")) {
    return InspectPnm(path, bytes);
  }
  if (bytes.starts_with("BM")) {
    return InspectBmp(path, bytes);
  }
  if (bytes.size() >= 4 && (bytes.starts_with("II") || bytes.starts_with("MM")) &&
      (bytes[2] == 42 || bytes[3] == 42 || bytes[2] == 43 || bytes[3] == 43)) {
    return InspectTiff(path, bytes);
  }
  if (bytes.starts_with("RIFF") && bytes.size() >= 16 && bytes.substr(8, 4) == "WEBP") {
    return InspectWebp(path, bytes);
  }
  if (bytes.starts_with("\x93NUMPY")) {
    return InspectNpy(path, bytes);
  }
  return std::nullopt;
}

}  // namespace rds
