// SPDX-License-Identifier: Apache-2.0
#include "io/image_io.h"

#include <gmock/gmock.h>

#include <cstring>
#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "io/image_bytes.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string Encode(const char* extension, const cv::Mat& image, const std::vector<int>& parameters = {}) {
  std::vector<unsigned char> bytes;
  cv::imencode(extension, image, bytes, parameters);
  return {bytes.begin(), bytes.end()};
}

cv::Mat ColorRamp() {
  cv::Mat image(12, 20, CV_8UC3);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      image.at<cv::Vec3b>(y, x) = cv::Vec3b(static_cast<uchar>(10 * x), static_cast<uchar>(20 * y), 7);
    }
  }
  return image;
}

cv::Mat DepthRamp() {
  cv::Mat image(12, 20, CV_16UC1);
  for (int i = 0; i < 240; ++i) {
    image.at<ushort>(i / 20, i % 20) = static_cast<ushort>(i * 273);
  }
  return image;
}

template <typename Function>
std::string ErrorOf(Function read, const std::string& bytes) {
  const TemporaryFolder folder;
  const auto path = folder.Write("picture", bytes);
  return InputErrorOf([&] { (void)read(path); });
}

TEST(ReadColor, GivesBgr) {
  const TemporaryFolder folder;
  const Image8 image = ReadColor(folder.Write("a.png", Encode(".png", ColorRamp())));
  ASSERT_EQ(image.width, 20);
  ASSERT_EQ(image.height, 12);
  ASSERT_EQ(image.channels, 3);
  EXPECT_EQ(image.Row(2)[3 * 5 + 0], 50);
  EXPECT_EQ(image.Row(2)[3 * 5 + 1], 40);
  EXPECT_EQ(image.Row(2)[3 * 5 + 2], 7);
}

TEST(ReadColor, ReadsGrayAndJpegToo) {
  const TemporaryFolder folder;
  const Image8 gray = ReadColor(folder.Write("a.png", Encode(".png", cv::Mat(5, 6, CV_8UC1, cv::Scalar(9)))));
  EXPECT_EQ(gray.channels, 3);
  EXPECT_EQ(gray.data, std::vector<std::uint8_t>(90, 9));
  for (const int progressive : {0, 1}) {
    const std::string bytes = Encode(".jpg", cv::Mat(50, 60, CV_8UC3, cv::Scalar(10, 100, 200)),
                                     {cv::IMWRITE_JPEG_PROGRESSIVE, progressive, cv::IMWRITE_JPEG_RST_INTERVAL, 2});
    const Image8 image = ReadColor(folder.Write("a.jpg", bytes));
    EXPECT_EQ(image.width, 60);
    EXPECT_EQ(image.height, 50);
    EXPECT_NEAR(image.data[0], 10, 3);
    EXPECT_NEAR(image.data.back(), 200, 3);
  }
}

TEST(ReadDepth, GivesStoredNumbers) {
  const TemporaryFolder folder;
  const Image16 image = ReadDepth(folder.Write("a.png", Encode(".png", DepthRamp())));
  ASSERT_EQ(image.width, 20);
  ASSERT_EQ(image.height, 12);
  ASSERT_EQ(image.channels, 1);
  EXPECT_EQ(image.At(3, 2), 43 * 273);
}

TEST(ReadMask, IsBlackAndWhite) {
  const TemporaryFolder folder;
  cv::Mat mask(2, 3, CV_8UC1, cv::Scalar(0));
  mask.at<uchar>(1, 2) = 1;
  EXPECT_THAT(ReadMask(folder.Write("a.png", Encode(".png", mask))).data, ::testing::ElementsAre(0, 0, 0, 0, 0, 255));
  cv::Mat color(1, 2, CV_8UC3, cv::Scalar(0, 0, 0));
  color.at<cv::Vec3b>(0, 1) = {0, 0, 128};
  EXPECT_THAT(ReadMask(folder.Write("a.png", Encode(".png", color))).data, ::testing::ElementsAre(0, 255));
}

// Decoders give out the upper part of a truncated picture; here every cut is an error.
TEST(ImageIo, FindsEveryTruncation) {
  for (const std::string& bytes :
       {Encode(".png", DepthRamp()), Encode(".png", ColorRamp()), Encode(".jpg", ColorRamp()),
        Encode(".jpg", ColorRamp(), {cv::IMWRITE_JPEG_PROGRESSIVE, 1})}) {
    std::string whole = bytes;
    EXPECT_EQ(InspectImage("picture", whole).width, 20);
    for (std::size_t size = 1; size < bytes.size(); ++size) {
      std::string cut = bytes.substr(0, size);
      ASSERT_THAT(InputErrorOf([&] { (void)InspectImage("picture", cut); }),
                  HasSubstr("picture: the image file is truncated"))
          << size << " of " << bytes.size() << " bytes";
    }
  }
  EXPECT_THAT(ErrorOf(ReadColor, ""), HasSubstr("picture: the image file is empty"));
}

TEST(ImageIo, FindsDamage) {
  const std::string bytes = Encode(".png", DepthRamp());
  for (std::size_t at = 16; at + 12 < bytes.size(); at += 7) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    EXPECT_THAT(ErrorOf(ReadDepth, damaged), HasSubstr("picture: the image file is")) << at;
  }
}

TEST(ImageIo, DropsAncillaryChunksAndBytesAfterTheEnd) {
  const std::string bytes = Encode(".png", DepthRamp());
  // A text chunk (its CRC computed with zlib) after the header chunk, which ends at byte 33.
  const std::string text("\0\0\0\3tEXta\0b\xDC\x49\xA2\x3B", 15);
  std::string longer = bytes.substr(0, 33) + text + bytes.substr(33) + "rubbish";
  InspectImage("picture", longer);
  EXPECT_EQ(longer, bytes);
}

