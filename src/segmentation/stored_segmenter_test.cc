// SPDX-License-Identifier: Apache-2.0
#include "segmentation/stored_segmenter.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <thread>

#include "base/error.h"
#include "base/time.h"
#include "testing/fake_segmenter.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

class StoredSegmenterTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    for (int i = 0; i < 3; ++i) {
      cv::Mat image(4, 6, CV_8U, cv::Scalar(0));
      image.at<std::uint8_t>(i, 1) = static_cast<std::uint8_t>(i + 1);
      cv::imwrite(Path(i), image);
      masks_.push_back({10.0 + 0.1 * i, Path(i)});
    }
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string Path(int i) const { return (folder_ / (std::to_string(i) + ".png")).string(); }

  static Image8 Read(const std::string& path) {
    const cv::Mat image = cv::imread(path, cv::IMREAD_GRAYSCALE);
    if (image.empty()) {
      throw InputError(path + ": no image");
    }
    Image8 mask = Image8::Copy(image.data, image.cols, image.rows, 1, image.step);
    std::ranges::replace_if(
        mask.data, [](std::uint8_t pixel) { return pixel != 0; }, std::uint8_t{255});
    return mask;
  }

  static std::vector<SegmentationInput> At(std::initializer_list<double> times) {
    std::vector<SegmentationInput> inputs;
    for (const double time : times) {
      inputs.push_back({FrameId{0}, time, std::make_shared<Image8>(6, 4)});
    }
    return inputs;
  }

  const fs::path folder_ = fs::temp_directory_path() /
                           ("rds_stored_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
  std::vector<StoredMask> masks_;
};

TEST_F(StoredSegmenterTest, GivesTheMaskNearestInTime) {
  StoredSegmenter segmenter(masks_, Read, 0);
  const auto answer = segmenter.Segment(At({10.0, 10.119, 10.15, 9.98, 10.221}));
  ASSERT_EQ(answer.size(), 5U);
  EXPECT_EQ(answer[0].At(1, 0), 255);
  EXPECT_EQ(answer[0].At(0, 0), 0);
  EXPECT_EQ(answer[1].At(1, 1), 255);
  EXPECT_TRUE(answer[2].empty());
  EXPECT_EQ(answer[3].At(1, 0), 255);
  EXPECT_TRUE(answer[4].empty());
  EXPECT_EQ(segmenter.Name(), "stored, 0 ms");
}

TEST_F(StoredSegmenterTest, ABatchTakesTheDelayOfOne) {
  StoredSegmenter segmenter(masks_, Read, 200);
  const Stopwatch watch;
  EXPECT_EQ(segmenter.Segment(At({10.0, 10.1})).size(), 2U);
  EXPECT_GE(watch.Milliseconds(), 200);
  EXPECT_LT(watch.Milliseconds(), 390);
}

TEST_F(StoredSegmenterTest, CancelEndsTheWaitAndEveryLaterOne) {
  StoredSegmenter segmenter(masks_, Read, 60'000);
  const Stopwatch watch;
  std::thread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    segmenter.Cancel();
  });
  EXPECT_TRUE(segmenter.Segment(At({10.0})).at(0).empty());
  canceller.join();
  EXPECT_TRUE(segmenter.Segment(At({10.0})).at(0).empty());
  EXPECT_LT(watch.Seconds(), 30);
}

TEST_F(StoredSegmenterTest, RefusesBadInput) {
  EXPECT_THROW(StoredSegmenter({}, Read, 0), InputError);
  EXPECT_THROW(StoredSegmenter(masks_, Read, -1), InputError);
  EXPECT_THROW(StoredSegmenter({{1, Path(0)}, {1, Path(1)}}, Read, 0), InputError);
  EXPECT_THROW(StoredSegmenter({{1, Path(7)}}, Read, 0), InputError);
}

TEST_F(StoredSegmenterTest, NamesAMaskThatCannotBeRead) {
  std::ofstream(Path(1)) << "not a PNG";
  StoredSegmenter segmenter(masks_, Read, 0);
  try {
    std::ignore = segmenter.Segment(At({10.1}));
    FAIL() << "no exception";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(Path(1)), std::string::npos);
  }
  EXPECT_FALSE(segmenter.Segment(At({10.2})).at(0).empty());
}

TEST_F(StoredSegmenterTest, AFrameWithoutAMaskIsAFailure) {
  StoredSegmenter segmenter(masks_, Read, 0);
  try {
    std::ignore = segmenter.Segment(At({10.15}));
    FAIL() << "no exception";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("no mask within 0.02 s of 10.150000 s"));
  }
}

TEST(FaultySegmenterTest, FailsAsItsNameSays) {
  const std::vector<SegmentationInput> inputs = {{FrameId{0}, 0, std::make_shared<Image8>(8, 6, 3)}};
  EXPECT_THROW(std::ignore = faulty::Throws()->Segment(inputs), std::runtime_error);
  EXPECT_NE(faulty::WrongSize()->Segment(inputs).at(0).width, 8);
  EXPECT_EQ(faulty::AllOnes()->Segment(inputs).at(0).At(7, 5), 255);
  EXPECT_TRUE(faulty::AllEmpty()->Segment(inputs).at(0).empty());
  EXPECT_TRUE(faulty::TooFew()->Segment(inputs).empty());
  const auto never = faulty::NeverAnswers();
  std::thread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    never->Cancel();
  });
  EXPECT_TRUE(never->Segment(inputs).at(0).empty());
  canceller.join();
  EXPECT_EQ(never->requests(), 1);
}

}  // namespace
}  // namespace rds
