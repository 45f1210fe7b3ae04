// SPDX-License-Identifier: Apache-2.0
#include "io/ignored_pixels.h"

#include <gmock/gmock.h>

#include "io/image_io.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::HasSubstr;

PinholeCamera SmallCamera() {
  PinholeCamera camera;
  camera.width = 320;
  camera.height = 240;
  return camera;
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

TEST(IgnoredPixels, FilesThatCannotBeUsedAreRefused) {
  const TemporaryFolder folder;
  const auto error = [&](const std::filesystem::path& path) {
    return InputErrorOf([&] { (void)LoadIgnoredPixels(path, SmallCamera()); });
  };
  EXPECT_THAT(error(folder.path() / "none.png"), HasSubstr("none.png"));
  EXPECT_THAT(error(folder.Write("text.png", "text")), HasSubstr("text.png"));
}

}  // namespace
}  // namespace rds
