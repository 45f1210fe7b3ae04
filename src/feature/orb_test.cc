// SPDX-License-Identifier: Apache-2.0
#include "feature/orb.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "base/error.h"
#include "base/random.h"

namespace rds {
namespace {
PinholeCamera CameraOf(int width, int height) {
  PinholeCamera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = 0.8 * width;
  camera.cx = width / 2.0 - 0.5;
  camera.cy = height / 2.0 - 0.5;
  return camera;
}

// Rectangles and discs of random gray, slightly smoothed: corners at many scales.
cv::Mat Textured(int width, int height, std::uint64_t seed) {
  Random random(seed);
  cv::Mat image(height, width, CV_8UC1, cv::Scalar(128));
  const int shapes = width * height / 500;
  for (int i = 0; i < shapes; ++i) {
    const int x = static_cast<int>(random.Index(static_cast<std::uint32_t>(width)));
    const int y = static_cast<int>(random.Index(static_cast<std::uint32_t>(height)));
    const int size = 4 + static_cast<int>(random.Index(24));
    const cv::Scalar gray(random.Uniform(0, 255));
    if (i % 3 == 0) {
      cv::circle(image, {x, y}, size / 2, gray, cv::FILLED);
    } else {
      cv::rectangle(image, {x, y, size, 4 + static_cast<int>(random.Index(24))}, gray, cv::FILLED);
    }
  }
  cv::GaussianBlur(image, image, {5, 5}, 0.9);
  return image;
}

Image8 ToImage(const cv::Mat& mat) { return Image8::Copy(mat.data, mat.cols, mat.rows, mat.channels(), mat.step); }

OrbOptions Thousand() {
  OrbOptions options;
  options.features = 1000;
  return options;
}

FrameData ExtractFrom(const cv::Mat& mat, const OrbOptions& options = Thousand()) {
  OrbExtractor extractor(options);
  return extractor.Extract(CameraOf(mat.cols, mat.rows), ToImage(mat), Image16(mat.cols, mat.rows));
}

struct Correspondence {
  std::size_t a;
  std::size_t b;
  int distance;  // Hamming
};

// Mutual nearest neighbors in descriptor space.
std::vector<Correspondence> Match(const FrameData& a, const FrameData& b) {
  const auto nearest = [](const Descriptor& descriptor, const FrameData& frame) {
    Correspondence best{0, 0, 257};
    for (std::size_t i = 0; i < frame.size(); ++i) {
      const int distance = HammingDistance(descriptor, frame.descriptors()[i]);
      if (distance < best.distance) {
        best = {0, i, distance};
      }
    }
    return best;
  };
  std::vector<Correspondence> matches;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Correspondence there = nearest(a.descriptors()[i], b);
    if (there.distance <= 64 && nearest(b.descriptors()[there.b], a).b == i) {
      matches.push_back({i, there.b, there.distance});
    }
  }
  return matches;
}

// Share of the matches whose keypoint in b lies within 3 pixels (of its level) of where the affine map puts that of a.
double InlierRatio(const FrameData& a, const FrameData& b, const std::vector<Correspondence>& matches,
                   const cv::Matx23d& b_from_a) {
  double inliers = 0;
  for (const Correspondence& match : matches) {
    const Keypoint& k = a.keypoints()[match.a];
    const cv::Vec2d expected = b_from_a * cv::Vec3d(k.x, k.y, 1);
    const Keypoint& found = b.keypoints()[match.b];
    const double error = std::hypot(found.x - expected[0], found.y - expected[1]);
    inliers += error < 3 * std::pow(1.2, found.octave) ? 1 : 0;
  }
  return inliers / static_cast<double>(matches.size());
}

TEST(OrbExtractor, FindsNothingInABlackImage) {
  const FrameData frame = ExtractFrom(cv::Mat::zeros(480, 640, CV_8UC1));
  EXPECT_EQ(frame.size(), 0U);
  EXPECT_EQ(ExtractFrom(cv::Mat::zeros(480, 640, CV_8UC3)).size(), 0U);
}

TEST(OrbExtractor, SpreadsFeaturesOverTheImage) {
  cv::Mat image = Textured(640, 480, 1);
  // A quarter of lower contrast must get its share all the same.
  cv::Mat quarter = image(cv::Rect(0, 0, 320, 240));
  quarter = quarter * 0.4 + 80;
  const FrameData frame = ExtractFrom(image);
  EXPECT_GE(frame.size(), 990U);
  EXPECT_LE(frame.size(), 1000U);
  std::array<std::array<int, 4>, 4> cells{};
  for (const Keypoint& k : frame.keypoints()) {
    ++cells[static_cast<std::size_t>(k.y / 120)][static_cast<std::size_t>(k.x / 160)];
  }
  for (const auto& row : cells) {
    for (const int count : row) {
      EXPECT_GE(count, 15);  // 62 on average, but the cells at the edges lose the border
      EXPECT_LE(count, 125);
    }
  }
}

// Marks all samples of the depth grid left of the middle of an image of 640 by 480.
std::vector<SampleMotion> MarkLeft(SampleMotion motion) {
  constexpr int kColumns = 640 / kDepthGridStep;
  std::vector<SampleMotion> marks;
  for (int i = 0; i < kColumns * (480 / kDepthGridStep); ++i) {
    marks.push_back(i % kColumns < kColumns / 2 ? motion : SampleMotion::kNone);
  }
  return marks;
}

TEST(OrbExtractor, WhatMovesTakesNoFeaturesFromTheRest) {
  OrbOptions options;
  options.features = 600;
  options.moving_ratio = options.boundary_ratio = 0.25;
  OrbExtractor extractor(options);
  const cv::Mat image = Textured(640, 480, 2);
  const auto count_left = [&](std::span<const SampleMotion> motion) {
    const FrameData frame = extractor.Extract(CameraOf(640, 480), ToImage(image), Image16(640, 480), motion);
    const auto left = std::ranges::count_if(frame.keypoints(), [](const Keypoint& k) { return k.raw_x < 318; });
    return std::pair(static_cast<int>(left), static_cast<int>(frame.size()) - static_cast<int>(left));
  };
  const auto [beside, right] = count_left(MarkLeft(SampleMotion::kBoundary));
  EXPECT_GT(right, 570);  // but for what the coarse levels cannot give
  EXPECT_NEAR(beside, 150, 9);
  const auto [moving, rest] = count_left(MarkLeft(SampleMotion::kMoves));
  EXPECT_EQ(rest, right);
  EXPECT_NEAR(moving, 65, 10);  // of the coarse levels, which have less than half
  EXPECT_THROW(count_left(std::vector<SampleMotion>(7)), InvariantError);
}

TEST(OrbExtractor, FillsAllLevels) {
  const FrameData frame = ExtractFrom(Textured(640, 480, 2));
  std::vector<int> count(8, 0);
  for (const Keypoint& k : frame.keypoints()) {
    ++count[k.octave];
  }
  EXPECT_NEAR(count[0], 217, 1);
  for (std::size_t i = 1; i < count.size(); ++i) {
    EXPECT_LE(count[i], count[i - 1]);
    EXPECT_GE(count[i], 40);
  }
}

TEST(OrbExtractor, DescribesARotatedImageAlike) {
  const cv::Mat image = Textured(640, 480, 3);
  for (const double degrees : {30.0, 77.0, 180.0}) {
    const cv::Matx23d map = cv::getRotationMatrix2D({320, 240}, degrees, 1.0);
    cv::Mat rotated;
    cv::warpAffine(image, rotated, map, image.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
    const FrameData a = ExtractFrom(image);
    const FrameData b = ExtractFrom(rotated);
    const std::vector<Correspondence> matches = Match(a, b);
    EXPECT_GE(matches.size(), 250U) << degrees;
    EXPECT_GT(InlierRatio(a, b, matches, map), 0.85) << degrees;
    // The orientation turns with the image (and its angle falls, as y points down).
    std::vector<double> errors;
    for (const Correspondence& match : matches) {
      const double turned = a.keypoints()[match.a].angle_deg - b.keypoints()[match.b].angle_deg - degrees;
      errors.push_back(std::abs(std::remainder(turned, 360.0)));
    }
    std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2), errors.end());
    EXPECT_LT(errors[errors.size() / 2], 4) << degrees;
  }
}

