// SPDX-License-Identifier: Apache-2.0
#include "synth/synthetic_sequence.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "base/error.h"
#include "io/camera_file.h"
#include "io/image_io.h"
#include "io/text_table.h"
#include "io/trajectory_io.h"
#include "testing/matchers.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

SyntheticWorld TinyWorld() {
  SyntheticOptions options;
  options.camera = MakeSyntheticCamera(64, 48);
  options.frames = 4;
  return SyntheticWorld(options);
}

TEST(SyntheticSequence, WhatIsReadBackIsWhatWasRendered) {
  const TemporaryFolder folder;
  const std::filesystem::path out = folder.path() / "deep" / "sequence";
  const SyntheticWorld world = TinyWorld();
  int calls = 0;
  WriteSyntheticSequence(world, out, [&](int done) { EXPECT_EQ(done, ++calls); });
  EXPECT_EQ(calls, 4);

  const PinholeCamera camera = ReadCamera(out / "camera.yaml");
  EXPECT_EQ(camera.fx, world.camera().fx);
  EXPECT_EQ(camera.cy, world.camera().cy);
  EXPECT_EQ(camera.baseline_m, world.camera().baseline_m);

  const Trajectory truth = ReadTrajectory(out / "groundtruth.txt");
  const TextTable associations = ReadTextTable(out / "associations.txt");
  const TextTable masks = ReadTextTable(out / "mask.txt");
  ASSERT_EQ(truth.size(), 4U);
  ASSERT_EQ(associations.rows.size(), 4U);
  ASSERT_EQ(masks.rows.size(), 4U);
  EXPECT_EQ(ReadTextTable(out / "rgb.txt").rows.size(), 4U);
  EXPECT_EQ(ReadTextTable(out / "depth.txt").rows.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    const SyntheticFrame frame = world.Render(static_cast<int>(i));
    const std::vector<std::string>& fields = associations.rows[i].fields;
    ASSERT_EQ(fields.size(), 4U);
    EXPECT_NEAR(std::stod(fields[0]), frame.rgbd.timestamp_s, 1e-6);
    EXPECT_EQ(fields[0], fields[2]);
    EXPECT_EQ(ReadColor(out / fields[1]).data, frame.rgbd.image->data);
    EXPECT_EQ(ReadDepth(out / fields[3]).data, frame.rgbd.depth->data);
    EXPECT_EQ(ReadMask(out / masks.rows[i].fields[1]).data, frame.mask->data);
    EXPECT_THAT(truth[i].world_from_camera, RigidNear(frame.world_from_camera, 1e-7, 1e-5));
    EXPECT_NEAR(truth[i].timestamp_s, frame.rgbd.timestamp_s, 1e-6);
  }
}

TEST(SyntheticSequence, SameBytesTwice) {
  const TemporaryFolder folder;
  WriteSyntheticSequence(TinyWorld(), folder.path() / "a");
  WriteSyntheticSequence(TinyWorld(), folder.path() / "b");
  for (const char* file : {"rgb/0.033333.png", "depth/0.066667.png", "mask/0.100000.png", "groundtruth.txt"}) {
    const std::string bytes = folder.Read(std::filesystem::path("a") / file);
    EXPECT_FALSE(bytes.empty()) << file;
    EXPECT_EQ(bytes, folder.Read(std::filesystem::path("b") / file)) << file;
  }
}

TEST(SyntheticSequence, SaysWhatCannotBeWritten) {
  const TemporaryFolder folder;
  folder.Write("file", "not a folder");
  const SyntheticWorld world = TinyWorld();
  const std::string inside = InputErrorOf([&] { WriteSyntheticSequence(world, folder.path() / "file"); });
  EXPECT_NE(inside.find("file"), std::string::npos) << inside;
  folder.Write("taken/rgb", "not a folder");
  const std::string taken = InputErrorOf([&] { WriteSyntheticSequence(world, folder.path() / "taken"); });
  EXPECT_NE(taken.find("rgb"), std::string::npos) << taken;
  // A folder where a picture should go.
  std::filesystem::create_directories(folder.path() / "odd/depth/0.000000.png");
  const std::string odd = InputErrorOf([&] { WriteSyntheticSequence(world, folder.path() / "odd"); });
  EXPECT_NE(odd.find("0.000000.png"), std::string::npos) << odd;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "odd/rgb.txt"));
}

}  // namespace
}  // namespace rds
