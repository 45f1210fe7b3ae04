// SPDX-License-Identifier: Apache-2.0
#include "io/camera_file.h"

#include <gmock/gmock.h>

#include "io/camera_plausibility.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kBase = "width: 640\nheight: 480\nfx: 585\nfy: 585\ncx: 320\ncy: 240\ndepth_scale: 5000\n";

PinholeCamera Read(const std::string& text) {
  const TemporaryFolder folder;
  return ReadCamera(folder.Write("c.yaml", text));
}
std::string ErrorOf(const std::string& text) {
  return InputErrorOf([&] { (void)Read(text); });
}
std::string With(const std::string& piece, const std::string& replacement) {
  std::string text = kBase;
  text.replace(text.find(piece), piece.size(), replacement);
  return text;
}

TEST(ReadCamera, ReadsEveryModelOfDistortion) {
  EXPECT_EQ(Read(kBase + "distortion: [0.1, -0.2, 0, 0]\n").distortion[1], -0.2);
  const PinholeCamera rational = Read(
      "width: 1280\nheight: 720\nfx: 605\nfy: 605\ncx: 637\ncy: 366\ndepth_scale: 1000\n"
      "distortion: [0.465, -2.728, 0.0006, -0.0001, 1.591, 0.344, -2.547, 1.517]\n");
  EXPECT_EQ(rational.distortion[7], 1.517);
  const std::string fisheye =
      With("585", "386") + "distortion_model: fisheye\ndistortion: [-0.01, 0.05, -0.04, 0.008]\n";
  EXPECT_EQ(Read(fisheye).distortion_model, DistortionModel::kFisheye);
  for (const PinholeCamera& camera : {rational, Read(fisheye)}) {
    EXPECT_EQ(Read(FormatCamera(camera)).distortion, camera.distortion);
    EXPECT_EQ(Read(FormatCamera(camera)).distortion_model, camera.distortion_model);
  }
  EXPECT_THAT(ErrorOf(kBase + "distortion_model: equidistant\n"), HasSubstr("brown_conrady or fisheye"));
}

TEST(ReadCamera, RefusesDistortionsThatCannotBeUndone) {
  for (const std::string distortion :
       {"[5, -40, 0.5, 0.5, 100]", "[1e6, 1e6, 1e3, 1e3, 1e9]", "[0.26, -0.95, 1.16, -0.005, 0.003]"}) {
    EXPECT_THAT(ErrorOf(kBase + "distortion: " + distortion + "\n"),
                AllOf(HasSubstr("c.yaml: distortion:"), HasSubstr("k1, k2, p1, p2, k3")))
        << distortion;
  }
}

TEST(ReadCamera, RefusesNumbersThatNoCameraHasAndNamesTheLikelyOnes) {
  EXPECT_THAT(ErrorOf("width: 640\nheight: 480\nfx: 0.914\nfy: 1.219\ncx: 0.5\ncy: 0.5\ndepth_scale: 5000\n"),
              AllOf(HasSubstr("fx 0.914 makes a field of view of 179.7 degrees"), HasSubstr("fx: 584.96")));
  EXPECT_THAT(ErrorOf(With("fx: 585", "fx: 1170")), AllOf(HasSubstr("30.6 degrees"), HasSubstr("fx: 585")));
  EXPECT_THAT(ErrorOf("width: 640\nheight: 480\nfx: 585\nfy: 320\ncx: 585\ncy: 240\ndepth_scale: 5000\n"),
              HasSubstr("cx 585 lies far from the middle"));
  EXPECT_THAT(ErrorOf(kBase + "baseline_m: 40\n"), HasSubstr("baseline_m: 0.06838"));
  EXPECT_THAT(ErrorOf(kBase + "baseline_m: 50\n"), HasSubstr("baseline_m: 0.05"));
  EXPECT_THAT(ErrorOf(kBase + "baseline_m: 0.0001\n"), HasSubstr("no RGB-D camera has it"));
  EXPECT_THAT(ErrorOf(With("depth_scale: 5000", "depth_scale: 0.0002")), HasSubstr("depth_scale: 5000"));
  EXPECT_THAT(ErrorOf(With("depth_scale: 5000", "depth_scale: 1")), HasSubstr("number of units in a meter"));
  EXPECT_EQ(Read(With("fx: 585", "fx: 1170") + "unusual: true\n").fx, 1170);
  EXPECT_THAT(ErrorOf(kBase + "unusual: perhaps\n"), HasSubstr("must be true or false"));
}

