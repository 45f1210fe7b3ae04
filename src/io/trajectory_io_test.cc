// SPDX-License-Identifier: Apache-2.0
#include "io/trajectory_io.h"

#include <gmock/gmock.h>

#include <limits>

#include "base/random.h"
#include "testing/matchers.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kGood = "0 0 0 0 0 0 0 1\n";

// What reading a file with these bytes complains about.
std::string ErrorOf(const std::string& text) {
  const TemporaryFolder folder;
  const auto path = folder.Write("t.txt", text);
  return InputErrorOf([&] { (void)ReadTrajectory(path); });
}

TEST(TrajectoryIo, RoundTrip) {
  Random random(1);
  Trajectory written;
  for (int i = 0; i < 100; ++i) {
    StampedPose pose;
    pose.timestamp_s = 1305031102.175304 + 0.033333 * i;
    const auto uniform = [&] { return random.Uniform(-2, 2); };
    pose.world_from_camera.translation = Eigen::Vector3d(uniform(), uniform(), uniform() * 1e-4);
    pose.world_from_camera.rotation = ExpSo3(Eigen::Vector3d(uniform(), uniform(), uniform()));
    written.push_back(pose);
  }
  const TemporaryFolder folder;
  WriteTrajectory(folder.path() / "t.txt", written);
  const Trajectory read = ReadTrajectory(folder.path() / "t.txt");
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_NEAR(read[i].timestamp_s, written[i].timestamp_s, 0.51e-6);
    EXPECT_THAT(read[i].world_from_camera, RigidNear(written[i].world_from_camera, 1e-8, 1e-6));
  }
}

TEST(TrajectoryIo, FormatIsFixed) {
  StampedPose pose{1305031102.1753041, {{1, 0, 0, 0}, {1.0 / 3, -2, 1e-9}}};
  EXPECT_EQ(FormatTrajectory({pose}),
            "# timestamp tx ty tz qx qy qz qw\n1305031102.175304 0.333333333 -2 1e-09 0 0 0 1\n");
  EXPECT_EQ(FormatTrajectory({}), "# timestamp tx ty tz qx qy qz qw\n");
}

TEST(TrajectoryIo, NeverWritesWhatIsNotFinite) {
  StampedPose pose;
  pose.world_from_camera.translation.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)FormatTrajectory({pose}), InvariantError);
}

TEST(TrajectoryIo, NormalizesQuaternions) {
  const TemporaryFolder folder;
  const Trajectory t = ReadTrajectory(folder.Write("t.txt", "1 0 0 0 0.6 0 0 0.7999\n"));
  EXPECT_NEAR(t[0].world_from_camera.rotation.norm(), 1, 1e-15);
}

TEST(TrajectoryIo, LeavesOutRepeatedTimestamps) {
  const TemporaryFolder folder;
  const Trajectory t = ReadTrajectory(folder.Write("t.txt", "1 1 0 0 0 0 0 1\n1 2 0 0 0 0 0 1\n2 3 0 0 0 0 0 1\n"));
  ASSERT_EQ(t.size(), 2U);
  EXPECT_EQ(t[0].world_from_camera.translation.x(), 1);
}

TEST(TrajectoryIo, ErrorsNameFileAndLine) {
  EXPECT_THAT(ErrorOf(std::string(kGood) + "1 0 0 0 0 0 1\n"), AllOf(HasSubstr("t.txt:2: 7 columns"), HasSubstr("qw")));
  EXPECT_THAT(ErrorOf("nan 0 0 0 0 0 0 1\n"), HasSubstr("t.txt:1: timestamp is 'nan'"));
  EXPECT_THAT(ErrorOf("1 0 0 0 0 0 0 one\n"), HasSubstr("t.txt:1: qw is 'one'"));
  EXPECT_THAT(ErrorOf("1 0 0 0 1 2 3 4\n"),
              HasSubstr("t.txt:1: the quaternion (qx qy qz qw, columns 5 to 8) has norm 5.48"));
  EXPECT_THAT(ErrorOf("1 0 0 0 0 0 0 1e200\n"), HasSubstr("has norm inf"));
  EXPECT_THAT(ErrorOf("1 0 0 0 0 0 0 0\n2 0 nan 0 0 0 0 1\n"), HasSubstr("t.txt: no poses in it: every row"));
  EXPECT_THAT(ErrorOf("1 1e160 0 0 0 0 0 1\n"), HasSubstr("t.txt:1: a position of 1e+160 m is farther away"));
  EXPECT_THAT(ErrorOf("1 2 3 4 5 6 7 8 9 10 11 12\n"), HasSubstr("12 columns, as KITTI has them"));
  EXPECT_THAT(ErrorOf("1 2 3 4 5 6 7 8 9\n3 3 3 4 5 6 7 8 9\n"), HasSubstr("9 columns, 8 are wanted"));
  EXPECT_THAT(ErrorOf("# nothing\n"), HasSubstr("t.txt: no poses in it"));
  EXPECT_THAT(InputErrorOf([] { (void)ReadTrajectory("/none/t.txt"); }), HasSubstr("/none/t.txt: cannot be read"));
}

