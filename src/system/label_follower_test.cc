#include "system/label_follower.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace rds {
namespace {

std::shared_ptr<const FrameData> Frame(int keypoints) {
  std::vector<Keypoint> all(static_cast<std::size_t>(keypoints));
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].x = all[i].raw_x = static_cast<float>(20 * i % 600);
    all[i].y = all[i].raw_y = static_cast<float>(20 * (i / 30));
    all[i].depth_m = 1;
  }
  PinholeCamera camera;
  camera.width = 640;
  camera.height = 480;
  return std::make_shared<const FrameData>(camera, all, std::vector<Descriptor>(all.size()));
}

TEST(LabelFollowerTest, AnswersForTheFrameThatWasBegunOnAThreadAndInLockstepAlike) {
  for (const bool lockstep : {true, false}) {
    MovingProbabilities table;
    LabelFollower follower({}, {}, {}, table, lockstep);
    for (const int keypoints : {10, 0, 300}) {
      follower.Begin(Frame(keypoints), nullptr, Rigid3{});
      const KeypointLabels labels = follower.Get();
      EXPECT_EQ(labels.tracks.size(), static_cast<std::size_t>(keypoints));
      EXPECT_EQ(labels.probabilities.size(), static_cast<std::size_t>(keypoints));
    }
  }
}

TEST(LabelFollowerTest, EndsWithAnAnswerThatNobodyFetched) {
  MovingProbabilities table;
  LabelFollower follower({}, {}, {}, table, false);
  follower.Begin(Frame(100), nullptr, Rigid3{});
}

TEST(LabelFollowerTest, AnErrorOfItsThreadReachesTheCallerInsteadOfAHang) {
  for (const bool lockstep : {true, false}) {
    MovingProbabilities table;
    LabelFollower follower({}, {}, {}, table, lockstep);
    PinholeCamera camera;
    camera.width = 640;
    camera.height = 480;
    DepthGrid without_samples{80, 60, {}};
    follower.Begin(std::make_shared<const FrameData>(camera, std::vector<Keypoint>(1), std::vector<Descriptor>(1),
                                                     std::move(without_samples)),
                   nullptr, Rigid3{});
    EXPECT_THROW((void)follower.Get(), InvariantError);
  }
}

}  // namespace
}  // namespace rds
