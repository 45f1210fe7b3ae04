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

TEST(TrajectoryIo, NormalisesQuaternions) {
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
  EXPECT_THAT(ErrorOf(std::string(kGood) + "#\n1 0 nan 0 0 0 0 1\n"), HasSubstr("t.txt:3: ty is 'nan'"));
  EXPECT_THAT(ErrorOf("1 inf 0 0 0 0 0 1\n"), HasSubstr("t.txt:1: tx is 'inf'"));
  EXPECT_THAT(ErrorOf("1 0 0 0 0 0 0 one\n"), HasSubstr("t.txt:1: qw is 'one'"));
  EXPECT_THAT(ErrorOf("1 0 0 0 0 0 0 0\n"),
              HasSubstr("t.txt:1: the quaternion (qx qy qz qw, columns 5 to 8) has norm 0"));
  EXPECT_THAT(ErrorOf("1 0 0 0 1 2 3 4\n"), HasSubstr("has norm 5.48"));
  EXPECT_THAT(ErrorOf("2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n"), HasSubstr("t.txt:2: timestamp 1 is before"));
  EXPECT_THAT(ErrorOf("# nothing\n"), HasSubstr("t.txt: no poses in it"));
  EXPECT_THAT(InputErrorOf([] { (void)ReadTrajectory("/none/t.txt"); }), HasSubstr("/none/t.txt: cannot be read"));
}

}  // namespace
}  // namespace rds