TEST(OrbExtractor, DescribesAScaledImageAlikeAtAnotherLevel) {
  const cv::Mat image = Textured(800, 600, 4);
  const double scale = 1.0 / (1.2 * 1.2 * 1.2);
  cv::Mat small;
  cv::resize(image, small, {}, scale, scale, cv::INTER_AREA);
  const cv::Matx23d map(scale, 0, 0.5 * scale - 0.5, 0, scale, 0.5 * scale - 0.5);
  OrbOptions options;
  options.features = 2000;
  const FrameData a = ExtractFrom(image, options);
  const FrameData b = ExtractFrom(small, options);
  const std::vector<Correspondence> matches = Match(a, b);
  EXPECT_GE(matches.size(), 250U);
  EXPECT_GT(InlierRatio(a, b, matches, map), 0.85);
  double levels = 0;
  for (const Correspondence& match : matches) {
    levels += a.keypoints()[match.a].octave - b.keypoints()[match.b].octave;
  }
  EXPECT_NEAR(levels / static_cast<double>(matches.size()), 3, 0.4);
}

// Positions of coarse levels must not be shifted against those of fine ones: a square's corners are found in place.
TEST(OrbExtractor, PlacesCoarseKeypointsWithoutBias) {
  cv::Mat image(480, 640, CV_8UC1, cv::Scalar(40));
  std::vector<cv::Point2d> squares;
  for (int y = 90; y < 400; y += 100) {
    for (int x = 90; x < 560; x += 100) {
      image(cv::Rect(x - 4, y - 4, 9, 9)).setTo(200);  // centered on pixel (x, y)
      squares.emplace_back(x, y);
    }
  }
  cv::GaussianBlur(image, image, {7, 7}, 1.0);
  const FrameData frame = ExtractFrom(image);
  // By symmetry the mean offset of a level's keypoints from the nearest square's center is zero.
  std::vector<cv::Vec3d> sums(8, cv::Vec3d(0, 0, 0));
  for (const Keypoint& k : frame.keypoints()) {
    const auto nearest = std::min_element(squares.begin(), squares.end(), [&](const auto& a, const auto& b) {
      return std::hypot(a.x - k.x, a.y - k.y) < std::hypot(b.x - k.x, b.y - k.y);
    });
    sums[k.octave] += cv::Vec3d(k.x - nearest->x, k.y - nearest->y, 1);
  }
  for (std::size_t level = 0; level < sums.size(); ++level) {
    ASSERT_GE(sums[level][2], 20) << level;
    EXPECT_NEAR(sums[level][0] / sums[level][2], 0, 0.45) << level;
    EXPECT_NEAR(sums[level][1] / sums[level][2], 0, 0.45) << level;
  }
}

