// SPDX-License-Identifier: Apache-2.0
#include "io/camera_config.h"

#include <gmock/gmock.h>

#include "io/camera_file.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kGood =
    "width: 640\nheight: 480\nfx: 500.5\nfy: 501\ncx: 320\ncy: 240\ndepth_scale: 1000\n"
    "distortion: [0.1, -0.2, 0.003, -0.004, 0.05]\nbaseline_m: 0.05\n";

bool Same(const PinholeCamera& a, const PinholeCamera& b) {
  return a.width == b.width && a.height == b.height && a.fx == b.fx && a.fy == b.fy && a.cx == b.cx && a.cy == b.cy &&
         a.distortion == b.distortion && a.depth_scale == b.depth_scale && a.baseline_m == b.baseline_m &&
         a.depth_noise.constant_m == b.depth_noise.constant_m &&
         a.depth_noise.quadratic_per_m == b.depth_noise.quadratic_per_m && a.rolling_shutter_s == b.rolling_shutter_s;
}

std::string ErrorOf(const std::string& text) {
  const TemporaryFolder folder;
  const auto path = folder.Write("c.yaml", text);
  return InputErrorOf([&] { (void)ReadCamera(path); });
}

// The good file with one piece replaced.
std::string ErrorWith(const std::string& piece, const std::string& replacement) {
  std::string text = kGood;
  const std::size_t at = text.find(piece);
  EXPECT_NE(at, std::string::npos);
  return ErrorOf(text.replace(at, piece.size(), replacement));
}

// src/io/camera_config_test.cc -> config/
std::filesystem::path ConfigFolder() {
  return std::filesystem::path(__FILE__).parent_path().parent_path().parent_path() / "config";
}

TEST(CameraConfig, FilesHoldWhatIsCompiledIn) {
  for (const NamedCamera& camera : BuiltInCameras()) {
    const auto path = ConfigFolder() / (std::string(camera.name) + ".yaml");
    EXPECT_TRUE(Same(ReadCamera(path), camera.camera)) << path;
    EXPECT_TRUE(Same(FindCamera(path.string()), camera.camera));
    EXPECT_TRUE(Same(FindCamera(std::string(camera.name)), camera.camera));
  }
}

TEST(CameraConfig, ReadsEveryKey) {
  const TemporaryFolder folder;
  const PinholeCamera camera = ReadCamera(folder.Write("c.yaml", kGood));
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.height, 480);
  EXPECT_EQ(camera.fx, 500.5);
  EXPECT_EQ(camera.fy, 501);
  EXPECT_EQ(camera.cx, 320);
  EXPECT_EQ(camera.cy, 240);
  EXPECT_EQ(camera.depth_scale, 1000);
  EXPECT_EQ(camera.baseline_m, 0.05);
  EXPECT_THAT(camera.distortion, ::testing::ElementsAre(0.1, -0.2, 0.003, -0.004, 0.05, 0, 0, 0));
}

TEST(CameraConfig, RoundTripIsExact) {
  const TemporaryFolder folder;
  for (const NamedCamera& camera : BuiltInCameras()) {
    EXPECT_TRUE(Same(ReadCamera(folder.Write("c.yaml", FormatCamera(camera.camera))), camera.camera)) << camera.name;
  }
  PinholeCamera odd = BuiltInCameras()[0].camera;
  odd.fx = 517.3 + 1.0 / 3;
  EXPECT_TRUE(Same(ReadCamera(folder.Write("c.yaml", FormatCamera(odd))), odd));
}

