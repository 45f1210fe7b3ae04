// SPDX-License-Identifier: Apache-2.0
// End to end runs on a small synthetic world, for tests.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "geometry/alignment.h"
#include "synth/synthetic_world.h"
#include "system/slam.h"
#include "testing/fake_segmenter.h"

namespace rds {

inline constexpr int kFrames = 45;

inline SyntheticOptions SmallWorld(SyntheticScenario scenario) {
  SyntheticOptions options;
  options.camera = MakeSyntheticCamera(320, 240);
  options.scenario = scenario;
  options.frames = kFrames;
  return options;
}

inline std::vector<SyntheticFrame> Rendered(const SyntheticOptions& options) {
  const SyntheticWorld world(options);
  std::vector<SyntheticFrame> frames;
  for (int i = 0; i < world.frame_count(); ++i) {
    frames.push_back(world.Render(i));
  }
  return frames;
}

// Rendered once for all tests.
inline const std::vector<SyntheticFrame>& Frames(SyntheticScenario scenario) {
  if (scenario == SyntheticScenario::kStatic) {
    static const std::vector<SyntheticFrame> still = Rendered(SmallWorld(SyntheticScenario::kStatic));
    return still;
  }
  static const std::vector<SyntheticFrame> walking = Rendered(SmallWorld(SyntheticScenario::kWalking));
  return walking;
}

// Masks of the world itself, as a back end that makes no mistakes.
inline std::unique_ptr<Segmenter> TrueMasks(const std::vector<SyntheticFrame>& frames) {
  return std::make_unique<FaultySegmenter>("true masks", std::chrono::milliseconds(0),
                                           [&frames](std::span<const SegmentationInput> inputs) {
                                             std::vector<Image8> masks;
                                             for (const SegmentationInput& input : inputs) {
                                               masks.push_back(*frames[input.frame.index()].mask);
                                             }
                                             return masks;
                                           });
}

inline Options SmallOptions(bool lockstep) {
  Options options;
  options.system.lockstep = lockstep;
  options.system.wait_for_mapping = true;
  options.semantic.finish_timeout_s = 0.3;
  options.semantic.cancel_timeout_s = 0.3;
  options.tracking.min_start_points = 50;
  return options;
}

// Ends a run and looks whether its map is one.
inline SlamResult FinishValid(Slam& slam) {
  SlamResult result = slam.Finish();
  EXPECT_THAT(slam.ValidateMap(), testing::IsEmpty());
  return result;
}

inline SlamResult RunAll(const std::vector<SyntheticFrame>& frames, const Options& options,
                         std::unique_ptr<Segmenter> segmenter) {
  Slam slam(MakeSyntheticCamera(320, 240), options, std::move(segmenter));
  for (const SyntheticFrame& frame : frames) {
    static_cast<void>(slam.Process(frame.rgbd));
  }
  return FinishValid(slam);
}

inline double AteRmse(const SlamResult& result, const std::vector<SyntheticFrame>& frames) {
  std::vector<Eigen::Vector3d> estimate;
  std::vector<Eigen::Vector3d> truth;
  for (const StampedPose& pose : result.frames) {
    for (const SyntheticFrame& frame : frames) {
      if (std::abs(frame.rgbd.timestamp_s - pose.timestamp_s) < 1e-6) {
        estimate.push_back(pose.world_from_camera.translation);
        truth.push_back(frame.world_from_camera.translation);
      }
    }
  }
  const Alignment alignment = Align(estimate, truth, false);
  double sum = 0;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    sum += (alignment.Apply(estimate[i]) - truth[i]).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(estimate.size()));
}

}  // namespace rds
