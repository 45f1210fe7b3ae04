// SPDX-License-Identifier: Apache-2.0
// FAST corners.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "feature/orb_image.h"

namespace rds {

// A corner in a gray image.
struct Corner {
  std::int16_t x = 0;
  std::int16_t y = 0;
  std::uint8_t score = 0;  // largest difference of gray that still makes it a corner
  // Scores of its neighbors, none larger than its own.
  std::uint8_t left = 0;
  std::uint8_t right = 0;
  std::uint8_t above = 0;
  std::uint8_t below = 0;

  // Position to a fraction of a pixel: the vertices of the parabolas through the three scores in x and in y.
  [[nodiscard]] float FineX() const { return static_cast<float>(x) + Vertex(left, right); }
  [[nodiscard]] float FineY() const { return static_cast<float>(y) + Vertex(above, below); }

 private:
  [[nodiscard]] float Vertex(int before, int after) const {
    const int curvature = 2 * score - before - after;
    return curvature > 0 ? static_cast<float>(after - before) / static_cast<float>(2 * curvature) : 0.0F;
  }
};

// Finds FAST-9/16 corners (Rosten and Drummond, "Machine learning for high-speed corner detection", ECCV 2006): nine
// neighboring pixels of the circle of radius 3 all brighter or all darker than the center by more than a threshold.
// Keeps only those whose score is the largest of their 3 x 3 neighborhood. Not thread-safe: keeps its buffers.
class FastDetector {
 public:
  // Corners above `threshold` at least `border` >= 4 pixels from the image's edges, by rows.
  void Detect(const GrayPlane& image, std::uint8_t threshold, int border, std::vector<Corner>& corners);

 private:
  struct ScoreRow {
    std::vector<std::uint8_t> scores;  // by x, with padding on both sides
    std::vector<std::uint8_t> filled;  // by block: whether any score in it is above the threshold
  };
  // Both for pixels `begin` to `end` of a row, and for maxima not the first and last.
  void Score(const GrayPlane& image, int y, std::uint8_t threshold, int begin, int end, ScoreRow& row) const;
  void FindMaxima(int y, std::uint8_t threshold, int begin, int end, std::vector<Corner>& corners);

  [[nodiscard]] ScoreRow& RowOf(int y) { return rows_[static_cast<unsigned>(y) % 3]; }

  std::array<ScoreRow, 3> rows_;  // the last three
  std::vector<Corner> row_corners_;
};

}  // namespace rds