// What ReadTrajectory makes of a text.
Trajectory Read(const std::string& text, std::span<const double> frame_times = {}) {
  const TemporaryFolder folder;
  return ReadTrajectory(folder.Write("t.txt", text), frame_times);
}

TEST(TrajectoryIo, LeavesOutRowsWithoutAPoseAndSorts) {
  const Trajectory t = Read("3 3 0 0 0 0 0 1\n1 nan nan nan nan nan nan nan\n2 0 0 0 0 0 0 0\n0 1 0 0 0 0 0 1 # ok\n");
  ASSERT_EQ(t.size(), 2U);
  EXPECT_EQ(t[0].timestamp_s, 0);
  EXPECT_EQ(t[1].world_from_camera.translation.x(), 3);
}

TEST(TrajectoryIo, FollowsAHeading) {
  const Trajectory euroc = Read(
      "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z [],v x,v y,bw z\n"
      "1403636579763555584,1,2,3,0.6,0.8,0,0,9,9,9\n1403636579768555520,1,2,3,0.6,0.8,0,0,9,9,9\n");
  ASSERT_EQ(euroc.size(), 2U);
  EXPECT_NEAR(euroc[0].timestamp_s, 1403636579.763555, 1e-6);
  EXPECT_NEAR(euroc[0].world_from_camera.rotation.w(), 0.6, 1e-12);
  EXPECT_NEAR(euroc[0].world_from_camera.rotation.x(), 0.8, 1e-12);
  EXPECT_EQ(euroc[0].world_from_camera.translation.z(), 3);
  const Trajectory csv = Read("timestamp,x,y,z,qw,qx,qy,qz\n\"1.5\",1,2,3,1,0,0,0\n");
  EXPECT_EQ(csv[0].world_from_camera.rotation.w(), 1);
  EXPECT_EQ(csv[0].timestamp_s, 1.5);
}

TEST(TrajectoryIo, ReadsRowNumbersWholeUnitsAndMatrices) {
  EXPECT_EQ(Read("0 5.5 1 2 3 0 0 0 1\n1 5.6 1 2 3 0 0 0 1\n")[1].timestamp_s, 5.6);
  EXPECT_NEAR(Read("5000 1 2 3 0 0 0 1\n5033 1 2 3 0 0 0 1\n5066 1 2 3 0 0 0 1\n")[1].timestamp_s, 5.033, 1e-12);
  EXPECT_EQ(Read("0 1 2 3 0 0 0 1\n1 1 2 3 0 0 0 1\n2 1 2 3 0 0 0 1\n")[2].timestamp_s, 2) << "maybe keyframes";
  const std::vector<double> times = {7, 8};
  const Trajectory kitti = Read("1 0 0 5 0 1 0 6 0 0 1 7\n0 -1 0 5 1 0 0 6 0 0 1 8\n", times);
  ASSERT_EQ(kitti.size(), 2U);
  EXPECT_EQ(kitti[1].timestamp_s, 8);
  EXPECT_EQ(kitti[1].world_from_camera.translation, Eigen::Vector3d(5, 6, 8));
  EXPECT_NEAR(kitti[1].world_from_camera.rotation.z(), std::sqrt(0.5), 1e-12);
  EXPECT_THAT(InputErrorOf([&] { (void)Read("1 0 0 5 0 2 0 6 0 0 1 7\n1 0 0 5 0 1 0 6 0 0 1 7\n", times); }),
              HasSubstr("is no rotation"));
}

}  // namespace
}  // namespace rds
