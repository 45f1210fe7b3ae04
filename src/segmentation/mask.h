// SPDX-License-Identifier: Apache-2.0
// Masks: from the scores of a network to an image of labels, dilation, and the check that a mask can be used.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/image.h"

namespace rds {

// Pixels of a mask.
inline constexpr std::uint8_t kStaticPixel = 0;
inline constexpr std::uint8_t kUnsurePixel = 128;  // the network neither sees a person nor excludes one
inline constexpr std::uint8_t kDynamicPixel = 255;

// Where the cells of a network's output lie on its input: the center of cell (i, j) is at pixel
// (i * stride_x + offset_x, j * stride_y + offset_y) of the input, pixel centers at whole numbers.
struct ScoreGrid {
  int width = 0;  // cells
  int height = 0;
  double stride_x = 1;  // input pixels
  double stride_y = 1;
  double offset_x = 0;
  double offset_y = 0;
  int input_width = 0;  // of the network, pixels
  int input_height = 0;
};

// How logits of several classes lie in memory.
enum class ChannelOrder { kFirst, kLast };

// Softmax over `classes` at each of `cells` cells, summed over `labels` (each below `classes`): the probability of a
// prior dynamic class, row-major like the logits. InputError if that is not finite.
[[nodiscard]] std::vector<float> ClassProbability(std::span<const float> logits, int cells, int classes,
                                                  ChannelOrder order, std::span<const int> labels);

// A mask of width x height pixels: dynamic where the probability, bilinear between the cells and constant beyond the
// outer ones, is greater than `threshold`, unsure where it is greater than `unsure`. The network's input is the whole
// image, stretched.
[[nodiscard]] Image8 MaskFromProbability(std::span<const float> probability, const ScoreGrid& grid, int width,
                                         int height, float threshold, float unsure);

// A mask of width x height pixels: dynamic where the nearest cell's label is one of `labels`. InputError for
// negative labels.
[[nodiscard]] Image8 MaskFromLabels(std::span<const int> cells, const ScoreGrid& grid, int width, int height,
                                    std::span<const int> labels);

// Radius of dilation for an image `width` pixels wide, where `radius_at_640` is the radius at 640 pixels (the paper
// dilates by 15).
[[nodiscard]] int DilationRadius(int width, int radius_at_640);

// Dilation of what is dynamic by a filled circle of the given radius in pixels: the same pixels as cv::dilate with an
// elliptic element of 2 * radius + 1. One channel; what is neither static nor unsure counts as dynamic. Radius 0 ..
// 254.
[[nodiscard]] Image8 Dilate(const Image8& mask, int radius);

// Why a mask cannot be used for an image of width x height pixels, or nothing if it can: wrong size, several channels,
// or more than `max_share` of the image dynamic (a network gone mad says "everything"). An empty image is none of this
// function's business: it says "no answer".
[[nodiscard]] std::optional<std::string> MaskProblem(const Image8& mask, int width, int height, double max_share);

}  // namespace rds
