// SPDX-License-Identifier: Apache-2.0
#include "io/video.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "base/error.h"
#include "testing/file_size_limit.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

constexpr int kWidth = 320;
constexpr int kHeight = 240;

RunViewContent ContentOf(std::uint32_t frame) {
  RunViewContent content;
  content.image = std::make_shared<Image8>(kWidth, kHeight, 3, std::uint8_t{90});
  content.result.frame = FrameId{frame};
  content.result.state = TrackingState::kTracked;
  content.result.world_from_camera = Rigid3{Eigen::Quaterniond::Identity(), {0.01 * frame, 0, 0}};
  content.result.features = {{100, 60, FeatureState::kStatic},
                             {150, 60, FeatureState::kUnknown},
                             {200, 60, FeatureState::kRejected},
                             {250, 60, FeatureState::kUnmatched}};
  return content;
}

// B, G, R at a pixel.
std::array<int, 3> Pixel(const Image8& image, int x, int y) {
  const std::uint8_t* pixel = image.Row(y) + 3 * x;
  return {pixel[0], pixel[1], pixel[2]};
}

TEST(RunView, FeaturesHaveThePapersColors) {
  RunView view;
  const Image8 picture = view.Draw(ContentOf(0));
  ASSERT_EQ(picture.width, RunView::Width(kWidth, kHeight));
  ASSERT_EQ(picture.height, RunView::Height(kHeight));
  const auto still = Pixel(picture, 100, 60);
  EXPECT_GT(still[0], still[2] + 100) << "static is blue";
  const auto unknown = Pixel(picture, 150, 60);
  EXPECT_GT(unknown[1], unknown[2] + 100) << "unknown is green";
  const auto rejected = Pixel(picture, 200, 60);
  EXPECT_GT(rejected[2], rejected[0] + 100) << "rejected is red";
  EXPECT_EQ(Pixel(picture, 250, 60), (std::array<int, 3>{90, 90, 90})) << "unmatched is not drawn";
}

TEST(RunView, ShowsTheMask) {
  RunViewContent content = ContentOf(9);
  content.mask.frame = FrameId{4};
  content.mask.mask = std::make_shared<Image8>(kWidth, kHeight, 1, std::uint8_t{255});
  RunView view;
  const auto inset = Pixel(view.Draw(content), 6 + kWidth / 8, kHeight - 6 - kHeight / 8);
  EXPECT_GT(inset[2], inset[0] + 100);
}

TEST(RunView, TakesGrayImagesLostFramesAndFarPoints) {
  RunViewContent content = ContentOf(0);
  content.image = std::make_shared<Image8>(kWidth, kHeight, 1, std::uint8_t{90});
  auto map = std::make_shared<MapView>();
  map->points = {{0, 0, 1}, {1e30F, 0, -1e30F}, {0.5F, 0, 2}};
  map->moving_probability = {0.1F, 0.5F, 0.9F};
  content.map = map;
  RunView view;
  EXPECT_NO_THROW((void)view.Draw(content));
  content.result.state = TrackingState::kLost;
  content.result.world_from_camera.reset();
  EXPECT_NO_THROW((void)view.Draw(content));
}

TEST(RunView, SaysWhatHappenedToTheMap) {
  RunViewContent content = ContentOf(0);
  RunView view;
  const auto bright = [&] {  // pixels of the line below the status
    const Image8 picture = view.Draw(content);
    int count = 0;
    for (int y = 23; y < 43; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        count += Pixel(picture, x, y)[0] > 200 ? 1 : 0;
      }
    }
    return count;
  };
  EXPECT_EQ(bright(), 0);
  content.note = "found again in world 0";
  EXPECT_GT(bright(), 100);
}

TEST(RunView, ThePathBeginsAnewInAnotherWorld) {
  RunView view;
  const auto path_pixels = [&](std::uint32_t frame, std::uint32_t world) {
    RunViewContent content = ContentOf(frame);
    content.result.world = WorldId{world};
    const Image8 picture = view.Draw(content);
    int count = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = kWidth; x < picture.width; ++x) {
        count += Pixel(picture, x, y) == std::array<int, 3>{200, 90, 20} ? 1 : 0;
      }
    }
    return count;
  };
  path_pixels(0, 0);
  EXPECT_GT(path_pixels(60, 0), 50);
  EXPECT_EQ(path_pixels(61, 1), 0);
}

TEST(RunView, SameInputSamePicture) {
  RunView a;
  RunView b;
  EXPECT_EQ(a.Draw(ContentOf(3)).data, b.Draw(ContentOf(3)).data);
}

class VideoRecorderTest : public ::testing::Test {
 protected:
  static std::string ErrorOf(const VideoOptions& options) {
    return InputErrorOf([&options] {
      VideoRecorder recorder(options, kWidth, kHeight);
      recorder.Add(ContentOf(0));
      recorder.Finish();
    });
  }

  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

TEST_F(VideoRecorderTest, WritesVideoAndStill) {
  VideoOptions options;
  options.video = folder_ / "run.mp4";
  options.still = folder_ / "run.png";
  options.still_frame = FrameId{3};
  options.wait = true;
  VideoRecorder recorder(options, kWidth, kHeight);
  for (std::uint32_t i = 0; i < 12; ++i) {
    recorder.Add(ContentOf(i));
  }
  EXPECT_FALSE(fs::exists(*options.video)) << "nothing under its name before the end";
  recorder.Finish();
  EXPECT_EQ(recorder.left_out(), 0);
  cv::VideoCapture video(options.video->string());
  EXPECT_EQ(video.get(cv::CAP_PROP_FRAME_COUNT), 12);
  EXPECT_EQ(video.get(cv::CAP_PROP_FRAME_WIDTH), RunView::Width(kWidth, kHeight));
  EXPECT_EQ(cv::imread(options.still->string()).rows, kHeight);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 2) << "nothing else is left";
}

