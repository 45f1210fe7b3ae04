// SPDX-License-Identifier: Apache-2.0
#include "io/sequence_fetch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::HasSubstr;

TEST(SequenceFetch, NamesMayBeShort) {
  const Benchmark& tum = Benchmarks()[0];
  const Benchmark& bonn = Benchmarks()[1];
  for (const char* const name :
       {"rgbd_dataset_freiburg3_walking_xyz", "walking_xyz", "fr3/walking_xyz", "freiburg3_walking_xyz"}) {
    const PublishedSequence sequence = FindSequence(tum, name);
    EXPECT_EQ(sequence.archive, "freiburg3/rgbd_dataset_freiburg3_walking_xyz.tgz");
    EXPECT_FALSE(sequence.marker_truth);
  }
  EXPECT_EQ(FindSequence(bonn, "crowd2").archive, "rgbd_bonn_crowd2.zip");
  EXPECT_TRUE(FindSequence(bonn, "rgbd_bonn_crowd2").marker_truth);
  EXPECT_THAT(InputErrorOf([&] { (void)FindSequence(tum, "xyz"); }), HasSubstr("ambiguous"));
  EXPECT_THAT(InputErrorOf([&] { (void)FindSequence(tum, "walkin_xyz"); }), HasSubstr("is unknown"));
  for (const Benchmark& benchmark : Benchmarks()) {
    for (const std::string& name : benchmark.usual) {
      EXPECT_EQ(FindSequence(benchmark, name).name, name);
    }
  }
}

// The published transforms (https://www.ipb.uni-bonn.de/data/rgbd-dynamic-dataset/) in the product that its page gives.
TEST(SequenceFetch, BonnsMarkersGiveTheCamera) {
  Eigen::Matrix4d ros;
  ros << -1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1;
  Eigen::Matrix4d marker;
  marker << 1.0157, 0.1828, -0.2389, 0.0113, 0.0009, -0.8431, -0.6413, -0.0098, -0.3009, 0.6147, -0.8085, 0.0111, 0, 0,
      0, 1;
  const Rigid3 pose{Eigen::Quaterniond(0.5, -0.1, 0.7, 0.2).normalized(), {1, 2, 3}};
  Eigen::Matrix4d given = Eigen::Matrix4d::Identity();
  given.topLeftCorner<3, 3>() = pose.RotationMatrix();
  given.topRightCorner<3, 1>() = pose.translation;
  const Eigen::Matrix4d expected = ros.inverse() * given * ros * marker;
  const Trajectory camera = CameraFromBonnMarkers({{7, pose}});
  ASSERT_EQ(camera.size(), 1U);
  EXPECT_EQ(camera[0].timestamp_s, 7);
  EXPECT_TRUE(camera[0].world_from_camera.translation.isApprox(expected.topRightCorner<3, 1>(), 1e-9));
  const Eigen::Matrix3d rotation = camera[0].world_from_camera.RotationMatrix();
  EXPECT_TRUE((rotation * rotation.transpose()).isIdentity(1e-9));
  EXPECT_LT((rotation - expected.topLeftCorner<3, 3>()).cwiseAbs().maxCoeff(), 0.08);  // but for the scale
}

}  // namespace
}  // namespace rds
