// SPDX-License-Identifier: Apache-2.0
#include "io/dataset.h"

#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

PinholeCamera SmallCamera() {
  PinholeCamera camera;
  camera.width = 20;
  camera.height = 12;
  return camera;
}

std::string Png(int type, int width = 20, int height = 12, double value = 7) {
  std::vector<unsigned char> bytes;
  cv::imencode(".png", cv::Mat(height, width, type, cv::Scalar::all(value)), bytes);
  return {bytes.begin(), bytes.end()};
}

// A sequence of three frames at 1.00, 1.03 and 1.06 s in TUM layout, each file to be replaced by a test.
class DatasetTest : public ::testing::Test {
 protected:
  DatasetTest() {
    std::string rgb = "# color\n";
    std::string depth = "# depth\n";
    std::string truth;
    for (const char* time : {"1.00", "1.03", "1.06"}) {
      Write(std::string("rgb/") + time + ".png", Png(CV_8UC3));
      Write(std::string("depth/") + time + ".png", Png(CV_16UC1, 20, 12, 5000));
      rgb += std::string(time) + " rgb/" + time + ".png\n";
      depth += std::string(time) + "5 depth/" + time + ".png\n";
      truth += std::string(time) + " 1 2 3 0 0 0 1\n";
    }
    Write("rgb.txt", rgb);
    Write("depth.txt", depth);
    Write("groundtruth.txt", truth);
  }

  void Write(const std::string& name, const std::string& bytes) { folder_.Write(name, bytes); }
  [[nodiscard]] Dataset Open(const DatasetOptions& options = {}) const {
    return Dataset::Open(folder_.path(), options);
  }
  [[nodiscard]] std::string OpenError(const DatasetOptions& options = {}) const {
    return InputErrorOf([&] { (void)Open(options); });
  }
  [[nodiscard]] std::string LoadError(std::size_t index) const {
    const Dataset dataset = Open();
    return InputErrorOf([&] { (void)dataset.Load(index, SmallCamera()); });
  }

  TemporaryFolder folder_;
};

TEST_F(DatasetTest, SegmentedMasksHaveUnsurePixelsAndTimesInSeconds) {
  const TemporaryFolder masks;
  masks.Write("m.png", Png(CV_8UC1, 20, 12, 128));
  masks.Write("mask.txt", "# rds segment: some network\n1.03 m.png\n");
  Write("mask.txt", "1.03 none.png\n");
  DatasetOptions options;
  options.masks = masks.path();
  const Dataset dataset = Open(options);
  ASSERT_TRUE(dataset.MasksHaveUnsure());
  const auto path = dataset.frames()[1].mask_path;
  EXPECT_EQ(path, masks.path() / "m.png");
  EXPECT_EQ(LoadMask(path, SmallCamera(), true).data[0], 128);
  EXPECT_EQ(LoadMask(path, SmallCamera()).data[0], 255);
}

TEST_F(DatasetTest, OpensAndLoads) {
  const Dataset dataset = Open();
  ASSERT_EQ(dataset.size(), 3U);
  EXPECT_EQ(dataset.Name(), folder_.path().filename().string());
  EXPECT_EQ(dataset.frames()[1].timestamp_s, 1.03);
  EXPECT_EQ(dataset.frames()[1].depth_timestamp_s, 1.035);
  EXPECT_EQ(dataset.color_images_without_depth(), 0U);
  EXPECT_NEAR(dataset.MedianIntervalS(), 0.03, 1e-9);
  EXPECT_FALSE(dataset.HasMasks());
  ASSERT_TRUE(dataset.ground_truth());
  EXPECT_EQ(dataset.ground_truth()->size(), 3U);
  const RgbdFrame frame = dataset.Load(2, SmallCamera());
  EXPECT_EQ(frame.timestamp_s, 1.06);
  EXPECT_EQ(frame.image->channels, 3);
  EXPECT_EQ(frame.image->data[0], 7);
  EXPECT_EQ(frame.depth->data[0], 5000);
  EXPECT_TRUE(dataset.frames()[0].mask_path.empty());
  EXPECT_EQ(dataset.Summary(), dataset.Name() + ": 3 frames");
}

TEST_F(DatasetTest, CountsFramesWithoutDepth) {
  Write("depth.txt", "1.005 depth/1.00.png\n1.07 depth/1.06.png\n");
  const Dataset dataset = Open();
  ASSERT_EQ(dataset.size(), 2U);
  EXPECT_EQ(dataset.frames()[1].timestamp_s, 1.06);
  EXPECT_EQ(dataset.listed_color_images(), 3U);
  EXPECT_EQ(dataset.color_images_without_depth(), 1U);
  EXPECT_THAT(dataset.Summary(), HasSubstr(": 2 frames; 1 of 3 color images have no depth image within 0.02 s"));
}