TEST(CameraConfig, ErrorsNameFileLineAndKey) {
  EXPECT_THAT(ErrorWith("fx: 500.5\n", ""), HasSubstr("c.yaml: key 'fx' is missing"));
  EXPECT_THAT(ErrorWith("500.5", "wide"), HasSubstr("c.yaml:3: 'fx' must be a finite number, not 'wide'"));
  EXPECT_THAT(ErrorWith("500.5", "[1, 2]"), HasSubstr("c.yaml:3: 'fx' must be a finite number"));
  EXPECT_THAT(ErrorWith("500.5", ".nan"), HasSubstr("c.yaml:3: 'fx' must be a finite number"));
  EXPECT_THAT(ErrorWith("500.5", "0"), HasSubstr("c.yaml:3: 'fx' is 0, it must be more than 0"));
  EXPECT_THAT(ErrorWith("500.5", "-5"), HasSubstr("'fx' is -5"));
  EXPECT_THAT(ErrorWith("cx: 320", "cx: 640"), HasSubstr("'cx' is 640, it must be more than 0 and less than 640"));
  EXPECT_THAT(ErrorWith("640", "640.5"), HasSubstr("c.yaml:1: 'width' is 640.5, it must be a whole number of pixels"));
  EXPECT_THAT(ErrorWith("640", "-640"), HasSubstr("c.yaml:1: 'width' is -640"));
  EXPECT_THAT(ErrorWith("scale: 1000", "scale: 0"), HasSubstr("c.yaml:7: 'depth_scale' is 0"));
  EXPECT_THAT(ErrorWith("_m: 0.05", "_m: 0"), HasSubstr("'baseline_m' is 0"));
  EXPECT_THAT(ErrorWith(", 0.05]", ", 1, 2]"), HasSubstr("c.yaml:8: 'distortion' must be a list of five numbers"));
  EXPECT_THAT(ErrorWith("-0.2", "x"), HasSubstr("c.yaml:8: 'distortion' must be a finite number, not 'x'"));
  EXPECT_THAT(ErrorWith("depth_scale", "depthscale"),
              HasSubstr("c.yaml:7: unknown key 'depthscale' (did you mean 'depth_scale'?)"));
  EXPECT_THAT(ErrorOf(std::string(kGood) + "fx: 1\n"), HasSubstr("c.yaml:10: 'fx' stands there twice"));
  EXPECT_THAT(ErrorOf("fx: [1\nfy: 2\n"), HasSubstr("not YAML"));
  EXPECT_THAT(ErrorOf("just text\n"), HasSubstr("c.yaml: not a camera file"));
  EXPECT_THAT(ErrorOf(""), HasSubstr("c.yaml: not a camera file"));
  EXPECT_THAT(InputErrorOf([] { (void)ReadCamera("/none.yaml"); }), HasSubstr("/none.yaml: cannot be read: No such"));
}

TEST(FindCamera, ListsTheNamesItKnows) {
  EXPECT_THAT(
      InputErrorOf([] { (void)FindCamera("config/tum_fr4.yaml"); }),
      AllOf(HasSubstr("camera 'config/tum_fr4.yaml': neither a file nor a built-in camera (did you mean 'tum_fr1'?)"),
            HasSubstr("tum_fr1, tum_fr2, tum_fr3, bonn, redkitchen")));
}

TEST(RecognizeCamera, KnowsTheBenchmarksNames) {
  EXPECT_EQ(RecognizeCamera("/data/rgbd_dataset_freiburg1_desk"), "tum_fr1");
  EXPECT_EQ(RecognizeCamera("/data/rgbd_dataset_freiburg2_desk_with_person/"), "tum_fr2");
  EXPECT_EQ(RecognizeCamera("/data/rgbd_dataset_freiburg3_walking_xyz"), "tum_fr3");
  EXPECT_EQ(RecognizeCamera("/data/fr3_walking_xyz"), "tum_fr3");
  EXPECT_EQ(RecognizeCamera("/data/fr1/desk"), "tum_fr1");
  EXPECT_EQ(RecognizeCamera("/data/tum_fr2/desk/."), "tum_fr2");
  EXPECT_EQ(RecognizeCamera("/data/rgbd_bonn_balloon"), "bonn");
  EXPECT_EQ(RecognizeCamera("/data/Bonn/moving_box"), "bonn");
  EXPECT_EQ(RecognizeCamera("/data/kitchen_static"), std::nullopt);
  EXPECT_EQ(RecognizeCamera("/data/fr10"), std::nullopt);
  EXPECT_EQ(RecognizeCamera("/data/bonnet"), std::nullopt);
  EXPECT_EQ(RecognizeCamera("/data/freiburg1_desk/sub/rgb"), std::nullopt);
  EXPECT_EQ(RecognizeCamera("/"), std::nullopt);
}

TEST(CameraOfSequence, TakesTheNearestAtHand) {
  const TemporaryFolder folder;
  const auto sequence = folder.path() / "freiburg1_desk";
  std::filesystem::create_directories(sequence);
  EXPECT_EQ(CameraOfSequence(sequence, "").camera.fx, 517.306408);
  folder.Write("freiburg1_desk/camera.yaml", kGood);
  EXPECT_EQ(CameraOfSequence(sequence, "").camera.fx, 500.5);
  EXPECT_EQ(CameraOfSequence(sequence, "bonn").camera.fx, 542.822841);
}

TEST(CameraOfSequence, AsksForTheCameraItDoesNotKnow) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path() / "mine");
  EXPECT_THAT(InputErrorOf([&] { (void)CameraOfSequence(folder.path() / "mine", ""); }),
              AllOf(HasSubstr("mine: the camera is not recognized"), HasSubstr("--camera"), HasSubstr("tum_fr3"),
                    HasSubstr("copy config/redkitchen.yaml")));
}

}  // namespace
}  // namespace rds