TEST_F(VideoRecorderTest, FullQueueKeepsTheVideosTime) {
  VideoOptions options;
  options.video = folder_ / "run.mp4";
  VideoRecorder recorder(options, kWidth, kHeight);
  for (std::uint32_t i = 0; i < 200; ++i) {
    recorder.Add(ContentOf(i));
  }
  recorder.Finish();
  // Frames left out at the very end have no later picture to make up for them.
  EXPECT_GT(recorder.left_out(), 0);
  EXPECT_GT(cv::VideoCapture(options.video->string()).get(cv::CAP_PROP_FRAME_COUNT), 25);
}

TEST_F(VideoRecorderTest, LeavesNothingBehindWithoutFinish) {
  VideoOptions options;
  options.video = folder_ / "run.mp4";
  {
    VideoRecorder recorder(options, kWidth, kHeight);
    recorder.Add(ContentOf(0));
  }
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(VideoRecorderTest, BadNamesAreNamed) {
  EXPECT_THAT(ErrorOf({.video = "/nowhere/run.mp4"}), HasSubstr("/nowhere/run.mp4"));
  EXPECT_THAT(ErrorOf({.video = folder_ / "run.xyz"}), HasSubstr(".mp4"));
  EXPECT_THAT(ErrorOf({.video = folder_.parent_path() / "."}), HasSubstr(".mp4"));
  EXPECT_THAT(ErrorOf({.still = "/nowhere/run.png"}), HasSubstr("/nowhere/run.png"));
  EXPECT_THAT(ErrorOf({.still = folder_ / "run.mp4"}), HasSubstr(".png"));
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(VideoRecorderTest, StillThatNeverCameIsAnErrorButTheVideoStays) {
  EXPECT_THAT(ErrorOf({.video = folder_ / "run.mp4", .still = folder_ / "run.png", .still_frame = FrameId{7}}),
              HasSubstr("frame 7"));
  EXPECT_EQ(cv::VideoCapture((folder_ / "run.mp4").string()).get(cv::CAP_PROP_FRAME_COUNT), 1);
  EXPECT_EQ(temporary_.Count(), 1);
}

TEST_F(VideoRecorderTest, StillOnAFullDiskIsAnErrorAndKeepsTheOldOne) {
  temporary_.Write("run.png", "before");
  {
    const FileSizeLimit limit(1000);
    EXPECT_THAT(ErrorOf({.still = folder_ / "run.png"}), HasSubstr("run.png: cannot be written"));
  }
  EXPECT_EQ(temporary_.Read("run.png"), "before");
  EXPECT_EQ(temporary_.Count(), 1);
}

TEST_F(VideoRecorderTest, VideoOnAFullDiskIsAnErrorButTheStillIsThere) {
  temporary_.Write("run.mp4", "before");
  {
    const FileSizeLimit limit(20'000);
    VideoRecorder recorder({.video = folder_ / "run.mp4", .still = folder_ / "run.png", .wait = true}, kWidth, kHeight);
    for (std::uint32_t i = 0; i < 60; ++i) {
      recorder.Add(ContentOf(i));
    }
    EXPECT_THAT(InputErrorOf([&recorder] { recorder.Finish(); }), HasSubstr("run.mp4: the video is incomplete"));
  }
  EXPECT_EQ(temporary_.Read("run.mp4"), "before");
  EXPECT_EQ(cv::imread((folder_ / "run.png").string()).rows, kHeight);
  EXPECT_EQ(temporary_.Count(), 2);
}

TEST_F(VideoRecorderTest, AVideoCanBeGivenUpForRoom) {
  VideoRecorder recorder({.video = folder_ / "run.mp4", .still = folder_ / "run.png"}, kWidth, kHeight);
  recorder.Add(ContentOf(0));
  EXPECT_TRUE(recorder.DropVideo());
  EXPECT_TRUE(fs::is_empty(folder_));
  EXPECT_FALSE(recorder.DropVideo());
  recorder.Finish();
  EXPECT_EQ(cv::imread((folder_ / "run.png").string()).rows, kHeight);
  EXPECT_EQ(temporary_.Count(), 1);
}

TEST_F(VideoRecorderTest, WithoutAFrameThereIsNoVideo) {
  temporary_.Write("run.mp4", "before");
  EXPECT_THAT(InputErrorOf([this] { VideoRecorder({.video = folder_ / "run.mp4"}, kWidth, kHeight).Finish(); }),
              HasSubstr("run.mp4: no video"));
  EXPECT_EQ(temporary_.Read("run.mp4"), "before");
  EXPECT_EQ(temporary_.Count(), 1);
}

}  // namespace
}  // namespace rds
