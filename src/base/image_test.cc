// SPDX-License-Identifier: Apache-2.0
#include "base/image.h"

#include <gtest/gtest.h>

#include <array>

namespace rds {
namespace {

TEST(Image, IsRowMajorWithInterleavedChannels) {
  Image8 image(4, 3, 3, 7);
  EXPECT_EQ(image.data.size(), 36U);
  EXPECT_EQ(image.At(3, 2), 7);
  image.At(2, 1) = 9;
  EXPECT_EQ(image.data[(1 * 4 + 2) * 3], 9);
  EXPECT_EQ(image.Row(1) - image.Row(0), 12);
  EXPECT_FALSE(image.empty());
  EXPECT_TRUE(Image8().empty());
}

TEST(Image, CopiesRowsWithAStride) {
  constexpr std::array<std::uint16_t, 8> kSource = {1, 2, 3, 99, 4, 5, 6, 99};  // three columns and one of padding
  const Image16 image = Image16::Copy(kSource.data(), 3, 2, 1, 4 * sizeof(std::uint16_t));
  EXPECT_EQ(image.data, (std::vector<std::uint16_t>{1, 2, 3, 4, 5, 6}));
}

}  // namespace
}  // namespace rds
