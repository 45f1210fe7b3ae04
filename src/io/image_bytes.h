// SPDX-License-Identifier: Apache-2.0
// What the bytes of an image file say before anything is decoded. Decoders hand out the upper part of a truncated
// picture with a mere warning on standard error; here a file is whole or an error.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace rds {

enum class ImageFormat : std::uint8_t { kPng, kJpeg, kPnm, kBmp, kTiff, kWebp, kNpy };

struct ImageHeader {
  ImageFormat format = ImageFormat::kPng;
  int width = 0;
  int height = 0;
  int bits = 8;             // of a channel
  int channels = 1;         // 1 also for a picture with a palette
  bool is_float = false;    // TIFF and NumPy: depth in meters
  std::size_t data_at = 0;  // PNM and NumPy, which are decoded here: where the pixels begin
  bool big_endian = false;  // NumPy
};

// Walks through the file's structure to its end; a PNG's checksums are verified. `bytes` are changed only in that a PNG
// loses its ancillary chunks (color profiles and texts, of which decoders complain). InputError naming `path` for a
// file that is empty, of no format that is read (with what to do), truncated or damaged. Stateless.
ImageHeader InspectImage(const std::filesystem::path& path, std::string& bytes);

// The header of TIFF bytes.
ImageHeader InspectTiff(const std::filesystem::path& path, std::string_view bytes);

// The same for the formats beside PNG and JPEG; nothing for bytes that are none of them.
std::optional<ImageHeader> InspectOtherImage(const std::filesystem::path& path, std::string_view bytes);

}  // namespace rds
