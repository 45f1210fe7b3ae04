// SPDX-License-Identifier: Apache-2.0
#include "segmentation/mask.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "base/random.h"

namespace rds {
namespace {

Image8 RandomMask(int width, int height, int set_pixels, std::uint64_t seed) {
  Random random(seed);
  Image8 mask(width, height);
  for (int i = 0; i < set_pixels; ++i) {
    mask.At(static_cast<int>(random.Index(static_cast<std::uint32_t>(width))),
            static_cast<int>(random.Index(static_cast<std::uint32_t>(height)))) = 255;
  }
  return mask;
}

TEST(MaskTest, DilationEqualsOpenCvForEveryRadius) {
  for (const int radius : {0, 1, 2, 3, 7, 15, 30}) {
    for (const int set : {0, 1, 12, 400}) {
      const Image8 mask = RandomMask(97, 61, set, static_cast<std::uint64_t>(radius * 1000 + set));
      const cv::Mat from(mask.height, mask.width, CV_8U, const_cast<std::uint8_t*>(mask.data.data()));
      cv::Mat expected;
      cv::dilate(from, expected,
                 cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(2 * radius + 1, 2 * radius + 1)));
      const Image8 dilated = Dilate(mask, radius);
      const cv::Mat actual(mask.height, mask.width, CV_8U, const_cast<std::uint8_t*>(dilated.data.data()));
      EXPECT_EQ(cv::countNonZero(actual != expected), 0) << "radius " << radius << ", " << set << " pixels set";
    }
  }
}

TEST(MaskTest, DilationReachesAcrossALargeImageWithoutWrapping) {
  Image8 mask(1000, 3);
  mask.At(0, 1) = 1;
  const Image8 dilated = Dilate(mask, 254);
  EXPECT_EQ(dilated.At(254, 1), 255);
  EXPECT_EQ(dilated.At(255, 1), 0);
  EXPECT_EQ(dilated.At(999, 1), 0);
}

TEST(MaskTest, RadiusScalesWithTheImage) {
  EXPECT_EQ(DilationRadius(640, 15), 15);
  EXPECT_EQ(DilationRadius(320, 15), 8);
  EXPECT_EQ(DilationRadius(1280, 15), 30);
  EXPECT_EQ(DilationRadius(640, 0), 0);
}

TEST(MaskTest, ProbabilityIsTheSoftmaxOfTheLabels) {
  // Two cells, three classes.
  const std::vector<float> last = {0, 1, 2, 500, 0, 500};
  const std::vector<float> first = {0, 500, 1, 0, 2, 500};
  const double sum = 1 + std::exp(1.0) + std::exp(2.0);
  for (const auto& [logits, order] : {std::pair{last, ChannelOrder::kLast}, std::pair{first, ChannelOrder::kFirst}}) {
    const std::vector<int> one = {2};
    const std::vector<float> p = ClassProbability(logits, 2, 3, order, one);
    EXPECT_NEAR(p[0], std::exp(2.0) / sum, 1e-6);
    EXPECT_NEAR(p[1], 0.5, 1e-6);
    const std::vector<int> two = {0, 2};
    EXPECT_NEAR(ClassProbability(logits, 2, 3, order, two)[0], (1 + std::exp(2.0)) / sum, 1e-6);
  }
  const std::vector<int> beyond = {3};
  EXPECT_THROW(std::ignore = ClassProbability(last, 2, 3, ChannelOrder::kLast, beyond), InvariantError);
}

TEST(MaskTest, ProbabilityIsUpsampledWhereTheCellsLie) {
  // Cells at input pixels 0, 16, 32 of 33; the image has the input's size: half way between 0 and 1 lies pixel 8.
  const ScoreGrid grid{.width = 3, .height = 1, .stride_x = 16, .stride_y = 16, .input_width = 33, .input_height = 1};
  const std::vector<float> probability = {0, 1, 0};
  const Image8 mask = MaskFromProbability(probability, grid, 33, 1, 0.49F, 0.49F);
  for (int x = 0; x < 33; ++x) {
    EXPECT_EQ(mask.At(x, 0), x >= 8 && x <= 24 ? 255 : 0) << x;
  }
  ScoreGrid shifted = grid;
  shifted.offset_x = 4;
  const Image8 moved = MaskFromProbability(probability, shifted, 33, 1, 0.49F, 0.49F);
  EXPECT_EQ(moved.At(11, 0), 0);
  EXPECT_EQ(moved.At(12, 0), 255);
}

TEST(MaskTest, BetweenTheTwoThresholdsAPixelIsUnsure) {
  const ScoreGrid grid{.width = 3, .height = 1, .stride_x = 1, .stride_y = 1, .input_width = 3, .input_height = 1};
  const std::vector<float> probability = {0.05F, 0.2F, 0.6F};
  const Image8 mask = MaskFromProbability(probability, grid, 3, 1, 0.5F, 0.1F);
  EXPECT_EQ(mask.data, (std::vector<std::uint8_t>{kStaticPixel, kUnsurePixel, kDynamicPixel}));
}

TEST(MaskTest, DilationGrowsWhatIsDynamicAndLeavesTheUnsure) {
  Image8 mask(7, 1);
  mask.data = {0, 0, 255, 0, 128, 0, 0};
  EXPECT_EQ(Dilate(mask, 1).data, (std::vector<std::uint8_t>{0, 255, 255, 255, 128, 0, 0}));
  EXPECT_EQ(Dilate(mask, 2).data, (std::vector<std::uint8_t>{255, 255, 255, 255, 255, 0, 0}));
}

TEST(MaskTest, UpsamplingScalesToAnImageOfAnotherSize) {
  // The right half of the input is dynamic, so the right half of any image is.
  const ScoreGrid grid{.width = 4,
                       .height = 2,
                       .stride_x = 8,
                       .stride_y = 8,
                       .offset_x = 3.5,
                       .offset_y = 3.5,
                       .input_width = 32,
                       .input_height = 16};
  const std::vector<float> probability = {0, 0, 1, 1, 0, 0, 1, 1};
  const Image8 mask = MaskFromProbability(probability, grid, 100, 40, 0.5F, 0.5F);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 100; ++x) {
      EXPECT_EQ(mask.At(x, y), x >= 50 ? 255 : 0) << x << " " << y;
    }
  }
}

