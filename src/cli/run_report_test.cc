// SPDX-License-Identifier: Apache-2.0
#include "cli/run_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/version.h"

namespace rds {
namespace {

using ::testing::HasSubstr;

// Ten frames: one before the start, eight tracked, one lost; the first label after four.
PlaybackResult TenFrames() {
  PlaybackResult playback;
  for (std::uint32_t i = 0; i < 10; ++i) {
    FrameResult frame;
    frame.frame = FrameId{i};
    frame.timestamp_s = 1000 + 0.1 * i;
    frame.state = i == 0 ? TrackingState::kNotInitialized : i == 9 ? TrackingState::kLost : TrackingState::kTracked;
    frame.timing.total_ms = i + 1;
    frame.timing.cpu_ms = 2;
    frame.is_keyframe = i == 1;
    if (i >= 2) {
      frame.confidence = i == 3 ? 0.4 : 0.9;
    }
    if (i >= 4) {
      frame.semantic_delay_frames = static_cast<int>(i);
    }
    playback.frames.push_back(frame);
    playback.start_delay_ms.push_back(i == 5 ? 12 : 0);
  }
  playback.slam.tracked_frames = 8;
  playback.slam.lost_frames = 1;
  playback.slam.found_frames = 2;
  playback.slam.keyframes.resize(3);
  playback.slam.map.points.resize(7);
  playback.slam.local_ba_ms = {5, 7};
  playback.slam.labels = {{FrameId{1}, FrameId{4}, 30, 1, 2, 0}, {FrameId{3}, FrameId{6}, 32, 1, 2, 9}};
  playback.first_pose_after_s = 0.1;
  playback.wall_s = 1;
  playback.cpu_s = 0.5;
  playback.reading_cpu_s = 0.1;
  return playback;
}

TEST(RunReport, SaysWhatHappened) {
  const nlohmann::ordered_json report = RunReport({.sequence = "room",
                                                   .segmenter = "stored",
                                                   .rate = 1,
                                                   .lockstep = false,
                                                   .started_after_s = 0.2,
                                                   .run_id = "1f",
                                                   .camera = {{"name", "tum_fr1"}},
                                                   .input = {{"frames", 10}}},
                                                  TenFrames());
  EXPECT_EQ(report["sequence"], "room");
  EXPECT_EQ(report["run_id"], "1f");
  EXPECT_EQ(report["camera"]["name"], "tum_fr1");
  EXPECT_EQ(report["input"]["frames"], 10);
  EXPECT_EQ(report["versions"]["rds"], kVersion);
  EXPECT_TRUE(report["error"].is_null());
  EXPECT_EQ(report["left_out"], 0);
  EXPECT_DOUBLE_EQ(report["lost_for_good_since_s"], 1000.9);
  EXPECT_EQ(report["frames"], 10);
  EXPECT_EQ(report["tracked"], 8);
  EXPECT_EQ(report["lost"], 1);
  EXPECT_EQ(report["found"], 2);
  EXPECT_EQ(report["not_started"], 1);
  EXPECT_EQ(report["late"], 1);
  EXPECT_EQ(report["keyframes"], 3);
  EXPECT_EQ(report["map_points"], 7);
  EXPECT_NEAR(report["start_up_s"].get<double>(), 0.3, 1e-9);
  EXPECT_DOUBLE_EQ(report["tracking_ms"]["median"], 5.5);
  EXPECT_DOUBLE_EQ(report["local_ba_ms"]["max"], 7);
  EXPECT_NEAR(report["cpu_ms_per_frame"]["all_threads"].get<double>(), 40, 1e-9);
  EXPECT_NEAR(report["cpu_ms_per_frame"]["tracking_thread"].get<double>(), 2, 1e-9);
  EXPECT_GT(report["peak_memory_mb"], 1);
  EXPECT_EQ(report["semantics"]["keyframes_labeled"], 2);
  EXPECT_DOUBLE_EQ(report["semantics"]["delay_frames"]["median"], 6.5);
  EXPECT_DOUBLE_EQ(report["semantics"]["segmentation_ms"]["mean"], 31);
  EXPECT_DOUBLE_EQ(report["semantics"]["optimization_ms"]["mean"], 9) << "only where one was due";
}

TEST(RunReport, SaysWhatEndedTheRunAndWhatWasLeftOut) {
  PlaybackResult playback = TenFrames();
  playback.error = std::make_exception_ptr(std::runtime_error("the disk is gone"));
  playback.left_out = 2;
  playback.first_problem = "a.png: damaged";
  const nlohmann::ordered_json report = RunReport({}, playback);
  EXPECT_EQ(report["error"], "the disk is gone");
  EXPECT_EQ(report["left_out"], 2);
  EXPECT_EQ(report["first_left_out_because"], "a.png: damaged");
}

TEST(RunReport, LostForGoodIsWhereTheLastRunOfLostFramesBegins) {
  std::vector<FrameResult> frames(5);
  for (FrameResult& frame : frames) {
    frame.state = TrackingState::kTracked;
  }
  EXPECT_EQ(LostForGoodSince(frames), std::nullopt);
  frames[1].state = TrackingState::kLost;
  EXPECT_EQ(LostForGoodSince(frames), std::nullopt);
  frames[3].state = frames[4].state = TrackingState::kLost;
  EXPECT_EQ(LostForGoodSince(frames), 3U);
  EXPECT_EQ(LostForGoodSince({}), std::nullopt);
}

TEST(RunReport, WhatWasNotMeasuredIsNull) {
  const nlohmann::ordered_json report = RunReport({}, {});
  EXPECT_TRUE(report["confidence"].is_null());
  EXPECT_EQ(report["unexplained_frames"], 0);
  EXPECT_EQ(report["frames"], 0);
  EXPECT_TRUE(report["start_up_s"].is_null());
  EXPECT_TRUE(report["tracking_ms"].is_null());
  EXPECT_TRUE(report["cpu_ms_per_frame"].is_null());
  EXPECT_TRUE(report["semantics"]["delay_frames"].is_null());
}

TEST(RunReport, FramesWhosePoseExplainsLittleAreCounted) {
  const nlohmann::ordered_json report = RunReport({}, TenFrames());
  EXPECT_EQ(report["confidence"]["median"], 0.9);
  EXPECT_EQ(report["unexplained_frames"], 1);
}

TEST(RunReport, FramesCsvHasALineAFrame) {
  const std::string csv = FramesCsv(TenFrames(), "1f");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 11);
  EXPECT_THAT(csv, HasSubstr("\n1,1000.100000,tracked,2.000,0.000,0.000,0.000,0.000,2.000,0,0,0,1,,,0.000,1f\n"));
  EXPECT_THAT(csv, HasSubstr("\n9,1000.900000,lost,10.000,"));
  EXPECT_THAT(csv, HasSubstr(",0,0.900,5,12.000,1f\n"));
}

TEST(RunReport, SemanticsCsvHasALineALabel) {
  EXPECT_EQ(SemanticsCsv(TenFrames().slam.labels, "1f"),
            "labeled_frame,current_frame,delay_frames,segmentation_ms,mask_ms,update_ms,optimization_ms,run\n"
            "1,4,3,30.000,1.000,2.000,0.000,1f\n"
            "3,6,3,32.000,1.000,2.000,9.000,1f\n");
}

}  // namespace
}  // namespace rds
