#include "io/image_io.h"

#include <opencv2/imgcodecs.hpp>
#include <string>

#include "base/error.h"
#include "io/image_bytes.h"
#include "io/text_table.h"

namespace rds {
namespace {

struct ImageFile {
  std::string bytes;
  ImageHeader header;
};

ImageFile ReadImageFile(const std::filesystem::path& path) {
  ImageFile file;
  file.bytes = ReadFile(path);
  file.header = InspectImage(path, file.bytes);
  return file;
}

// Decodes straight into the image's memory.
template <typename T>
Image<T> Decode(const std::filesystem::path& path, ImageFile& file, int flags, int channels) {
  Image<T> image(file.header.width, file.header.height, channels);
  const int type = CV_MAKETYPE(cv::DataType<T>::depth, channels);
  cv::Mat target(image.height, image.width, type, image.data.data());
  const cv::Mat bytes(1, static_cast<int>(file.bytes.size()), CV_8UC1, file.bytes.data());
  try {
    cv::imdecode(bytes, flags | cv::IMREAD_IGNORE_ORIENTATION, &target);
  } catch (const cv::Exception&) {
    target.release();
  }
  if (target.rows != image.height || target.cols != image.width || target.type() != type ||
      target.data != reinterpret_cast<const unsigned char*>(image.data.data())) {
    throw InputError(path.string() + ": the image file is damaged: it cannot be decoded; fetch or copy it again");
  }
  return image;
}

}  // namespace

Image8 ReadColor(const std::filesystem::path& path) {
  ImageFile file = ReadImageFile(path);
  if (file.header.bits > 8) {
    throw InputError(path.string() + ": a colour image of " + std::to_string(file.header.bits) +
                     " bits a channel; 8 are wanted (is it a depth image, the lists' columns swapped?)");
  }
  return Decode<std::uint8_t>(path, file, cv::IMREAD_COLOR, 3);
}

Image16 ReadDepth(const std::filesystem::path& path) {
  ImageFile file = ReadImageFile(path);
  const ImageHeader& header = file.header;
  if (header.bits != 16 || header.channels != 1) {
    throw InputError(path.string() + ": a depth image of " + std::to_string(header.bits) + " bits and " +
                     std::to_string(header.channels) + (header.channels == 1 ? " channel" : " channels") +
                     "; a PNG of 16 bits and one channel is wanted, with depth in the units of the camera file's "
                     "depth_scale (5000 a metre for TUM)");
  }
  return Decode<std::uint16_t>(path, file, cv::IMREAD_UNCHANGED, 1);
}

Image8 ReadMask(const std::filesystem::path& path) {
  ImageFile file = ReadImageFile(path);
  if (file.header.bits > 8) {
    throw InputError(path.string() + ": a mask of " + std::to_string(file.header.bits) +
                     " bits a channel; 8 are wanted, 0 for what does not move");
  }
  const bool grey = file.header.channels == 1 && file.header.bits == 8;
  const Image8 raw = Decode<std::uint8_t>(path, file, grey ? cv::IMREAD_GRAYSCALE : cv::IMREAD_COLOR, grey ? 1 : 3);
  Image8 mask(raw.width, raw.height);
  for (std::size_t i = 0; i < mask.data.size(); ++i) {
    const std::uint8_t* pixel = raw.data.data() + i * static_cast<std::size_t>(raw.channels);
    const bool set = grey ? pixel[0] != 0 : (pixel[0] | pixel[1] | pixel[2]) != 0;
    mask.data[i] = set ? 255 : 0;
  }
  return mask;
}

}  // namespace rds