TEST(ImageIo, SaysWhatIsWrongWithTheKind) {
  const std::string depth8 = Encode(".png", cv::Mat(4, 5, CV_8UC1, cv::Scalar(1)));
  EXPECT_THAT(ErrorOf(ReadDepth, depth8),
              AllOf(HasSubstr("picture: a depth image of 8 bits and 1 channel;"), HasSubstr("16 bits")));
  EXPECT_THAT(ErrorOf(ReadDepth, Encode(".jpg", ColorRamp())),
              HasSubstr("picture: a depth image of 8 bits and 3 channels;"));
  EXPECT_THAT(ErrorOf(ReadDepth, Encode(".png", cv::Mat(4, 5, CV_16UC3, cv::Scalar(1)))),
              HasSubstr("16 bits and 3 channels;"));
  EXPECT_THAT(ErrorOf(ReadColor, Encode(".png", DepthRamp())),
              AllOf(HasSubstr("picture: a color image of 16 bits"), HasSubstr("swapped?")));
  EXPECT_THAT(ErrorOf(ReadMask, Encode(".png", DepthRamp())),
              HasSubstr("picture: a mask of 16 bits a channel; 8 are wanted"));
  EXPECT_THAT(ErrorOf(ReadColor, "GIF89a and more"),
              HasSubstr("picture: a GIF image, which is not read; convert it to PNG"));
  EXPECT_THAT(InputErrorOf([] { (void)ReadColor("/none.png"); }), HasSubstr("/none.png: cannot be read: No such file"));
}

TEST(ImageIo, ReadsTheOtherFormats) {
  const TemporaryFolder folder;
  const cv::Mat color = ColorRamp();
  for (const char* extension : {".bmp", ".ppm", ".tiff", ".webp", ".png"}) {
    const std::vector<int> lossless =
        extension == std::string(".webp") ? std::vector<int>{cv::IMWRITE_WEBP_QUALITY, 101} : std::vector<int>{};
    const Image8 image = ReadColor(folder.Write("picture", Encode(extension, color, lossless)));
    ASSERT_EQ(image.data.size(), color.total() * 3) << extension;
    EXPECT_EQ(std::memcmp(image.data.data(), color.data, image.data.size()), 0) << extension;
  }
  const cv::Mat depth = DepthRamp();
  for (const char* extension : {".pgm", ".tiff", ".png"}) {
    const Image16 image = ReadDepth(folder.Write("picture", Encode(extension, depth)));
    ASSERT_EQ(image.data.size(), depth.total()) << extension;
    EXPECT_EQ(std::memcmp(image.data.data(), depth.data, 2 * image.data.size()), 0) << extension;
  }
}

TEST(ImageIo, FloatingPointDepthIsMeters) {
  const TemporaryFolder folder;
  cv::Mat meters(2, 3, CV_32FC1, cv::Scalar(1.5F));
  meters.at<float>(0, 1) = std::numeric_limits<float>::quiet_NaN();
  meters.at<float>(1, 0) = 1000;
  meters.at<float>(1, 1) = -1;
  std::string npy("\x93NUMPY\x01\x00\x76\x00", 10);
  npy += "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }";
  npy.resize(127, ' ');
  npy += "\n" + std::string(reinterpret_cast<const char*>(meters.data), 24);
  for (const std::string& bytes : {npy, Encode(".tiff", meters)}) {
    EXPECT_THAT(ImageFile(folder.Write("picture", bytes)).DecodeDepth(1000).data,
                ::testing::ElementsAre(1500, 0, 1500, 0, 0, 1500));
  }
  for (std::size_t size = 0; size < npy.size(); size += 7) {
    EXPECT_NE(ErrorOf(ReadDepth, npy.substr(0, size)), "") << size;
  }
  npy.replace(npy.find("f4"), 2, "c8");
  EXPECT_THAT(ErrorOf(ReadDepth, npy), HasSubstr("of float32, float64 (meters) or uint16"));
}

TEST(ImageIo, SaysWhatToDoWithWhatIsNotRead) {
  EXPECT_THAT(ErrorOf(ReadDepth, "\x76\x2F\x31\x01 and so on"), HasSubstr("OpenEXR image, which is not read; convert"));
  EXPECT_THAT(ErrorOf(ReadColor, "version https://git-lfs.github.com/spec/v1\n"), HasSubstr("git lfs pull"));
  EXPECT_THAT(ErrorOf(ReadColor, "<html>404</html>"), HasSubstr("a web page, not an image"));
  EXPECT_THAT(ErrorOf(ReadColor, "P3 1 1 255 0 0 0"), HasSubstr("written as text"));
  EXPECT_THAT(ErrorOf(ReadColor, "MZ and so on"), HasSubstr("no image that is read here"));
}

// A decoder that fails must not leave a black picture behind.
TEST(ImageIo, WhatTheDecoderRefusesIsAnError) {
  std::string interlaced = Encode(".png", ColorRamp());
  interlaced[28] = 2;                             // no such interlacing
  interlaced.replace(29, 4, "\x3A\x0B\x7E\xD8");  // its CRC
  const std::string jpeg = Encode(".jpg", ColorRamp());
  const std::size_t table = jpeg.find("\xFF\xDB");
  std::string without_table = jpeg;
  without_table.erase(table, 2 + static_cast<std::size_t>(static_cast<unsigned char>(jpeg[table + 3])));
  for (const std::string& bytes : {interlaced, without_table}) {
    EXPECT_THAT(ErrorOf(ReadColor, bytes), HasSubstr("picture: the image file is damaged"));
  }
}

}  // namespace
}  // namespace rds
