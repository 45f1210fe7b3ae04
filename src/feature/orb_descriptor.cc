// SPDX-License-Identifier: Apache-2.0
#include "feature/orb_descriptor.h"

#include <cmath>
#include <cstring>
#include <opencv2/core.hpp>

#include "feature/orb_pattern.h"

namespace rds {
namespace {

constexpr int kRows = 2 * kPatchRadius + 1;
constexpr int kColumns = 32;  // from -16 on; the weights of column -16 are 0

// Weights x and y of each pixel in the round patch, 0 outside.
struct MomentWeights {
  std::array<std::int8_t, static_cast<std::size_t>(kRows* kColumns)> x{};
  std::array<std::int8_t, static_cast<std::size_t>(kRows* kColumns)> y{};
};

constexpr MomentWeights MakeMomentWeights() {
  MomentWeights weights;
  for (int y = -kPatchRadius; y <= kPatchRadius; ++y) {
    for (int x = -kPatchRadius; x <= kPatchRadius; ++x) {
      if (x * x + y * y <= kPatchRadius * (kPatchRadius + 1)) {
        const auto i = static_cast<std::size_t>((y + kPatchRadius) * kColumns + x + 16);
        weights.x[i] = static_cast<std::int8_t>(x);
        weights.y[i] = static_cast<std::int8_t>(y);
      }
    }
  }
  return weights;
}

constexpr MomentWeights kMomentWeights = MakeMomentWeights();

}  // namespace

float Orientation::AngleDeg() const {
  const float angle = cv::fastAtan2(sine, cosine);
  return angle < 360 ? angle : 0;
}

Orientation OrientationAt(const std::uint8_t* center, std::ptrdiff_t stride) {
  int sum_x = 0;
  int sum_y = 0;
  const std::int8_t* weight_x = kMomentWeights.x.data();
  const std::int8_t* weight_y = kMomentWeights.y.data();
  for (int y = -kPatchRadius; y <= kPatchRadius; ++y, weight_x += kColumns, weight_y += kColumns) {
    const std::uint8_t* const row = center + y * stride - 16;
    for (int i = 0; i < kColumns; ++i) {
      sum_x += row[i] * weight_x[i];
      sum_y += row[i] * weight_y[i];
    }
  }
  if (sum_x == 0 && sum_y == 0) {
    return {};
  }
  const auto x = static_cast<float>(sum_x);
  const auto y = static_cast<float>(sum_y);
  const float scale = 1 / std::sqrt(x * x + y * y);
  return {x * scale, y * scale};
}

PatchDescriber::PatchDescriber() {
  for (std::size_t i = 0; i < kPoints / 2; ++i) {
    x_[2 * i] = OrbPattern()[i].ax;
    y_[2 * i] = OrbPattern()[i].ay;
    x_[2 * i + 1] = OrbPattern()[i].bx;
    y_[2 * i + 1] = OrbPattern()[i].by;
  }
}

Descriptor PatchDescriber::Describe(const std::uint8_t* center, std::ptrdiff_t stride, Orientation orientation) const {
  // Offsets from the patch's corner are positive, so that cutting off after the addition of a half rounds.
  constexpr int kCorner = kPatchRadius + 1;
  constexpr float kHalf = 0.5F + kCorner;
  const auto signed_stride = static_cast<std::int32_t>(stride);
  alignas(64) std::array<std::int32_t, kPoints> offsets;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const auto x = static_cast<std::int32_t>(x_[i] * orientation.cosine - y_[i] * orientation.sine + kHalf);
    const auto y = static_cast<std::int32_t>(x_[i] * orientation.sine + y_[i] * orientation.cosine + kHalf);
    offsets[i] = y * signed_stride + x;
  }
  const std::uint8_t* const corner = center - kCorner * stride - kCorner;
  Descriptor descriptor;
  for (std::size_t word = 0; word < descriptor.size(); ++word) {
    std::uint64_t bits = 0;
#pragma GCC unroll 8
    for (std::size_t i = 64; i-- > 0;) {
      std::uint64_t pair = 0;  // both offsets in one load
      std::memcpy(&pair, &offsets[2 * (64 * word + i)], sizeof pair);
      bits += bits + (corner[pair & 0xffffffff] < corner[pair >> 32U] ? 1 : 0);
    }
    descriptor[word] = bits;
  }
  return descriptor;
}

}  // namespace rds