TEST(OrbExtractor, IsDeterministic) {
  const cv::Mat image = Textured(640, 480, 5);
  OrbExtractor used(OrbOptions{});
  const PinholeCamera camera = CameraOf(640, 480);
  const Image16 depth(640, 480, 1, 5000);
  (void)used.Extract(CameraOf(321, 243), ToImage(Textured(321, 243, 6)), Image16(321, 243));
  (void)used.Extract(camera, ToImage(Textured(640, 480, 7)), depth);
  OrbExtractor fresh(OrbOptions{});
  const FrameData a = used.Extract(camera, ToImage(image), depth);
  const FrameData b = fresh.Extract(camera, ToImage(image), depth);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a.descriptors()[i], b.descriptors()[i]);
    EXPECT_EQ(a.keypoints()[i].x, b.keypoints()[i].x);
    EXPECT_EQ(a.keypoints()[i].y, b.keypoints()[i].y);
    EXPECT_EQ(a.keypoints()[i].angle_deg, b.keypoints()[i].angle_deg);
    EXPECT_EQ(a.keypoints()[i].octave, b.keypoints()[i].octave);
  }
}

TEST(OrbExtractor, TakesImagesOfAnySize) {
  for (const auto& [width, height] : {std::pair{320, 240}, {641, 479}, {1280, 720}, {64, 500}, {500, 64}}) {
    const FrameData frame = ExtractFrom(Textured(width, height, 8));
    EXPECT_GT(frame.size(), 20U) << width << "x" << height;
    for (const Keypoint& k : frame.keypoints()) {
      const double margin = 18 * std::pow(1.2, k.octave);
      EXPECT_GE(k.x, margin);
      EXPECT_GE(k.y, margin);
      EXPECT_LE(k.x, width - 1 - margin);
      EXPECT_LE(k.y, height - 1 - margin);
      EXPECT_GE(k.angle_deg, 0);
      EXPECT_LT(k.angle_deg, 360);
    }
  }
  for (const auto& [width, height] : {std::pair{40, 40}, {39, 39}, {38, 38}, {37, 600}, {2, 2}, {1, 1}}) {
    const FrameData frame = ExtractFrom(Textured(width, height, 9));
    for (const Keypoint& k : frame.keypoints()) {
      EXPECT_EQ(k.octave, 0);  // the next level is smaller than a patch
    }
  }
}

TEST(OrbExtractor, HonoursItsOptions) {
  OrbOptions options;
  options.features = 300;
  options.levels = 3;
  options.scale_factor = 2.0;
  OrbExtractor extractor(options);
  EXPECT_EQ(extractor.pyramid().levels, 3);
  EXPECT_EQ(extractor.pyramid().scale[2], 4);
  const FrameData frame = extractor.Extract(CameraOf(640, 480), ToImage(Textured(640, 480, 10)), Image16(640, 480));
  EXPECT_LE(frame.size(), 300U);
  EXPECT_GE(frame.size(), 280U);
  for (const Keypoint& k : frame.keypoints()) {
    EXPECT_LT(k.octave, 3);
  }
  options.features = 0;
  EXPECT_EQ(ExtractFrom(Textured(640, 480, 10), options).size(), 0U);
  options.features = 70000;
  EXPECT_THROW(OrbExtractor{options}, InvariantError);
}

