// SPDX-License-Identifier: Apache-2.0
#include "segmentation/mask.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/error.h"

namespace rds {
namespace {

// For each pixel of an axis the cell to its left and the weight of the cell after that.
struct AxisSample {
  int cell = 0;
  int next = 0;
  float weight = 0;
};

// `pixels` of the image lie on `input` pixels of the network, edges on edges.
std::vector<AxisSample> SampleAxis(int pixels, int input, int cells, double stride, double offset) {
  std::vector<AxisSample> samples(static_cast<std::size_t>(pixels));
  for (int i = 0; i < pixels; ++i) {
    const double at_input = (i + 0.5) * input / pixels - 0.5;
    const double position = std::clamp((at_input - offset) / stride, 0.0, static_cast<double>(cells - 1));
    const int cell = static_cast<int>(position);
    samples[static_cast<std::size_t>(i)] = {cell, std::min(cell + 1, cells - 1), static_cast<float>(position - cell)};
  }
  return samples;
}

std::vector<AxisSample> SampleColumns(const ScoreGrid& grid, int width) {
  return SampleAxis(width, grid.input_width, grid.width, grid.stride_x, grid.offset_x);
}

std::vector<AxisSample> SampleRows(const ScoreGrid& grid, int height) {
  return SampleAxis(height, grid.input_height, grid.height, grid.stride_y, grid.offset_y);
}

void CheckGrid(const ScoreGrid& grid, std::size_t cells) {
  Check(grid.width > 0 && grid.height > 0 && grid.stride_x > 0 && grid.stride_y > 0 && grid.input_width > 0 &&
            grid.input_height > 0,
        "score grid is empty");
  Check(cells == static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height),
        "score grid and scores differ in size");
}

// Half width of row `dy` of OpenCV's elliptic structuring element, for |dy| <= radius.
std::vector<int> HalfWidths(int radius) {
  std::vector<int> half(static_cast<std::size_t>(radius) + 1);
  for (int dy = 0; dy <= radius; ++dy) {
    half[static_cast<std::size_t>(dy)] = static_cast<int>(std::lrint(std::sqrt(radius * radius - dy * dy)));
  }
  return half;
}

// Distance of each pixel to the nearest set pixel of its own row, in pixels, 255 = none within 254.
void RowDistance(const std::uint8_t* row, int width, std::uint8_t* distance) {
  const auto is_dynamic = [row](int x) { return row[x] != kStaticPixel && row[x] != kUnsurePixel; };
  int nearest = 255;
  for (int x = 0; x < width; ++x) {
    nearest = is_dynamic(x) ? 0 : std::min(nearest + 1, 255);
    distance[x] = static_cast<std::uint8_t>(nearest);
  }
  nearest = 255;
  for (int x = width - 1; x >= 0; --x) {
    nearest = is_dynamic(x) ? 0 : std::min(nearest + 1, 255);
    distance[x] = std::min(distance[x], static_cast<std::uint8_t>(nearest));
  }
}

}  // namespace

std::vector<float> ClassProbability(std::span<const float> logits, int cells, int classes, ChannelOrder order,
                                    std::span<const int> labels) {
  const auto cell_count = static_cast<std::size_t>(cells);
  const auto class_count = static_cast<std::size_t>(classes);
  Check(logits.size() == cell_count * class_count, "logits have another size than cells times classes");
  Check(std::all_of(labels.begin(), labels.end(), [&](int label) { return label >= 0 && label < classes; }),
        "label is not among the classes");
  const std::size_t cell_step = order == ChannelOrder::kFirst ? 1 : class_count;
  const std::size_t class_step = order == ChannelOrder::kFirst ? cell_count : 1;
  std::vector<float> probability(cell_count);
  std::vector<float> weights(class_count);
  for (std::size_t i = 0; i < cell_count; ++i) {
    const float* const cell = &logits[i * cell_step];
    float largest = cell[0];
    for (std::size_t c = 1; c < class_count; ++c) {
      largest = std::max(largest, cell[c * class_step]);
    }
    float sum = 0;
    for (std::size_t c = 0; c < class_count; ++c) {
      weights[c] = std::exp(cell[c * class_step] - largest);
      sum += weights[c];
    }
    float wanted = 0;
    for (const int label : labels) {
      wanted += weights[static_cast<std::size_t>(label)];
    }
    if (!std::isfinite(largest) || !std::isfinite(sum)) {
      throw InputError("the network's output is not finite; is the model damaged, or its input scaled wrongly?");
    }
    probability[i] = wanted / sum;
  }
  return probability;
}

