// SPDX-License-Identifier: Apache-2.0
#include "synth/texture.h"

#include <cmath>

namespace rds::synthetic {
namespace {

std::uint8_t ToByte(float value) { return static_cast<std::uint8_t>(std::clamp(value, 0.0F, 255.0F) + 0.5F); }

}  // namespace

Texture::Texture(const Canvas& canvas, bool wrap_x) : wrap_x_(wrap_x) {
  Level finest;
  finest.width = canvas.width();
  finest.height = canvas.height();
  finest.texels.reserve(static_cast<std::size_t>(finest.width) * static_cast<std::size_t>(finest.height));
  for (int y = 0; y < finest.height; ++y) {
    for (int x = 0; x < finest.width; ++x) {
      const Color& color = canvas.At(x, y);
      finest.texels.push_back({ToByte(color.b), ToByte(color.g), ToByte(color.r), 0});
    }
  }
  levels_.push_back(std::move(finest));
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    const Level& fine = levels_.back();
    Level half;
    half.width = (fine.width + 1) / 2;
    half.height = (fine.height + 1) / 2;
    half.scale = 0.5F * fine.scale;
    half.texels.resize(static_cast<std::size_t>(half.width) * static_cast<std::size_t>(half.height));
    for (int y = 0; y < half.height; ++y) {
      // An odd border counts twice, so that texel i of a level always begins at texel 2 i of the one before.
      const auto* upper =
          fine.texels.data() + static_cast<std::ptrdiff_t>(std::min(2 * y, fine.height - 1)) * fine.width;
      const auto* lower =
          fine.texels.data() + static_cast<std::ptrdiff_t>(std::min(2 * y + 1, fine.height - 1)) * fine.width;
      for (int x = 0; x < half.width; ++x) {
        const int left = std::min(2 * x, fine.width - 1);
        const int right = std::min(2 * x + 1, fine.width - 1);
        auto& out = half.texels[static_cast<std::size_t>(y * half.width + x)];
        for (std::size_t c = 0; c < 3; ++c) {
          out[c] =
              static_cast<std::uint8_t>((upper[left][c] + upper[right][c] + lower[left][c] + lower[right][c] + 2) / 4);
        }
      }
    }
    levels_.push_back(std::move(half));
  }
}

}  // namespace rds::synthetic
