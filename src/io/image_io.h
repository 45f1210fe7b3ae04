// SPDX-License-Identifier: Apache-2.0
// Images from files.
#pragma once

#include <filesystem>
#include <string>

#include "base/image.h"
#include "io/image_bytes.h"

namespace rds {

// A file whose structure has been checked, before anything is decoded: its size is known without the memory it takes.
// Decoding throws InputError naming the file, what is wrong and what to do. A value; any thread may have one.
class ImageFile {
 public:
  // Reads PNG, JPEG, BMP, binary PGM and PPM, TIFF, WebP and NumPy files; InputError for anything else.
  explicit ImageFile(const std::filesystem::path& path);
  // The same of bytes that are in memory; `name` for messages.
  ImageFile(const std::filesystem::path& name, std::string bytes);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] int width() const { return header_.width; }
  [[nodiscard]] int height() const { return header_.height; }
  // Whether it can be depth: 16 bits or floating point, one channel.
  [[nodiscard]] bool MayBeDepth() const;

  // BGR, three channels (a gray picture gives three equal ones). An orientation tag is ignored.
  [[nodiscard]] Image8 DecodeColor();
  // Depth as stored, in units of `units_per_m`: one channel of 16 bits; an 8-bit picture is an error, not stretched.
  // Floating point is meters; what is not finite, not above 0 or beyond 16 bits is no depth (0).
  [[nodiscard]] Image16 DecodeDepth(double units_per_m);
  // A mask, one channel: 255 where the file is not 0 (any channel), else 0. With `keep_unsure`, 128 stays 128 (as
  // segmentation/mask.h has it).
  [[nodiscard]] Image8 DecodeMask(bool keep_unsure = false);

 private:
  std::filesystem::path path_;
  std::string bytes_;
  ImageHeader header_;
};

// The same in one step.
Image8 ReadColor(const std::filesystem::path& path);
Image16 ReadDepth(const std::filesystem::path& path);  // floating point as 5000 units a meter
Image8 ReadMask(const std::filesystem::path& path);

// The bytes of a PNG of one channel or three, for WriteFileAtomically: libraries that write files themselves do not say
// that a disk is full. `compression`: 0 to 9.
[[nodiscard]] std::string EncodePng(const Image8& image, int compression = 3);
[[nodiscard]] std::string EncodePng(const Image16& image, int compression = 3);

}  // namespace rds