Image8 MaskFromProbability(std::span<const float> probability, const ScoreGrid& grid, int width, int height,
                           float threshold, float unsure) {
  CheckGrid(grid, probability.size());
  const std::vector<AxisSample> columns = SampleColumns(grid, width);
  const std::vector<AxisSample> rows = SampleRows(grid, height);
  const auto cells = static_cast<std::size_t>(grid.width);
  std::vector<float> blended(cells);
  Image8 mask(width, height);
  for (int y = 0; y < height; ++y) {
    const AxisSample& row = rows[static_cast<std::size_t>(y)];
    const float* const upper = &probability[static_cast<std::size_t>(row.cell) * cells];
    const float* const lower = &probability[static_cast<std::size_t>(row.next) * cells];
    for (std::size_t i = 0; i < cells; ++i) {
      blended[i] = upper[i] + row.weight * (lower[i] - upper[i]);
    }
    std::uint8_t* const out = mask.Row(y);
    for (int x = 0; x < width; ++x) {
      const AxisSample& column = columns[static_cast<std::size_t>(x)];
      const float left = blended[static_cast<std::size_t>(column.cell)];
      const float right = blended[static_cast<std::size_t>(column.next)];
      const float p = left + column.weight * (right - left);
      out[x] = p > threshold ? kDynamicPixel : p > unsure ? kUnsurePixel : kStaticPixel;
    }
  }
  return mask;
}

Image8 MaskFromLabels(std::span<const int> cells, const ScoreGrid& grid, int width, int height,
                      std::span<const int> labels) {
  CheckGrid(grid, cells.size());
  const std::vector<AxisSample> columns = SampleColumns(grid, width);
  const std::vector<AxisSample> rows = SampleRows(grid, height);
  const auto nearest = [](const AxisSample& sample) {
    return static_cast<std::size_t>(sample.weight < 0.5F ? sample.cell : sample.next);
  };
  Image8 mask(width, height);
  for (int y = 0; y < height; ++y) {
    const std::size_t first = nearest(rows[static_cast<std::size_t>(y)]) * static_cast<std::size_t>(grid.width);
    std::uint8_t* const out = mask.Row(y);
    for (int x = 0; x < width; ++x) {
      const int label = cells[first + nearest(columns[static_cast<std::size_t>(x)])];
      if (label < 0) {
        throw InputError(
            "the network's output holds a negative label; is the model damaged, or its input scaled wrongly?");
      }
      out[x] = std::find(labels.begin(), labels.end(), label) != labels.end() ? 255 : 0;
    }
  }
  return mask;
}

int DilationRadius(int width, int radius_at_640) {
  return std::clamp(static_cast<int>(std::lround(radius_at_640 * width / 640.0)), 0, 254);
}

Image8 Dilate(const Image8& mask, int radius) {
  Check(mask.channels == 1, "a mask has one channel");
  Check(radius >= 0 && radius <= 254, "dilation radius must be 0 .. 254");
  Image8 distance(mask.width, mask.height);
  for (int y = 0; y < mask.height; ++y) {
    RowDistance(mask.Row(y), mask.width, distance.Row(y));
  }
  const std::vector<int> half = HalfWidths(radius);
  const int width = mask.width;  // a copy, so that the compiler knows that no pixel written changes it
  Image8 out = mask;
  for (int y = 0; y < mask.height; ++y) {
    std::uint8_t* const to = out.Row(y);
    const int last = std::min(y + radius, mask.height - 1);
    for (int v = std::max(y - radius, 0); v <= last; ++v) {
      const std::uint8_t* const from = distance.Row(v);
      const auto reach = static_cast<std::uint8_t>(half[static_cast<std::size_t>(std::abs(v - y))]);
      for (int x = 0; x < width; ++x) {  // vectorised: 31 passes over bytes for radius 15
        to[x] = static_cast<std::uint8_t>(to[x] | (from[x] <= reach ? 255 : 0));
      }
    }
  }
  return out;
}

std::optional<std::string> MaskProblem(const Image8& mask, int width, int height, double max_share) {
  if (mask.width != width || mask.height != height || mask.channels != 1 ||
      mask.data.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
    return fmt::format("mask is {} x {} with {} channel(s) for an image of {} x {}", mask.width, mask.height,
                       mask.channels, width, height);
  }
  const auto clear = std::count(mask.data.begin(), mask.data.end(), kStaticPixel) +
                     std::count(mask.data.begin(), mask.data.end(), kUnsurePixel);
  const double share = 1.0 - static_cast<double>(clear) / static_cast<double>(mask.data.size());
  if (share > max_share) {
    return fmt::format("mask covers {:.0f} % of the image, more than {:.0f} %", 100 * share, 100 * max_share);
  }
  return std::nullopt;
}

}  // namespace rds
