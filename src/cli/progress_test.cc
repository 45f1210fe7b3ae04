// SPDX-License-Identifier: Apache-2.0
#include "cli/progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

namespace rds {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

FrameResult Tracked() {
  FrameResult result;
  result.state = TrackingState::kTracked;
  result.keyframes_in_map = 63;
  result.points_in_map = 5210;
  return result;
}

// What is printed for 300 of 600 frames at 30 Hz.
std::string Printed(bool terminal, FrameResult result) {
  std::ostringstream out;
  Progress progress(out, terminal, 600);
  for (int i = 0; i < 300; ++i) {
    progress.Update(result, (i + 1) / 30.0);
  }
  progress.Finish();
  return out.str();
}

TEST(Progress, PlainLinesAreFew) {
  const std::string text = Printed(false, Tracked());
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);  // one in ten seconds
  EXPECT_THAT(text, HasSubstr("300/600  30.0 fps  tracked  63 keyframes  5210 points  10 s left\n"));
  EXPECT_THAT(text, Not(HasSubstr("\x1b")));
}

TEST(Progress, BarOnATerminal) {
  const std::string text = Printed(true, Tracked());
  EXPECT_THAT(text, HasSubstr("\r\x1b[K[############............] 300/600"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
  EXPECT_EQ(text.back(), '\n');
}

TEST(Progress, SaysWhenLost) {
  FrameResult lost = Tracked();
  lost.state = TrackingState::kLost;
  EXPECT_THAT(Printed(false, lost), HasSubstr("lost"));
}

TEST(Progress, NothingForNoFrames) {
  std::ostringstream out;
  Progress progress(out, true, 0);
  progress.Finish();
  EXPECT_EQ(out.str(), "");
}

TEST(FrameRateMeter, ForgetsWhatIsOlderThanASecond) {
  FrameRateMeter meter;
  EXPECT_EQ(meter.PerSecond(), 0);
  for (int i = 0; i < 30; ++i) {
    meter.Tick(i * 0.5);
  }
  for (int i = 0; i < 60; ++i) {
    meter.Tick(15 + i * 0.025);
  }
  EXPECT_NEAR(meter.PerSecond(), 40, 1e-6);
}

}  // namespace
}  // namespace rds