TEST(OrbExtractor, TreatsGrayAsColorOfEqualChannels) {
  const cv::Mat gray = Textured(320, 240, 11);
  cv::Mat bgr;
  cv::cvtColor(gray, bgr, cv::COLOR_GRAY2BGR);
  const FrameData a = ExtractFrom(gray);
  const FrameData b = ExtractFrom(bgr);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a.descriptors()[i], b.descriptors()[i]);
  }
}

TEST(OrbExtractor, WeighsTheColors) {
  // A pattern in blue against one of equal luminance in green has no corners; in one channel alone it has.
  cv::Mat bgr(240, 320, CV_8UC3, cv::Scalar(100, 100, 100));
  for (int y = 40; y < 200; y += 40) {
    for (int x = 40; x < 280; x += 40) {
      bgr(cv::Rect(x, y, 12, 12)).setTo(cv::Scalar(100, 151, 0));  // 0.587 * 51 = 0.299 * 100
    }
  }
  EXPECT_EQ(ExtractFrom(bgr).size(), 0U);
  for (int y = 40; y < 200; y += 40) {
    for (int x = 40; x < 280; x += 40) {
      bgr(cv::Rect(x, y, 12, 12)).setTo(cv::Scalar(100, 151, 100));
    }
  }
  EXPECT_GT(ExtractFrom(bgr).size(), 90U);
}

TEST(OrbExtractor, LooksUpDepth) {
  const cv::Mat image = Textured(640, 480, 12);
  PinholeCamera camera = CameraOf(640, 480);
  camera.depth_scale = 1000;
  camera.baseline_m = 0.1;
  Image16 depth(640, 480);
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) {
      depth.At(x, y) = static_cast<std::uint16_t>(x < 160 ? 0 : x < 320 ? 65535 : 1000 + x + y);
    }
  }
  OrbExtractor extractor(OrbOptions{});
  const FrameData frame = extractor.Extract(camera, ToImage(image), depth);
  int with_depth = 0;
  for (const Keypoint& k : frame.keypoints()) {
    const int x = static_cast<int>(std::lround(k.raw_x));
    const int y = static_cast<int>(std::lround(k.raw_y));
    EXPECT_EQ(k.x, k.raw_x);
    EXPECT_EQ(k.HasDepth(), x >= 320);
    if (k.HasDepth()) {
      ++with_depth;
      EXPECT_NEAR(k.depth_m, 1 + 0.001 * (x + y), 1e-5);
    } else {
      EXPECT_EQ(k.depth_m, 0);
    }
  }
  EXPECT_GT(with_depth, 300);
}

TEST(OrbExtractor, UndistortsKeypoints) {
  PinholeCamera camera = CameraOf(640, 480);
  camera.distortion = {0.2, -0.3, 0.002, -0.001, 0.1};
  OrbExtractor extractor(OrbOptions{});
  const FrameData frame = extractor.Extract(camera, ToImage(Textured(640, 480, 13)), Image16(640, 480, 1, 10000));
  ASSERT_GT(frame.size(), 900U);
  float largest = 0;
  for (const Keypoint& k : frame.keypoints()) {
    // Distorting the undistorted pixel gives the raw one back.
    const double x = (k.x - camera.cx) / camera.fx;
    const double y = (k.y - camera.cy) / camera.fy;
    const double r2 = x * x + y * y;
    const auto& [k1, k2, p1, p2, k3, none, of, these] = camera.distortion;
    const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    const double raw_x = camera.fx * (x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)) + camera.cx;
    const double raw_y = camera.fy * (y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y) + camera.cy;
    EXPECT_NEAR(raw_x, k.raw_x, 0.1);
    EXPECT_NEAR(raw_y, k.raw_y, 0.1);
    largest = std::max(largest, std::hypot(k.x - k.raw_x, k.y - k.raw_y));
  }
  EXPECT_GT(largest, 2);
}

TEST(OrbExtractor, RefusesImagesOfTheWrongSize) {
  OrbExtractor extractor(OrbOptions{});
  const PinholeCamera camera = CameraOf(320, 240);
  EXPECT_THROW((void)extractor.Extract(camera, Image8(320, 240), Image16(320, 241)), InvariantError);
  EXPECT_THROW((void)extractor.Extract(camera, Image8(320, 240), Image16()), InvariantError);
  EXPECT_THROW((void)extractor.Extract(camera, Image8(319, 240), Image16(320, 240)), InvariantError);
  EXPECT_THROW((void)extractor.Extract(camera, Image8(320, 240, 4), Image16(320, 240)), InvariantError);
  EXPECT_EQ(extractor.Extract(camera, Image8(320, 240), Image16(320, 240)).size(), 0U);
}

}  // namespace
}  // namespace rds
