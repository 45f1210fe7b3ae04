// SPDX-License-Identifier: Apache-2.0
// Plain images in memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace rds {

// A row-major image without padding: pixel (x, y), channel c is data[(y * width + x) * channels + c]. A value; share
// one between threads as shared_ptr<const Image>.
template <typename T>
struct Image {
  int width = 0;
  int height = 0;
  int channels = 1;
  std::vector<T> data;

  Image() = default;
  Image(int width_, int height_, int channels_ = 1, T fill = T{})
      : width(width_),
        height(height_),
        channels(channels_),
        data(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) * static_cast<std::size_t>(channels_),
             fill) {}

  // Copies from memory that the caller owns; `stride` is the distance of two rows in bytes.
  static Image Copy(const T* source, int width, int height, int channels, std::size_t stride) {
    Image image(width, height, channels);
    const std::size_t row = static_cast<std::size_t>(width) * static_cast<std::size_t>(channels);
    for (int y = 0; y < height; ++y) {
      const auto* from =
          reinterpret_cast<const T*>(reinterpret_cast<const std::byte*>(source) + static_cast<std::size_t>(y) * stride);
      std::copy(from, from + row, image.Row(y));
    }
    return image;
  }

  [[nodiscard]] bool empty() const { return data.empty(); }
  [[nodiscard]] T* Row(int y) {
    return data.data() +
           static_cast<std::size_t>(y) * static_cast<std::size_t>(width) * static_cast<std::size_t>(channels);
  }
  [[nodiscard]] const T* Row(int y) const { return const_cast<Image*>(this)->Row(y); }
  [[nodiscard]] T& At(int x, int y, int channel = 0) { return Row(y)[x * channels + channel]; }
  [[nodiscard]] const T& At(int x, int y, int channel = 0) const { return Row(y)[x * channels + channel]; }
};

using Image8 = Image<std::uint8_t>;    // gray (1 channel), or BGR (3 channels) as OpenCV orders it
using Image16 = Image<std::uint16_t>;  // depth, in units of PinholeCamera::depth_scale; 0 and 65535 = no depth

}  // namespace rds
