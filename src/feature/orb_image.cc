// SPDX-License-Identifier: Apache-2.0
#include "feature/orb_image.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "feature/orb_simd.h"

namespace rds {
namespace {

constexpr int kOne = 128;  // weight 1 of the interpolation
constexpr int kBlock = 8;  // pixels of a Shrinker::Block

using Bytes16 = std::uint8_t __attribute__((vector_size(16)));
using Bytes8 = std::uint8_t __attribute__((vector_size(8)));
using Words8 = std::uint16_t __attribute__((vector_size(16)));

Bytes16 Shuffle(Bytes16 v, Bytes16 indices) {
#if defined(__GNUC__) && !defined(__clang__)
  return __builtin_shuffle(v, indices);
#else
  Bytes16 result;
  for (int i = 0; i < 16; ++i) {
    result[i] = v[indices[i] & 15];
  }
  return result;
#endif
}

}  // namespace

void ToGray(const Image8& image, GrayPlane& gray) {
  gray.Resize(image.width, image.height);
  const std::uint8_t* from = image.data.data();
  std::uint8_t* const to = gray.Row(0);
  const std::size_t size = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  if (image.channels == 1) {
    std::copy(from, from + size, to);
    return;
  }
  for (std::size_t i = 0; i < size; ++i) {
    to[i] =
        static_cast<std::uint8_t>((from[3 * i] * 29U + from[3 * i + 1] * 150U + from[3 * i + 2] * 77U + 128U) >> 8U);
  }
}

void Shrinker::Prepare(int from_width, int to_width, double factor) {
  if (from_width == from_width_ && to_width == to_width_ && factor == factor_) {
    return;
  }
  from_width_ = from_width;
  to_width_ = to_width;
  factor_ = factor;
  narrow_ = true;
  blocks_.clear();
  for (int begin = 0; begin < to_width; begin += kBlock) {
    Block& block = blocks_.emplace_back();
    for (std::size_t i = 0; i < kBlock; ++i) {
      const double x = (std::min(begin + static_cast<int>(i), to_width - 1) + 0.5) * factor - 0.5;
      int left = std::min(static_cast<int>(x), from_width - 1);
      int weight = static_cast<int>(std::lround((x - left) * kOne));
      if (left == from_width - 1) {
        weight = 0;
      }
      if (i == 0) {
        block.base = left;
      }
      left -= block.base;
      narrow_ = narrow_ && left + 1 < 16;
      block.neighbors[2 * i] = static_cast<std::uint8_t>(left);
      block.neighbors[2 * i + 1] = static_cast<std::uint8_t>(left + 1);
      block.weights[i] = static_cast<std::uint16_t>(weight);
    }
  }
  row_.assign(static_cast<std::size_t>(from_width) + GrayPlane::kPadding, 0);
}

void Shrinker::ShrinkRow(int width, std::uint8_t* to) const {
  static_assert(std::endian::native == std::endian::little);
  const std::uint8_t* const from = row_.data();
  if (!narrow_) {
    for (int x = 0; x < width; ++x) {
      const Block& block = blocks_[static_cast<std::size_t>(x / kBlock)];
      const auto i = static_cast<std::size_t>(x % kBlock);
      const int left = from[block.base + block.neighbors[2 * i]];
      const int right = from[block.base + block.neighbors[2 * i + 1]];
      to[x] =
          static_cast<std::uint8_t>((left * (kOne - block.weights[i]) + right * block.weights[i] + kOne / 2) / kOne);
    }
    return;
  }
  for (const Block& block : blocks_) {
    Bytes16 pixels;
    Bytes16 neighbors;
    Words8 weights;
    std::memcpy(&pixels, from + block.base, sizeof pixels);
    std::memcpy(&neighbors, block.neighbors.data(), sizeof neighbors);
    std::memcpy(&weights, block.weights.data(), sizeof weights);
    const auto pairs = std::bit_cast<Words8>(Shuffle(pixels, neighbors));
    const Words8 sum = (pairs & 0xff) * (kOne - weights) + (pairs >> 8) * weights + kOne / 2;
    const auto result = __builtin_convertvector(sum / kOne, Bytes8);
    std::memcpy(to, &result, sizeof result);
    to += kBlock;
  }
}

void Shrinker::Shrink(const GrayPlane& from, double factor, GrayPlane& to) {
  to.Resize(static_cast<int>(from.width() / factor), static_cast<int>(from.height() / factor));
  Prepare(from.width(), to.width(), factor);
  for (int y = 0; y < to.height(); ++y) {
    const double from_y = (y + 0.5) * factor - 0.5;
    const int top = static_cast<int>(from_y);
    const auto weight = static_cast<std::uint16_t>(std::lround((from_y - top) * kOne));
    const std::uint8_t* const upper = from.Row(top);
    const std::uint8_t* const lower = from.Row(std::min(top + 1, from.height() - 1));
    const WordVector lower_weight = WordVector{} + weight;
    const WordVector upper_weight = kOne - lower_weight;
    for (int x = 0; x < from.width(); x += kWordLanes) {
      const WordVector sum = LoadWidened(upper + x) * upper_weight + LoadWidened(lower + x) * lower_weight + kOne / 2;
      StoreNarrowed(&row_[static_cast<std::size_t>(x)], sum / kOne);
    }
    ShrinkRow(to.width(), to.Row(y));
  }
}

void Blur(const GrayPlane& from, GrayPlane& to, std::vector<std::uint8_t>& row) {
  to.Resize(from.width(), from.height());
  row.resize(static_cast<std::size_t>(from.width()) + GrayPlane::kPadding);
  // (1 0 1) twice makes (1 0 2 0 1) / 4, then (1 2 1) / 4 of three of those.
  const auto kernel = [](const std::uint8_t* p, std::ptrdiff_t step) {
    const ByteVector p2 = LoadBytes(p + 2 * step);
    const ByteVector p4 = LoadBytes(p + 4 * step);
    const ByteVector before = Average(p2, Average(LoadBytes(p), p4));
    const ByteVector center = Average(LoadBytes(p + 3 * step), Average(LoadBytes(p + step), LoadBytes(p + 5 * step)));
    const ByteVector after = Average(p4, Average(p2, LoadBytes(p + 6 * step)));
    return Average(center, Average(before, after));
  };
  for (int y = 3; y < from.height() - 3; ++y) {
    for (int x = 0; x < from.width(); x += kByteLanes) {
      StoreBytes(&row[static_cast<std::size_t>(x)], kernel(from.Row(y - 3) + x, from.stride()));
    }
    for (int x = 3; x < from.width() - 3; x += kByteLanes) {
      StoreBytes(to.Row(y) + x, kernel(&row[static_cast<std::size_t>(x) - 3], 1));
    }
  }
}

}  // namespace rds