TEST(DepthProblem, NamesTheScaleThatIsLikelyMeant) {
  PinholeCamera camera = Read(kBase);
  EXPECT_EQ(DepthProblem(camera, 2), std::nullopt);
  camera.depth_scale = 1000;  // for pictures of 5000 a meter
  EXPECT_THAT(DepthProblem(camera, 10).value_or(""), HasSubstr("depth_scale: 5000"));
  camera.depth_scale = 5000;  // for millimeters
  EXPECT_EQ(DepthProblem(camera, 0.4), std::nullopt) << "may be a hand in front of the camera";
  EXPECT_THAT(DepthProblem(camera, 0.05).value_or(""), HasSubstr("which makes it 0.25 m"));
  camera.unusual = true;
  EXPECT_EQ(DepthProblem(camera, 100), std::nullopt);
}

TEST(ReadCamera, ReadsOrbSlam) {
  const PinholeCamera three = Read(
      "%YAML:1.0\n\nFile.version: \"1.0\"\nCamera.type: \"PinHole\"\nCamera1.fx: 542.8\nCamera1.fy: 542.5\n"
      "Camera1.cx: 315.5\nCamera1.cy: 237.7\nCamera1.k1: 0.04\nCamera1.k2: -0.1\nCamera1.p1: -0.0007\n"
      "Camera1.p2: 0\nCamera.width: 640\nCamera.height: 480\nCamera.fps: 30\nStereo.b: 0.07369\n"
      "RGBD.DepthMapFactor: 5000.0\nORBextractor.nFeatures: 1000\n");
  EXPECT_EQ(three.fx, 542.8);
  EXPECT_EQ(three.distortion[0], 0.04);
  EXPECT_EQ(three.distortion[2], -0.0007);
  EXPECT_EQ(three.baseline_m, 0.07369);
  EXPECT_EQ(three.depth_scale, 5000);
  const std::string two =
      "%YAML:1.0\n\nCamera.fx: 535.4\nCamera.fy: 539.2\nCamera.cx: 320.1\nCamera.cy: 247.6\nCamera.bf: 40.0\n"
      "DepthMapFactor: 5000.0\n";
  EXPECT_THAT(ErrorOf(two), HasSubstr("add Camera.width and Camera.height"));
  EXPECT_NEAR(Read(two + "Camera.width: 640\nCamera.height: 480\n").baseline_m, 40 / 535.4, 1e-12);
  const PinholeCamera fisheye = Read(
      "Camera.type: KannalaBrandt8\nCamera1.fx: 386\nCamera1.fy: 386\nCamera1.cx: 320\nCamera1.cy: 240\n"
      "Camera1.k1: -0.01\nCamera1.k2: 0.05\nCamera1.k3: -0.04\nCamera1.k4: 0.008\nCamera.width: 640\n"
      "Camera.height: 480\nRGBD.DepthMapFactor: 1000\n");
  EXPECT_EQ(fisheye.distortion_model, DistortionModel::kFisheye);
  EXPECT_EQ(fisheye.distortion[3], 0.008);
}

