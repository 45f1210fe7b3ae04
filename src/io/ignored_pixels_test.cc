// SPDX-License-Identifier: Apache-2.0
#include "io/ignored_pixels.h"

#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "testing/temporary_folder.h"
#include "testing/view.h"

namespace rds {
namespace {

using ::testing::HasSubstr;

// A PNG, black but for this many rows from below.
std::string Png(int width, int height, int rows) {
  cv::Mat image(height, width, CV_8UC1, cv::Scalar::all(0));
  image.rowRange(height - rows, height).setTo(255);
  std::vector<unsigned char> bytes;
  cv::imencode(".png", image, bytes);
  return {bytes.begin(), bytes.end()};
}

TEST(IgnoredPixels, HaveNoCornersAndNoDepthThereAndAround) {
  Image8 mask(320, 240);
  for (int y = 200; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      mask.At(x, y) = 255;
    }
  }
  Image8 color(320, 240, 3, 7);
  Image16 depth(320, 240, 1, 1000);
  IgnoredPixels(mask).Apply(color, depth);
  EXPECT_EQ(color.At(160, 220, 1), 128);
  EXPECT_EQ(color.At(160, 195, 1), 7);
  EXPECT_EQ(depth.At(160, 220), 0);
  EXPECT_EQ(depth.At(160, 195), 0);  // beside it
  EXPECT_EQ(depth.At(160, 180), 1000);
}

TEST(IgnoredPixels, OfAFileAreWhatIsNotBlack) {
  const TemporaryFolder folder;
  const IgnoredPixels pixels = LoadIgnoredPixels(folder.Write("mask.png", Png(640, 480, 80)), TestCamera());
  Image8 color(640, 480, 1, 7);
  Image16 depth(640, 480, 1, 1000);
  pixels.Apply(color, depth);
  EXPECT_EQ(color.At(10, 400), 128);
  EXPECT_EQ(color.At(10, 399), 7);
}

TEST(IgnoredPixels, FilesThatCannotBeUsedAreRefused) {
  const TemporaryFolder folder;
  const auto error = [&](const std::filesystem::path& path) {
    return InputErrorOf([&] { (void)LoadIgnoredPixels(path, TestCamera()); });
  };
  EXPECT_THAT(error(folder.Write("small.png", Png(320, 240, 10))), HasSubstr("small.png"));
  EXPECT_THAT(error(folder.Write("white.png", Png(640, 480, 450))), HasSubstr("94 % of the image would be ignored"));
  EXPECT_THAT(error(folder.path() / "none.png"), HasSubstr("none.png"));
  EXPECT_THAT(error(folder.Write("text.png", "text")), HasSubstr("text.png"));
}

}  // namespace
}  // namespace rds