TEST_F(DatasetTest, PrefersAssociations) {
  Write("associations.txt", "1.00 rgb/1.00.png 1.06 depth/1.06.png\n");
  EXPECT_EQ(Open().size(), 1U);
  EXPECT_EQ(Open().frames()[0].depth_path.filename(), "1.06.png");
}

TEST_F(DatasetTest, ReadsAssociationsInEitherOrderAndUnderEitherName) {
  Write("associate.txt", "1.005 depth/1.00.png 1.00 rgb/1.00.png\n1.035 depth/1.03.png 1.03 rgb/1.03.png\n");
  const Dataset dataset = Open();
  ASSERT_EQ(dataset.size(), 2U);
  EXPECT_EQ(dataset.frames()[1].timestamp_s, 1.03);
  EXPECT_EQ(dataset.frames()[1].color_path, folder_.path() / "rgb/1.03.png");
  EXPECT_EQ(dataset.frames()[1].depth_timestamp_s, 1.035);
}

TEST_F(DatasetTest, WorksWithoutGroundTruthAndWithMasks) {
  std::filesystem::remove(folder_.path() / "groundtruth.txt");
  Write("mask.txt", "1.03 mask/b.png\n");
  Write("mask/b.png", Png(CV_8UC1));
  const Dataset dataset = Open();
  EXPECT_FALSE(dataset.ground_truth());
  EXPECT_TRUE(dataset.HasMasks());
  EXPECT_TRUE(dataset.frames()[0].mask_path.empty());
  const auto mask = dataset.frames()[1].mask_path;
  EXPECT_EQ(LoadMask(mask, SmallCamera()).data[0], 255);
  Write("mask/b.png", Png(CV_8UC1, 10, 10));
  EXPECT_THAT(InputErrorOf([&] { (void)LoadMask(mask, SmallCamera()); }), HasSubstr("b.png: 10 x 10 pixels"));
}

TEST_F(DatasetTest, TakesARangeOfFrames) {
  DatasetOptions options;
  options.frames = ParseFrameRange("1:3");
  const Dataset dataset = Open(options);
  ASSERT_EQ(dataset.size(), 2U);
  EXPECT_EQ(dataset.frames()[0].timestamp_s, 1.03);
  EXPECT_THAT(dataset.Summary(), HasSubstr(": 2 frames (1:3 of 3)"));
  options.frames = ParseFrameRange("1:4");
  EXPECT_THAT(OpenError(options), HasSubstr("frames 1:4 asked for, the sequence has 0:3"));
  options.frames = ParseFrameRange("3:");
  EXPECT_THAT(OpenError(options), HasSubstr("frames 3: asked for, the sequence has 0:3"));
}

TEST(ParseFrameRange, ReadsAllForms) {
  EXPECT_EQ(ParseFrameRange("2:5").begin, 2U);
  EXPECT_EQ(ParseFrameRange("2:5").end, 5U);
  EXPECT_EQ(ParseFrameRange("2:").end, std::nullopt);
  EXPECT_EQ(ParseFrameRange(":5").begin, 0U);
  EXPECT_EQ(ParseFrameRange(":").end, std::nullopt);
  for (const char* bad : {"", "5", "5:5", "6:5", "a:b", "1:b", "-1:5", "1:2:3", "1.5:2", "0:99999999999999999999999"}) {
    EXPECT_THAT(InputErrorOf([&] { (void)ParseFrameRange(bad); }), HasSubstr("A:B is wanted")) << bad;
  }
}

TEST_F(DatasetTest, RefusesBrokenFolders) {
  EXPECT_THAT(InputErrorOf([] { (void)Dataset::Open("/no/such"); }), HasSubstr("/no/such: no such sequence folder"));
  EXPECT_THAT(InputErrorOf([&] { (void)Dataset::Open(folder_.path() / "rgb.txt"); }),
              HasSubstr("not a sequence folder"));
  std::filesystem::remove(folder_.path() / "depth.txt");
  EXPECT_THAT(OpenError(), AllOf(HasSubstr("no depth.txt in it"), HasSubstr("associations.txt")));
}