TEST(ReadCamera, ReadsOpenCvRosAndOpen3dOnceTheScaleIsThere) {
  const std::string opencv =
      "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncameraMatrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n"
      "   dt: d\n   data: [ 585., 0., 321., 0., 586., 241., 0., 0., 1. ]\ndistCoeffs: !!opencv-matrix\n   rows: 1\n"
      "   cols: 5\n   dt: d\n   data: [ 0.1, 0., 0., 0., 0. ]\n";
  const std::string ros =
      "image_width: 640\nimage_height: 480\ncamera_name: rgb\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
      "  data: [585.0, 0.0, 321.0, 0.0, 586.0, 241.0, 0.0, 0.0, 1.0]\ndistortion_model: plumb_bob\n"
      "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0.1, 0.0, 0.0, 0.0, 0.0]\n";
  const std::string echoed =
      "header:\n  seq: 1\nheight: 480\nwidth: 640\ndistortion_model: \"plumb_bob\"\nD: [0.1, 0.0, 0.0, 0.0, 0.0]\n"
      "K: [585.0, 0.0, 321.0, 0.0, 586.0, 241.0, 0.0, 0.0, 1.0]\n";
  for (const std::string& text : {opencv, ros, echoed}) {
    EXPECT_THAT(ErrorOf(text), HasSubstr("add the line 'depth_scale: N'"));
    const PinholeCamera camera = Read(text + "depth_scale: 1000\n");
    EXPECT_EQ(camera.width, 640);
    EXPECT_EQ(camera.fx, 585);
    EXPECT_EQ(camera.fy, 586);
    EXPECT_EQ(camera.cx, 321);
    EXPECT_EQ(camera.cy, 241);
    EXPECT_EQ(camera.distortion[0], 0.1);
    EXPECT_EQ(camera.depth_scale, 1000);
  }
  const PinholeCamera open3d = Read(
      "{\"width\": 640, \"height\": 480, \"intrinsic_matrix\": [585,0,0,0,586,0,321,241,1], \"depth_scale\": 1000}");
  EXPECT_EQ(open3d.cx, 321);
  EXPECT_EQ(open3d.cy, 241);
  EXPECT_THAT(ErrorOf("K: [1, 2]\nwidth: 640\nheight: 480\n"), HasSubstr("9 are wanted"));
  EXPECT_THAT(ErrorOf("K: [1, a]\n"), HasSubstr("a finite number is wanted"));
}

TEST(CameraFile, ReadsTheNoiseOfDepth) {
  const auto noise = [](const std::string& line) { return Read(kBase + line).depth_noise; };
  EXPECT_EQ(noise("depth_noise: structured_light\n").quadratic_per_m, DepthNoiseModel{}.quadratic_per_m);
  EXPECT_EQ(noise("depth_noise: [0.003, 0.001]\n").Sigma_m(2), 0.003 + 0.001 * 4);
  EXPECT_EQ(noise("depth_noise: time_of_flight\n").Sigma_m(1), noise("depth_noise: time_of_flight\n").Sigma_m(5));
  // A wider baseline measures better.
  EXPECT_LT(noise("baseline_m: 0.1\ndepth_noise: stereo\n").Sigma_m(3),
            noise("baseline_m: 0.05\ndepth_noise: stereo\n").Sigma_m(3));
  EXPECT_THAT(ErrorOf(kBase + "depth_noise: laser\n"), HasSubstr("structured_light, stereo or time_of_flight"));
  EXPECT_THAT(ErrorOf(kBase + "depth_noise: [0, 0]\n"), HasSubstr("tenth of a millimeter"));
  EXPECT_THAT(ErrorOf(kBase + "depth_noise: [0.001]\n"), HasSubstr("[constant in m, quadratic in 1/m]"));
}

TEST(CameraFile, ReadsTheRollingShutterAndKnowsThatOfKnownCameras) {
  EXPECT_EQ(Read(kBase + "rolling_shutter_s: 0.015\n").rolling_shutter_s, 0.015);
  EXPECT_THAT(ErrorOf(kBase + "rolling_shutter_s: 20\n"), HasSubstr("from 0 to 0.1"));
  const std::string kinect =
      "width: 640\nheight: 480\nfx: 517.3064\nfy: 516.4692\ncx: 318.643\ncy: 255.314\ndepth_scale: 5000\n";
  EXPECT_GT(Read(kinect).rolling_shutter_s, 0);
  EXPECT_EQ(Read(kinect + "rolling_shutter_s: 0\n").rolling_shutter_s, 0);
  const std::string orb_slam =
      "Camera.fx: 517.306408\nCamera.fy: 516.469215\nCamera.cx: 318.643040\nCamera.cy: 255.313989\n"
      "Camera.width: 640\nCamera.height: 480\nCamera.bf: 40.0\nDepthMapFactor: 5000.0\n";
  EXPECT_GT(Read(orb_slam).rolling_shutter_s, 0);
}

}  // namespace
}  // namespace rds
