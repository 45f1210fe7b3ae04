#include "feature/orb_fast.h"

#include <array>
#include <bit>
#include <cstring>

#include "feature/orb_simd.h"

namespace rds {
namespace {

// Scores of the pixels from p on, given the pixels of the circle: how far the darkest of nine neighbours can lie above
// the centre, or the brightest below.
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
  const ByteVector centre = LoadBytes(p);
  return Max(SubtractSaturated(brightest_low, centre), SubtractSaturated(centre, darkest_high));
}

// An upper bound of ScoreOf: every arc of nine has two neighbours of the circle's four compass points.
ByteVector ScoreBound(const std::uint8_t* p, std::ptrdiff_t stride) {
  const ByteVector north = LoadBytes(p - 3 * stride);
  const ByteVector south = LoadBytes(p + 3 * stride);
  const ByteVector east = LoadBytes(p + 3);
  const ByteVector west = LoadBytes(p - 3);
  const ByteVector centre = LoadBytes(p);
  return Max(SubtractSaturated(Min(Max(north, south), Max(east, west)), centre),
             SubtractSaturated(centre, Max(Min(north, south), Min(east, west))));
}

// Score where it is above the threshold and no neighbour's is larger (of equal neighbours the last counts), else zero.
ByteVector Maxima(const std::uint8_t* upper, const std::uint8_t* row, const std::uint8_t* lower, ByteVector threshold) {
  const ByteVector score = LoadBytes(row);
  const ByteVector before =
      Max(Max(Max(LoadBytes(upper - 1), LoadBytes(upper)), Max(LoadBytes(upper + 1), LoadBytes(row - 1))), threshold);
  const ByteVector after =
      Max(Max(LoadBytes(row + 1), LoadBytes(lower - 1)), Max(LoadBytes(lower), LoadBytes(lower + 1)));
  const ByteVector is_maximum = (SubtractSaturated(score, before) != 0) & (score >= after);
  return score & is_maximum;
}

constexpr int kPadding = kByteLanes + 16;

}  // namespace

void FastDetector::Score(const GreyPlane& image, int y, std::uint8_t threshold, int begin, int end,
                         ScoreRow& row) const {
  const ByteVector thresholds = ByteVector{} + threshold;
  std::size_t block = 0;
  for (int x = begin; x < end; x += kByteLanes, ++block) {
    const std::uint8_t* const p = image.Row(y) + x;
    ByteVector score{};
    if (AnyNonZero(SubtractSaturated(ScoreBound(p, image.stride()), thresholds))) {
      score = ScoreOf(p, image.stride());
    }
    row.filled[block] = AnyNonZero(SubtractSaturated(score, thresholds)) ? 1 : 0;
    StoreBytes(&row.scores[static_cast<std::size_t>(x + 1)], score);
  }
}

void FastDetector::Detect(const GreyPlane& image, std::uint8_t threshold, int border, std::vector<Corner>& corners) {
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
  const ByteVector thresholds = ByteVector{} + threshold;
  for (int y = border - 1; y < image.height() - border + 1; ++y) {
    Score(image, y, threshold, begin, end, rows_[y % 3]);
    if (y < border + 1) {
      continue;
    }
    const ScoreRow& upper = rows_[(y - 2) % 3];
    const ScoreRow& row = rows_[(y - 1) % 3];
    const ScoreRow& lower = rows_[y % 3];
    std::size_t block = 0;
    for (int x = begin; x < end; x += kByteLanes, ++block) {
      if (row.filled[block] == 0) {
        continue;
      }
      const auto at = static_cast<std::size_t>(x + 1);
      const ByteVector maxima = Maxima(&upper.scores[at], &row.scores[at], &lower.scores[at], thresholds);
      std::uint64_t words[kByteLanes / 8];
      std::memcpy(words, &maxima, sizeof maxima);
      for (int i = 0; i < kByteLanes / 8; ++i) {
        for (std::uint64_t word = words[i]; word != 0;) {
          const int lane = std::countr_zero(word) / 8;
          const int corner_x = x + 8 * i + lane;
          if (corner_x >= border && corner_x < image.width() - border) {
            const auto at_x = static_cast<std::size_t>(corner_x + 1);
            Corner& corner = corners.emplace_back();
            corner.x = static_cast<std::int16_t>(corner_x);
            corner.y = static_cast<std::int16_t>(y - 1);
            corner.score = row.scores[at_x];
            corner.left = row.scores[at_x - 1];
            corner.right = row.scores[at_x + 1];
            corner.above = upper.scores[at_x];
            corner.below = lower.scores[at_x];
          }
          word &= ~(std::uint64_t{0xff} << (8 * lane));
        }
      }
    }
  }
}

}  // namespace rds