TEST(MaskTest, LabelsAreTakenFromTheNearestCell) {
  const ScoreGrid grid{.width = 2, .height = 2, .input_width = 2, .input_height = 2};
  const std::vector<int> cells = {15, 0, 3, 2};
  const std::vector<int> labels = {15, 2};
  const Image8 mask = MaskFromLabels(cells, grid, 4, 4, labels);
  EXPECT_EQ(mask.At(0, 0), 255);
  EXPECT_EQ(mask.At(1, 1), 255);
  EXPECT_EQ(mask.At(3, 0), 0);
  EXPECT_EQ(mask.At(0, 3), 0);
  EXPECT_EQ(mask.At(3, 3), 255);
}

TEST(MaskTest, UnusableMasksAreNamed) {
  EXPECT_FALSE(MaskProblem(Image8(64, 48), 64, 48, 0.95));
  EXPECT_FALSE(MaskProblem(Image8(64, 48, 1, 255), 64, 48, 1.0));
  EXPECT_TRUE(MaskProblem(Image8(64, 48, 1, 255), 64, 48, 0.95));
  EXPECT_TRUE(MaskProblem(Image8(64, 48, 3), 64, 48, 0.95));
  EXPECT_NE(MaskProblem(Image8(48, 64), 64, 48, 0.95).value_or("").find("64 x 48"), std::string::npos);
  EXPECT_TRUE(MaskProblem(Image8(), 64, 48, 0.95));
  Image8 cut(64, 48);
  cut.data.resize(10);
  EXPECT_TRUE(MaskProblem(cut, 64, 48, 0.95));
}

TEST(ClassProbability, RefusesWhatIsNotFinite) {
  const std::vector<int> labels = {1};
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    const std::vector<float> logits = {0, 1, 2, bad};  // two cells of two classes
    EXPECT_THROW(static_cast<void>(ClassProbability(logits, 2, 2, ChannelOrder::kLast, labels)), InputError);
  }
  const std::vector<float> masked = {0, -std::numeric_limits<float>::infinity()};
  EXPECT_EQ(ClassProbability(masked, 1, 2, ChannelOrder::kLast, labels).at(0), 0) << "a class that is ruled out";
}

}  // namespace
}  // namespace rds