TEST_F(DatasetTest, RefusesBrokenLists) {
  Write("rgb.txt", "# nothing\n");
  EXPECT_THAT(OpenError(), HasSubstr("rgb.txt: no images are listed in it"));
  Write("rgb.txt", "1.00 rgb/1.00.png\n1.03\n");
  EXPECT_THAT(OpenError(), HasSubstr("rgb.txt:2: 1 columns; 'timestamp file' is wanted"));
  Write("rgb.txt", "one rgb/1.00.png\n");
  EXPECT_THAT(OpenError(), HasSubstr("rgb.txt:1: timestamp is 'one', not a finite number"));
  Write("rgb.txt", "#\n1.03 rgb/1.03.png\n1.00 rgb/1.00.png\n");
  EXPECT_THAT(OpenError(), HasSubstr("rgb.txt:3: timestamp 1.000000 does not come after"));
  Write("rgb.txt", "1.00 rgb/1.00.png\n1.00 rgb/1.03.png\n");
  EXPECT_THAT(OpenError(), HasSubstr("rgb.txt:2: timestamp 1.000000 does not come after"));
  Write("rgb.txt", "1.00 rgb/1.00.png\n1.03 rgb/none.png\n");
  EXPECT_THAT(OpenError(), AllOf(HasSubstr("rgb.txt:2: image"), HasSubstr("none.png is not there")));
  Write("rgb.txt", "9.00 rgb/1.00.png\n");
  EXPECT_THAT(OpenError(), AllOf(HasSubstr("no depth image within 0.02 s"), HasSubstr("one clock?")));
}

TEST_F(DatasetTest, WhatIsNotNeededEndsNothing) {
  DatasetOptions with_masks;
  with_masks.needs_masks = true;
  Write("mask.txt", "1.03 mask/none.png\n");
  EXPECT_EQ(OpenError(), "");
  EXPECT_FALSE(Open().HasMasks());
  EXPECT_THAT(OpenError(with_masks), HasSubstr("mask.txt:1: image"));
  std::filesystem::remove(folder_.path() / "mask.txt");
  Write("groundtruth.txt", "1 0 0 many 0 0 0 1\n");
  EXPECT_EQ(OpenError(), "");
  EXPECT_FALSE(Open().ground_truth());
  Write("depth.txt", "1.00 depth/none.png\n");
  EXPECT_THAT(OpenError(), HasSubstr("depth.txt:1: image"));
}

TEST_F(DatasetTest, KnowsListsByOtherNames) {
  for (const char* name : {"association.txt", "associated.txt"}) {
    Write(name, "1.00 rgb/1.00.png 1.06 depth/1.06.png\n");
    EXPECT_EQ(Open().size(), 1U) << name;
    std::filesystem::remove(folder_.path() / name);
  }
  std::filesystem::rename(folder_.path() / "rgb.txt", folder_.path() / "color.txt");
  std::filesystem::rename(folder_.path() / "depth.txt", folder_.path() / "aligned_depth.txt");
  EXPECT_EQ(Open().size(), 3U);
}

TEST_F(DatasetTest, TellsDepthFromColorByThePictures) {
  std::filesystem::rename(folder_.path() / "depth", folder_.path() / "aligned");
  Write("associations.txt", "1.005 ./aligned/1.00.png 1.00 rgb/1.00.png\n");
  EXPECT_EQ(Open().frames()[0].color_path.parent_path().filename(), "rgb");
  EXPECT_EQ(Open().frames()[0].timestamp_s, 1.00);
}

TEST_F(DatasetTest, FindsTheImagesAmongOtherColumns) {
  Write("associations.txt", "1.00 1 2 3 0 0 0 1 1.005 depth/1.00.png 1.00 rgb/1.00.png\n");
  EXPECT_EQ(Open().frames()[0].depth_timestamp_s, 1.005);
  Write("associations.txt", "1.00 \"rgb/1.00.png\" 1.005 ['depth/1.00.png'] 1.00 1 2 3 0 0 0 1\n");
  EXPECT_EQ(Open().frames()[0].depth_timestamp_s, 1.005);
  EXPECT_EQ(Open().frames()[0].color_path.filename(), "1.00.png");
}

TEST_F(DatasetTest, ReadsListsOfEveryEditor) {
  Write("rgb.txt", "\xEF\xBB\xBF# color\r1.00 rgb/1.00.png\r1.03 rgb/1.03.png\r1.06 rgb/1.06.png\r");
  EXPECT_EQ(Open().size(), 3U);
  Write("rgb.txt", std::string("\xFF\xFE"
                               "1\0.\0",
                               6));
  EXPECT_THAT(OpenError(), HasSubstr("UTF-16"));
}

