// SPDX-License-Identifier: Apache-2.0
// Gray images of the ORB extractor: conversion, pyramid, blur. All integer arithmetic.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/image.h"

namespace rds {

// A gray image whose buffer lasts: Resize to a size that it had before costs nothing. A few bytes beyond each row's end
// may be read and (in ascending order of rows) written, so that loops over whole vectors need no remainder. Not
// thread-safe.
class GrayPlane {
 public:
  static constexpr int kPadding = 128;  // readable and writable bytes after the last row

  void Resize(int width, int height) {
    width_ = width;
    height_ = height;
    data_.resize(std::max(data_.size(), static_cast<std::size_t>(width) * static_cast<std::size_t>(height) + kPadding));
  }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] std::ptrdiff_t stride() const { return width_; }
  [[nodiscard]] std::uint8_t* Row(int y) { return data_.data() + y * stride(); }
  [[nodiscard]] const std::uint8_t* Row(int y) const { return data_.data() + y * stride(); }

 private:
  int width_ = 0;
  int height_ = 0;
  std::vector<std::uint8_t> data_;
};

// Gray of a gray or BGR image (weights of ITU-R BT.601).
void ToGray(const Image8& image, GrayPlane& gray);

// Shrinks an image by `factor` > 1, bilinear. Pixel centers: x of the small image is (x + 0.5) * factor - 0.5 in the
// large one. Keeps its tables while sizes stay. Not thread-safe.
class Shrinker {
 public:
  // Writes the shrunk image, of floor(size / factor) pixels.
  void Shrink(const GrayPlane& from, double factor, GrayPlane& to);

 private:
  // Eight pixels of a row: where they come from.
  struct Block {
    int base;                                // first source pixel
    std::array<std::uint8_t, 16> neighbors;  // left and right neighbor of each pixel, from base
    std::array<std::uint16_t, 8> weights;    // of the right neighbor, of kOne
  };
  void Prepare(int from_width, int to_width, double factor);
  void ShrinkRow(int width, std::uint8_t* to) const;

  int from_width_ = 0;
  int to_width_ = 0;
  double factor_ = 0;
  bool narrow_ = true;  // 16 source pixels cover every block
  std::vector<Block> blocks_;
  std::vector<std::uint8_t> row_;  // two rows blended into one
};

// Smooths with the kernel (1 2 3 4 3 2 1) / 16 in x and y, whose standard deviation is 1.6 pixels. The outermost 3
// pixels are left undefined. Resizes `to`; `row` is scratch.
void Blur(const GrayPlane& from, GrayPlane& to, std::vector<std::uint8_t>& row);

}  // namespace rds
