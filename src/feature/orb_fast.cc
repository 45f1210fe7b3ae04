// SPDX-License-Identifier: Apache-2.0
#include "feature/orb_fast.h"

#include <array>
#include <bit>

#include "feature/orb_simd.h"

namespace rds {
namespace {

// Scores of the pixels from p on, given the pixels of the circle: how far the darkest of nine neighbors can lie above
// the center, or the brightest below.
ByteVector ScoreOf(const std::uint8_t* p, std::ptrdiff_t stride) {
  const std::array<ByteVector, 16> circle = {
      LoadBytes(p - 3 * stride),
      LoadBytes(p - 3 * stride + 1),
      LoadBytes(p - 2 * stride + 2),
      LoadBytes(p - stride + 3),
      LoadBytes(p + 3),
      LoadBytes(p + stride + 3),
      LoadBytes(p + 2 * stride + 2),
      LoadBytes(p + 3 * stride + 1),
      LoadBytes(p + 3 * stride),
      LoadBytes(p + 3 * stride - 1),
      LoadBytes(p + 2 * stride - 2),
      LoadBytes(p + stride - 3),
      LoadBytes(p - 3),
      LoadBytes(p - stride - 3),
      LoadBytes(p - 2 * stride - 2),
      LoadBytes(p - 3 * stride - 1),
  };
  // Two arcs of nine share eight pixels from an odd index on, and add the pixel before or the one after.
  std::array<ByteVector, 8> low;
  std::array<ByteVector, 8> high;
  for (std::size_t i = 0; i < 8; ++i) {
    low[i] = Min(circle[2 * i + 1], circle[(2 * i + 2) % 16]);
    high[i] = Max(circle[2 * i + 1], circle[(2 * i + 2) % 16]);
  }
  std::array<ByteVector, 8> low4;
  std::array<ByteVector, 8> high4;
  for (std::size_t i = 0; i < 8; ++i) {
    low4[i] = Min(low[i], low[(i + 1) % 8]);
    high4[i] = Max(high[i], high[(i + 1) % 8]);
  }
  ByteVector brightest_low{};
  ByteVector darkest_high = ~brightest_low;
  for (std::size_t i = 0; i < 8; ++i) {
    const ByteVector before = circle[2 * i];
    const ByteVector after = circle[(2 * i + 9) % 16];
    brightest_low = Max(brightest_low, Min(Min(low4[i], low4[(i + 2) % 8]), Max(before, after)));
    darkest_high = Min(darkest_high, Max(Max(high4[i], high4[(i + 2) % 8]), Min(before, after)));
  }
  const ByteVector center = LoadBytes(p);
  return Max(SubtractSaturated(brightest_low, center), SubtractSaturated(center, darkest_high));
}

// An upper bound of ScoreOf: every arc of nine has two neighbors of the circle's four compass points.
ByteVector ScoreBound(const std::uint8_t* p, std::ptrdiff_t stride) {
  const ByteVector north = LoadBytes(p - 3 * stride);
  const ByteVector south = LoadBytes(p + 3 * stride);
  const ByteVector east = LoadBytes(p + 3);
  const ByteVector west = LoadBytes(p - 3);
  const ByteVector center = LoadBytes(p);
  return Max(SubtractSaturated(Min(Max(north, south), Max(east, west)), center),
             SubtractSaturated(center, Max(Min(north, south), Min(east, west))));
}

// Bit i tells whether score row[i] is above the threshold and no neighbor's is larger; of equal neighbors, the last
// counts.
std::uint64_t MaximaMask(const std::uint8_t* upper, const std::uint8_t* row, const std::uint8_t* lower,
                         ByteVector threshold) {
  const ByteVector score = LoadBytes(row);
  const ByteVector before =
      Max(Max(Max(LoadBytes(upper - 1), LoadBytes(upper)), Max(LoadBytes(upper + 1), LoadBytes(row - 1))), threshold);
  const ByteVector after =
      Max(Max(LoadBytes(row + 1), LoadBytes(lower - 1)), Max(LoadBytes(lower), LoadBytes(lower + 1)));
  return LessMask(before, score) & ~LessMask(score, after);
}

constexpr int kPadding = kByteLanes + 16;

}  // namespace

void FastDetector::Score(const GrayPlane& image, int y, std::uint8_t threshold, int begin, int end,
                         ScoreRow& row) const {
  const ByteVector thresholds = ByteVector{} + threshold;
  std::size_t block = 0;
  for (int x = begin; x < end; x += kByteLanes, ++block) {
    const std::uint8_t* const p = image.Row(y) + x;
    ByteVector score{};
    if (AnyLess(thresholds, ScoreBound(p, image.stride()))) {
      score = ScoreOf(p, image.stride());
    }
    row.filled[block] = AnyLess(thresholds, score) ? 1 : 0;
    StoreBytes(&row.scores[static_cast<std::size_t>(x + 1)], score);
  }
}

void FastDetector::Detect(const GrayPlane& image, std::uint8_t threshold, int border, std::vector<Corner>& corners) {
  corners.clear();
  // Scores are needed one pixel around the corners.
  const int begin = border - 1;
  const int end = image.width() - border + 1;
  if (end - begin < 3) {
    return;
  }
  for (ScoreRow& row : rows_) {
    row.scores.assign(static_cast<std::size_t>(image.width() + kPadding), 0);
    row.filled.assign(static_cast<std::size_t>(image.width() / kByteLanes + 1), 0);
  }
  for (int y = border - 1; y < image.height() - border + 1; ++y) {
    Score(image, y, threshold, begin, end, RowOf(y));
    if (y > border) {
      FindMaxima(y - 1, threshold, begin, end, corners);
    }
  }
}

void FastDetector::FindMaxima(int y, std::uint8_t threshold, int begin, int end, std::vector<Corner>& corners) {
  const ByteVector thresholds = ByteVector{} + threshold;
  const std::uint8_t* const filled = RowOf(y).filled.data();
  // Index of a score is x + 1.
  const std::uint8_t* const upper = RowOf(y - 1).scores.data() + 1;
  const std::uint8_t* const row = RowOf(y).scores.data() + 1;
  const std::uint8_t* const lower = RowOf(y + 1).scores.data() + 1;
  row_corners_.resize(static_cast<std::size_t>(end));
  Corner* found = row_corners_.data();
  for (int block = 0, block_x = begin; block_x < end; ++block, block_x += kByteLanes) {
    if (filled[block] == 0) {
      continue;
    }
    std::uint64_t mask = MaximaMask(upper + block_x, row + block_x, lower + block_x, thresholds);
    for (; mask != 0; mask &= mask - 1) {
      const int x = block_x + std::countr_zero(mask);
      if (x > begin && x < end - 1) {
        *found++ = {static_cast<std::int16_t>(x),
                    static_cast<std::int16_t>(y),
                    row[x],
                    row[x - 1],
                    row[x + 1],
                    upper[x],
                    lower[x]};
      }
    }
  }
  corners.insert(corners.end(), row_corners_.data(), found);
}

}  // namespace rds
