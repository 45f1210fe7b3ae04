// What the bytes of a PNG or JPEG file say before anything is decoded. Decoders hand out the upper part of a truncated
// picture with a mere warning on standard error; here a file is whole or an error.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace rds {

enum class ImageFormat : std::uint8_t { kPng, kJpeg };

struct ImageHeader {
  ImageFormat format = ImageFormat::kPng;
  int width = 0;
  int height = 0;
  int bits = 8;      // of a channel
  int channels = 1;  // 1 also for a PNG with a palette
};

// Walks through the file's chunks or segments to its end; a PNG's checksums are verified. `bytes` are changed only in
// that a PNG loses its ancillary chunks (colour profiles and texts, of which decoders complain). InputError naming
// `path` for a file that is empty, neither PNG nor JPEG, truncated or damaged. Stateless.
ImageHeader InspectImage(const std::filesystem::path& path, std::string& bytes);

}  // namespace rds
