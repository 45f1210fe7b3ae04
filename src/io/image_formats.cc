// Headers of the image formats beside PNG and JPEG.
#include <array>
#include <charconv>
#include <cstring>
#include <limits>
#include <string_view>

#include "base/error.h"
#include "io/image_bytes.h"

namespace rds {
namespace {

InputError OfImage(const std::filesystem::path& path, const std::string& what) {
  return InputError(path.string() + ": " + what);
}
InputError CutShort(const std::filesystem::path& path) {
  return OfImage(path, "the image file is truncated; fetch or copy it again");
}
InputError Broken(const std::filesystem::path& path) {
  return OfImage(path, "the image file is damaged; fetch or copy it again");
}

// Unsigned numbers of a file, from a position that must lie in it.
class Numbers {
 public:
  Numbers(const std::filesystem::path& path, std::string_view bytes, bool big_endian)
      : path_(path), bytes_(bytes), big_endian_(big_endian) {}

  [[nodiscard]] std::uint32_t At(std::size_t at, std::size_t size) const {
    if (at > bytes_.size() || size > bytes_.size() - at) {
      throw CutShort(path_);
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

int SideOf(std::uint32_t value) {
  constexpr std::uint32_t kMost = 1U << 24U;  // the caller's bound is lower
  return static_cast<int>(std::min(value, kMost));
}

void NeedBytes(const std::filesystem::path& path, const ImageHeader& header, std::size_t there) {
  const std::uint64_t wanted = static_cast<std::uint64_t>(header.width) * static_cast<std::uint64_t>(header.height) *
                               static_cast<std::uint64_t>(header.channels) *
                               static_cast<std::uint64_t>(header.bits / 8);
  if (wanted > there) {
    throw CutShort(path);
  }
}

// Binary PGM (P5) and PPM (P6): words with comments between them, one blank, pixels.
ImageHeader InspectPnm(const std::filesystem::path& path, std::string_view bytes) {
  std::size_t at = 2;
  const auto number = [&] {
    while (at < bytes.size() && (std::strchr(" \t\r\n", bytes[at]) != nullptr || bytes[at] == '#')) {
      at = bytes[at] == '#' ? std::min(bytes.find('\n', at), bytes.size()) : at + 1;
    }
    int value = 0;
    const auto [stop, error] = std::from_chars(bytes.data() + at, bytes.data() + bytes.size(), value);
    if (error != std::errc{} || value <= 0) {
      throw Broken(path);
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
  if (numbers.U32(14) < 40 || numbers.U16(26) != 1 || (bits != 8 && bits != 24 && bits != 32) ||
      !(compression == 0 || (compression == 3 && bits == 32))) {
    throw OfImage(path, "a BMP image of a kind that is not read; convert it to PNG");
  }
  header.channels = bits == 8 ? 1 : static_cast<int>(bits / 8);
  const std::uint64_t row = (static_cast<std::uint64_t>(header.width) * bits + 31) / 32 * 4;
  if (pixels_at > bytes.size() || row * static_cast<std::uint64_t>(header.height) > bytes.size() - pixels_at) {
    throw CutShort(path);
  }
  return header;
}

// TIFF 6.0: header, then the first directory of tagged values.
ImageHeader InspectTiff(const std::filesystem::path& path, std::string_view bytes) {
  const Numbers numbers(path, bytes, bytes[0] == 'M');
  if (numbers.U16(2) != 42) {
    throw OfImage(path, "a BigTIFF image, which is not read; convert it to PNG");
  }
  const std::size_t directory = numbers.U32(4);
  const std::size_t count = numbers.U16(directory);
  ImageHeader header;
  header.format = ImageFormat::kTiff;
  header.bits = 1;
  std::uint32_t sample_format = 1;
  std::size_t offsets_at = 0;
  std::size_t sizes_at = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = directory + 2 + 12 * i;
    const std::uint32_t type = numbers.U16(at + 2);
    const std::uint32_t values = numbers.U32(at + 4);
    const std::size_t size = type == 3 ? 2 : type == 4 ? 4 : 1;
    const std::size_t value_at = values * size <= 4 ? at + 8 : numbers.U32(at + 8);
    const auto value = [&](std::size_t k) { return numbers.At(value_at + k * size, size); };
    switch (numbers.U16(at)) {
      case 256:
        header.width = SideOf(value(0));
        break;
      case 257:
        header.height = SideOf(value(0));
        break;
      case 258:
        header.bits = static_cast<int>(value(0));
        break;
      case 277:
        header.channels = static_cast<int>(value(0));
        break;
      case 339:
        sample_format = value(0);
        break;
      case 273:
      case 324:  // strips or tiles
        offsets_at = at;
        break;
      case 279:
      case 325:
        sizes_at = at;
        break;
      default:
        break;
    }
  }
  if (offsets_at == 0 || sizes_at == 0) {
    throw Broken(path);
  }
  const auto entry = [&](std::size_t at, std::size_t k) -> std::uint64_t {
    const std::size_t size = numbers.U16(at + 2) == 3 ? 2 : 4;
    const std::uint32_t values = numbers.U32(at + 4);
    return numbers.At((values * size <= 4 ? at + 8 : numbers.U32(at + 8)) + k * size, size);
  };
  const std::uint32_t pieces = numbers.U32(offsets_at + 4);
  if (pieces == 0 || pieces != numbers.U32(sizes_at + 4)) {
    throw Broken(path);
  }
  for (std::uint32_t k = 0; k < pieces; ++k) {
    if (entry(offsets_at, k) + entry(sizes_at, k) > bytes.size()) {
      throw CutShort(path);
    }
  }
  header.is_float = sample_format == 3;
  if (sample_format != 1 && !(header.is_float && header.bits == 32)) {
    throw OfImage(path, "a TIFF image of a kind of numbers that is not read; convert it to 16-bit PNG");
  }
  return header;
}

// WebP: a RIFF file whose first chunk says the size.
ImageHeader InspectWebp(const std::filesystem::path& path, std::string_view bytes) {
  const Numbers numbers(path, bytes, false);
  if (std::uint64_t{numbers.U32(4)} + 8 > bytes.size()) {
    throw CutShort(path);
  }
  ImageHeader header;
  header.format = ImageFormat::kWebp;
  header.channels = 3;
  const std::string_view kind = bytes.substr(12, 4);
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
    throw Broken(path);
  }
  return header;
}

// NumPy's .npy: a dictionary in Python's words, then the array.
ImageHeader InspectNpy(const std::filesystem::path& path, std::string_view bytes) {
  const Numbers numbers(path, bytes, false);
  const bool first_version = numbers.At(6, 1) == 1;
  const std::size_t text_at = first_version ? 10 : 12;
  const std::size_t length = first_version ? numbers.U16(8) : numbers.U32(8);
  if (text_at > bytes.size() || length > bytes.size() - text_at) {
    throw CutShort(path);
  }
  const std::string_view text = bytes.substr(text_at, length);
  const auto after = [&](std::string_view key) {
    const std::size_t at = text.find(key);
    return at == std::string_view::npos ? std::string_view() : text.substr(at + key.size());
  };
  ImageHeader header;
  header.format = ImageFormat::kNpy;
  header.data_at = text_at + length;
  const std::string_view type = after("'descr': '").substr(0, 3);
  header.big_endian = type.starts_with('>');
  header.is_float = type.ends_with("f4") || type.ends_with("f8");
  header.bits = type.ends_with("f8") ? 64 : type.ends_with("f4") ? 32 : 16;
  if (!(header.is_float || type.ends_with("u2")) || !after("'fortran_order': ").starts_with("False")) {
    throw OfImage(path, "a NumPy array of a kind that is not read: float32, float64 (metres) or uint16, by rows");
  }
  const std::string_view shape = after("'shape': (");
  const char* const end = shape.data() + shape.size();
  const auto [comma, first_error] = std::from_chars(shape.data(), end, header.height);
  if (first_error != std::errc{} ||
      std::string_view(comma, static_cast<std::size_t>(end - comma)).substr(0, 2) != ", ") {
    throw OfImage(path, "a NumPy array of height x width is wanted");
  }
  const auto [stop, second_error] = std::from_chars(comma + 2, end, header.width);
  if (second_error != std::errc{} || stop == end || *stop != ')' || header.width <= 0 || header.height <= 0) {
    throw OfImage(path, "a NumPy array of height x width is wanted");
  }
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
