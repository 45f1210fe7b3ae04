// SPDX-License-Identifier: Apache-2.0
#include "cli/bench_report.h"

#include <gtest/gtest.h>

#include "cli/reference_timing.h"

namespace rds {
namespace {

// Half of the frames take 8 ms, the later half 10 ms.
PlaybackResult Played(std::size_t frames) {
  PlaybackResult playback;
  for (std::size_t i = 0; i < frames; ++i) {
    FrameResult frame;
    frame.timing = {.total_ms = i < frames / 2 ? 8.0 : 10.0,
                    .extraction_ms = 4.5,
                    .matching_ms = 0.9,
                    .pose_ms = 1.8,
                    .local_map_ms = 0.9,
                    .cpu_ms = 9};
    playback.frames.push_back(frame);
    playback.start_delay_ms.push_back(0);
  }
  playback.cpu_s = 1e-3 * static_cast<double>(20 * frames);
  return playback;
}

TEST(BenchReport, ComparesWithTheReferenceTiming) {
  const nlohmann::ordered_json report = BenchReport({}, Played(600), std::vector<double>(600, 6.0), 0.6 * 6);
  EXPECT_DOUBLE_EQ(report["reference_ms"]["median"], 6);
  EXPECT_DOUBLE_EQ(report["tracking_ms"]["median"], 9);
  EXPECT_DOUBLE_EQ(report["ratio"], 1.5);
  EXPECT_NEAR(report["shares"]["extraction"].get<double>(), 0.5, 1e-9);
  EXPECT_NEAR(report["shares"]["matching"].get<double>(), 0.1, 1e-9);
  EXPECT_NEAR(report["shares"]["pose"].get<double>(), 0.2, 1e-9);
  EXPECT_NEAR(report["shares"]["local_map"].get<double>(), 0.1, 1e-9);
  EXPECT_NEAR(report["shares"]["other"].get<double>(), 0.1, 1e-9);
  EXPECT_EQ(report["growth"]["frames"], 250);
  EXPECT_DOUBLE_EQ(report["growth"]["ratio"], 1.25);
  EXPECT_NEAR(report["cpu_ms_per_frame"]["all_threads"].get<double>(), 14, 1e-9);
}

TEST(BenchReport, ShortSequencesCompareHalves) {
  const nlohmann::ordered_json report = BenchReport({}, Played(20), std::vector<double>(20, 6.0), 0);
  EXPECT_EQ(report["growth"]["frames"], 10);
  EXPECT_DOUBLE_EQ(report["growth"]["ratio"], 1.25);
  EXPECT_TRUE(BenchReport({}, Played(0), {}, 0)["ratio"].is_null());
  EXPECT_TRUE(BenchReport({}, Played(1), {1.0}, 0)["growth"].is_null());
}

TEST(ReferenceTiming, TimesGrayAndColorImages) {
  ReferenceTiming reference_timing;
  for (const int channels : {1, 3}) {
    RgbdFrame frame;
    frame.image = std::make_shared<Image8>(640, 480, channels, std::uint8_t{77});
    reference_timing.BeforeFrame(frame);
  }
  ASSERT_EQ(reference_timing.times_ms().size(), 2U);
  EXPECT_GT(reference_timing.times_ms()[0], 0);
  EXPECT_GT(reference_timing.cpu_s(), 0);
}

}  // namespace
}  // namespace rds