TEST_F(DatasetTest, TimesOfOtherUnitsBecomeSeconds) {
  Write("associations.txt",
        "1700000000000000000 rgb/1.00.png 1700000000000000000 depth/1.00.png\n"
        "1700000000033000000 rgb/1.03.png 1700000000033000000 depth/1.03.png\n");
  EXPECT_NEAR(Open().frames()[1].timestamp_s, 1700000000.033, 1e-6);
  EXPECT_NEAR(Open().frames()[1].depth_timestamp_s, 1700000000.033, 1e-6);
  std::filesystem::remove(folder_.path() / "associations.txt");
  Write("rgb.txt", "0 rgb/1.00.png\n1 rgb/1.03.png\n2 rgb/1.06.png\n");
  Write("depth.txt", "0 depth/1.00.png\n1 depth/1.03.png\n2 depth/1.06.png\n");
  Write("groundtruth.txt", "0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n2 1 2 3 0 0 0 1\n");
  EXPECT_NEAR(Open().frames()[2].timestamp_s, 2.0 / 30, 1e-9);
  EXPECT_NEAR(Open().ground_truth()->back().timestamp_s, 2.0 / 30, 1e-9);
  Write("mask/b.png", Png(CV_8UC1));
  Write("mask.txt", "2 mask/b.png\n");  // one alone does not tell its unit
  EXPECT_EQ(Open().frames()[2].mask_path.filename(), "b.png");
  Write("groundtruth.txt", "1 0 0 5 0 1 0 6 0 0 1 7\n1 0 0 5 0 1 0 6 0 0 1 7\n1 0 0 5 0 1 0 6 0 0 1 8\n");  // KITTI
  EXPECT_NEAR(Open().ground_truth()->back().timestamp_s, 2.0 / 30, 1e-9);
  EXPECT_EQ(Open().ground_truth()->back().world_from_camera.translation.z(), 8);
}

TEST_F(DatasetTest, SizesAreCheckedBeforeAnythingIsDecoded) {
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", cv::Mat(12, 20, CV_8UC3, cv::Scalar::all(7)), bytes);
  std::string jpeg(bytes.begin(), bytes.end());
  const std::size_t frame = jpeg.find("\xFF\xC0");  // marker, length, bits, height, width
  ASSERT_NE(frame, std::string::npos);
  jpeg.replace(frame + 5, 4, "\x4E\x20\x4E\x20");
  Write("rgb/1.00.png", jpeg);
  Write("depth/1.00.png", "P5 20000 20000 65535\n");
  EXPECT_THAT(LoadError(0), HasSubstr("depth/1.00.png: the image file is truncated"));
  Write("depth/1.00.png", Png(CV_16UC1, 20, 12, 5000));
  EXPECT_THAT(LoadError(0),
              HasSubstr("its color image " + (folder_.path() / "rgb/1.00.png").string() + " has 20000 x 20000"));
}

TEST_F(DatasetTest, RefusesBrokenAssociations) {
  Write("associations.txt", "1.00 rgb/1.00.png 1.06\n");
  EXPECT_THAT(OpenError(), HasSubstr("associations.txt:1: 3 columns"));
  Write("associations.txt", "1.03 rgb/1.03.png 1.03 depth/1.03.png\n1.00 rgb/1.00.png 1.00 depth/1.00.png\n");
  EXPECT_THAT(OpenError(), HasSubstr("associations.txt:2: timestamp 1.000000 does not come after"));
  Write("associations.txt", "1.03 rgb/1.03.png 1.03 depth/none.png\n");
  EXPECT_THAT(OpenError(), HasSubstr("none.png is not there"));
}

TEST_F(DatasetTest, RefusesBrokenImages) {
  const std::string png = Png(CV_16UC1, 20, 12, 5000);
  Write("depth/1.00.png", png.substr(0, png.size() - 20));
  EXPECT_THAT(LoadError(0), HasSubstr("depth/1.00.png: the image file is truncated"));
  Write("depth/1.00.png", Png(CV_8UC1));
  EXPECT_THAT(LoadError(0), HasSubstr("depth/1.00.png: a depth image of 8 bits"));
  Write("depth/1.00.png", Png(CV_16UC1, 10, 6));
  EXPECT_THAT(LoadError(0), AllOf(HasSubstr("depth/1.00.png: 10 x 6 pixels, its color image"), HasSubstr("20 x 12")));
  Write("rgb/1.00.png", Png(CV_8UC3, 10, 6));
  EXPECT_THAT(LoadError(0), HasSubstr("rgb/1.00.png: 10 x 6 pixels, the camera has 20 x 12"));
  EXPECT_EQ(LoadError(1), "");
}

}  // namespace
}  // namespace rds
