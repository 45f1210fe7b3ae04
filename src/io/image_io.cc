// SPDX-License-Identifier: Apache-2.0
#include "io/image_io.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <type_traits>

#include "base/error.h"
#include "base/file.h"

namespace rds {
namespace {

constexpr std::size_t kLargestImageFile_bytes = 512U << 20U;

InputError CannotDecode(const std::filesystem::path& path) {
  return InputError(path.string() + ": the image file is damaged: it cannot be decoded; fetch or copy it again");
}

// By OpenCV, into memory of its own: into memory that is given, some of its decoders fail without a word. Only formats
// that InspectImage knows get here, so no other decoder is ever reached.
template <typename T>
Image<T> DecodeByLibrary(const std::filesystem::path& path, std::string& bytes, const ImageHeader& header, int flags,
                         int channels) {
  const cv::Mat input(1, static_cast<int>(bytes.size()), CV_8UC1, bytes.data());
  cv::Mat decoded;
  try {
    decoded = cv::imdecode(input, flags | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception& error) {
    if (error.code == cv::Error::StsNoMem) {
      throw std::bad_alloc();
    }
    throw CannotDecode(path);
  }
  if (decoded.rows != header.height || decoded.cols != header.width ||
      decoded.type() != CV_MAKETYPE(cv::DataType<T>::depth, channels)) {
    throw CannotDecode(path);
  }
  return Image<T>::Copy(decoded.ptr<T>(), decoded.cols, decoded.rows, channels, decoded.step);
}

// One number of an array in the file.
template <typename T>
T NumberAt(const std::string& bytes, std::size_t at, bool big_endian) {
  using Bits = std::conditional_t<sizeof(T) == 8, std::uint64_t,
                                  std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint16_t>>;
  Bits bits = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    const std::size_t byte = big_endian ? i : sizeof(T) - 1 - i;
    bits = static_cast<Bits>((std::uint64_t{bits} << 8U) | static_cast<std::uint8_t>(bytes[at + byte]));
  }
  return std::bit_cast<T>(bits);
}

std::uint16_t DepthUnits(double depth_m, double units_per_m) {
  const double units = std::round(depth_m * units_per_m);
  return units > 0 && units < std::numeric_limits<std::uint16_t>::max() ? static_cast<std::uint16_t>(units) : 0;
}

// Pixels as PGM, PPM and NumPy have them: one number after the other.
Image16 DecodePlain16(const std::string& bytes, const ImageHeader& header, double units_per_m) {
  Image16 image(header.width, header.height, header.channels);
  const bool big_endian = header.format == ImageFormat::kPnm || header.big_endian;
  const auto size = static_cast<std::size_t>(header.bits / 8);
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    const std::size_t at = header.data_at + i * size;
    image.data[i] = header.bits == 64 ? DepthUnits(NumberAt<double>(bytes, at, big_endian), units_per_m)
                    : header.bits == 32
                        ? DepthUnits(static_cast<double>(NumberAt<float>(bytes, at, big_endian)), units_per_m)
                        : NumberAt<std::uint16_t>(bytes, at, big_endian);
  }
  return image;
}

// PGM and PPM of 8 bits, as BGR.
Image8 DecodePnmColor(const std::string& bytes, const ImageHeader& header) {
  Image8 image(header.width, header.height, 3);
  const auto channels = static_cast<std::size_t>(header.channels);
  const auto pixels = static_cast<std::size_t>(header.width) * static_cast<std::size_t>(header.height);
  for (std::size_t i = 0; i < pixels; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t from = channels == 1 ? 0 : 2 - c;
      image.data[3 * i + c] = static_cast<std::uint8_t>(bytes[header.data_at + i * channels + from]);
    }
  }
  return image;
}

template <typename T>
std::string EncodeAsPng(const Image<T>& image, int depth, int compression) {
  const cv::Mat view(image.height, image.width, CV_MAKETYPE(depth, image.channels), const_cast<T*>(image.data.data()));
  std::vector<std::uint8_t> bytes;
  Check(cv::imencode(".png", view, bytes, {cv::IMWRITE_PNG_COMPRESSION, compression}), "a PNG can be encoded");
  return {bytes.begin(), bytes.end()};
}

}  // namespace

ImageFile::ImageFile(const std::filesystem::path& path) : ImageFile(path, ReadFile(path, kLargestImageFile_bytes)) {}

ImageFile::ImageFile(const std::filesystem::path& name, std::string bytes)
    : path_(name), bytes_(std::move(bytes)), header_(InspectImage(name, bytes_)) {}

bool ImageFile::MayBeDepth() const { return header_.channels == 1 && (header_.bits == 16 || header_.is_float); }

Image8 ImageFile::DecodeColor() {
  if (header_.bits > 8 || header_.is_float) {
    throw InputError(path_.string() + ": a color image of " + std::to_string(header_.bits) +
                     " bits a channel; 8 are wanted (is it a depth image, the lists' columns swapped?)");
  }
  return header_.format == ImageFormat::kPnm
             ? DecodePnmColor(bytes_, header_)
             : DecodeByLibrary<std::uint8_t>(path_, bytes_, header_, cv::IMREAD_COLOR, 3);
}

Image16 ImageFile::DecodeDepth(double units_per_m) {
  if (!MayBeDepth()) {
    throw InputError(path_.string() + ": a depth image of " + std::to_string(header_.bits) + " bits and " +
                     std::to_string(header_.channels) + (header_.channels == 1 ? " channel" : " channels") +
                     "; one channel is wanted, of 16 bits in the units of the camera file's depth_scale (5000 a meter "
                     "for TUM), best as PNG, or floating point in meters (TIFF, .npy)");
  }
  if (header_.format == ImageFormat::kPnm || header_.format == ImageFormat::kNpy) {
    return DecodePlain16(bytes_, header_, units_per_m);
  }
  if (!header_.is_float) {
    return DecodeByLibrary<std::uint16_t>(path_, bytes_, header_, cv::IMREAD_UNCHANGED, 1);
  }
  const Image<float> meters = DecodeByLibrary<float>(path_, bytes_, header_, cv::IMREAD_UNCHANGED, 1);
  Image16 depth(meters.width, meters.height);
  std::transform(meters.data.begin(), meters.data.end(), depth.data.begin(),
                 [&](float m) { return DepthUnits(static_cast<double>(m), units_per_m); });
  return depth;
}

Image8 ImageFile::DecodeMask(bool keep_unsure) {
  if (header_.bits > 8 || header_.is_float) {
    throw InputError(path_.string() + ": a mask of " + std::to_string(header_.bits) +
                     " bits a channel; 8 are wanted, 0 for what does not move");
  }
  const Image8 color = DecodeColor();
  Image8 mask(color.width, color.height);
  for (std::size_t i = 0; i < mask.data.size(); ++i) {
    const std::uint8_t* const pixel = color.data.data() + 3 * i;
    const int value = pixel[0] | pixel[1] | pixel[2];
    mask.data[i] = keep_unsure && value == 128 ? 128 : value != 0 ? 255 : 0;
  }
  return mask;
}

Image8 ReadColor(const std::filesystem::path& path) { return ImageFile(path).DecodeColor(); }

Image16 ReadDepth(const std::filesystem::path& path) { return ImageFile(path).DecodeDepth(5000); }

Image8 ReadMask(const std::filesystem::path& path) { return ImageFile(path).DecodeMask(); }

std::string EncodePng(const Image8& image, int compression) { return EncodeAsPng(image, CV_8U, compression); }

std::string EncodePng(const Image16& image, int compression) { return EncodeAsPng(image, CV_16U, compression); }

}  // namespace rds
