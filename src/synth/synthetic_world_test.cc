// SPDX-License-Identifier: Apache-2.0
#include "synth/synthetic_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "base/error.h"
#include "testing/matchers.h"

namespace rds {
namespace {

SyntheticOptions Small(SyntheticScenario scenario, SyntheticPath path) {
  SyntheticOptions options;
  options.camera = MakeSyntheticCamera(320, 240);
  options.scenario = scenario;
  options.path = path;
  options.frames = 60;
  return options;
}

TEST(SyntheticWorld, SameOptionsSameBytesInAnyOrder) {
  const SyntheticOptions options = Small(SyntheticScenario::kWalking, SyntheticPath::kOrbit);
  const SyntheticWorld a(options);
  const SyntheticWorld b(options);
  (void)b.Render(40);
  for (const int i : {0, 31}) {
    const SyntheticFrame x = a.Render(i);
    const SyntheticFrame y = b.Render(i);
    EXPECT_EQ(x.rgbd.image->data, y.rgbd.image->data);
    EXPECT_EQ(x.rgbd.depth->data, y.rgbd.depth->data);
    EXPECT_EQ(x.mask->data, y.mask->data);
    EXPECT_THAT(x.world_from_camera, RigidNear(y.world_from_camera, 1e-12, 1e-12));
  }
}

TEST(SyntheticWorld, SeedAndNoiseChangeThePictures) {
  SyntheticOptions options = Small(SyntheticScenario::kStatic, SyntheticPath::kXyz);
  const SyntheticFrame one = SyntheticWorld(options).Render(3);
  options.noise = false;
  const SyntheticFrame exact = SyntheticWorld(options).Render(3);
  options.noise = true;
  options.seed = 2;
  const SyntheticFrame two = SyntheticWorld(options).Render(3);
  EXPECT_NE(one.rgbd.image->data, two.rgbd.image->data);
  EXPECT_NE(one.rgbd.image->data, exact.rgbd.image->data);
  EXPECT_NE(one.rgbd.depth->data, exact.rgbd.depth->data);
  EXPECT_THAT(one.world_from_camera, RigidNear(exact.world_from_camera, 1e-12, 1e-12));
  EXPECT_EQ(std::count(exact.rgbd.depth->data.begin(), exact.rgbd.depth->data.end(), 0), 0);
  EXPECT_GT(std::count(one.rgbd.depth->data.begin(), one.rgbd.depth->data.end(), 0), 1000);
}

TEST(SyntheticWorld, DepthIsOffByAFactorForEachFrame) {
  SyntheticOptions options = Small(SyntheticScenario::kStatic, SyntheticPath::kXyz);
  options.noise = false;
  const SyntheticWorld exact(options);
  options.depth_error = 0.02;
  const SyntheticWorld off(options);
  std::vector<double> factors;
  for (int i = 0; i < 12; ++i) {
    const SyntheticFrame a = exact.Render(i);
    const SyntheticFrame b = off.Render(i);
    EXPECT_EQ(a.rgbd.image->data, b.rgbd.image->data);
    factors.push_back(static_cast<double>(b.rgbd.depth->At(160, 120)) / a.rgbd.depth->At(160, 120));
    EXPECT_NEAR(static_cast<double>(b.rgbd.depth->At(20, 200)) / a.rgbd.depth->At(20, 200), factors.back(), 1e-3);
  }
  const auto [least, most] = std::ranges::minmax(factors);
  EXPECT_GT(most - least, 0.01);
  EXPECT_GT(least, 0.9);
  EXPECT_LT(most, 1.1);
  options.depth_error = 0.2;
  EXPECT_THROW(Validate(options), InputError);
}

TEST(SyntheticWorld, TimestampsAreThirtyHertz) {
  const SyntheticWorld world(Small(SyntheticScenario::kStatic, SyntheticPath::kStatic));
  EXPECT_EQ(world.TimestampS(0), 0.0);
  EXPECT_DOUBLE_EQ(world.TimestampS(30), 1.0);
  EXPECT_DOUBLE_EQ(world.Render(7).rgbd.timestamp_s, 7 / 30.0);
  EXPECT_THROW((void)world.Render(60), InvariantError);
  EXPECT_THROW((void)world.Render(-1), InvariantError);
}

// Least and greatest depth of the 3 x 3 pixels about one, meters; only of one surface, as steps of 3 % tell.
struct Range {
  double least_m = 0;
  double greatest_m = 0;
};
std::optional<Range> DepthsAbout(const Image16& depth, const PinholeCamera& camera, int x, int y) {
  if (x < 1 || y < 1 || x + 1 >= depth.width || y + 1 >= depth.height) {
    return std::nullopt;
  }
  std::uint16_t least = 65535;
  std::uint16_t greatest = 0;
  for (int k = 0; k < 9; ++k) {
    least = std::min(least, depth.At(x - 1 + k % 3, y - 1 + k / 3));
    greatest = std::max(greatest, depth.At(x - 1 + k % 3, y - 1 + k / 3));
  }
  if (least == 0 || greatest > 1.03 * least) {
    return std::nullopt;
  }
  return Range{least / camera.depth_scale, greatest / camera.depth_scale};
}

double GrayAt(const Image8& image, double x, double y) {
  const int x0 = static_cast<int>(std::floor(x));
  const int y0 = static_cast<int>(std::floor(y));
  double sum = 0;
  for (int k = 0; k < 4; ++k) {
    const std::uint8_t* bgr = image.Row(y0 + k / 2) + 3 * (x0 + k % 2);
    sum += (k % 2 == 1 ? x - x0 : x0 + 1 - x) * (k / 2 == 1 ? y - y0 : y0 + 1 - y) * (bgr[0] + bgr[1] + bgr[2]) / 3.0;
  }
  return sum;
}

class EveryPath : public testing::TestWithParam<SyntheticPath> {};

// Points of one frame, moved by the true poses, must be found in another frame with the depth and the color predicted.
TEST_P(EveryPath, GroundTruthCarriesOneFrameIntoAnother) {
  SyntheticOptions options = Small(SyntheticScenario::kWalking, GetParam());
  options.noise = false;
  options.movers = 2;  // leave enough of the room to compare
  const SyntheticWorld world(options);
  const PinholeCamera& camera = world.camera();
  const SyntheticFrame from = world.Render(20);
  const SyntheticFrame to = world.Render(25);
  const Rigid3 to_from_from = to.world_from_camera.Inverse() * from.world_from_camera;
  int compared = 0;
  int depth_off = 0;
  double gray_error = 0;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      if (from.mask->At(x, y) != 0) {
        continue;
      }
      const double depth_m = from.rgbd.depth->At(x, y) / camera.depth_scale;
      const Eigen::Vector3d point = to_from_from * camera.Unproject(Eigen::Vector2d(x, y), depth_m);
      const Eigen::Vector2d pixel = camera.Project(point);
      const auto column = static_cast<int>(std::lround(pixel.x()));
      const auto row = static_cast<int>(std::lround(pixel.y()));
      const std::optional<Range> found = DepthsAbout(*to.rgbd.depth, camera, column, row);
      if (!found || to.mask->At(column, row) != 0 || point.z() > 1.03 * found->greatest_m) {
        continue;  // an edge, a mover, or hidden behind something
      }
      ++compared;
      depth_off += point.z() < found->least_m - 0.001 || point.z() > found->greatest_m + 0.001 ? 1 : 0;
      const std::uint8_t* bgr = from.rgbd.image->Row(y) + 3 * x;
      gray_error += std::abs(GrayAt(*to.rgbd.image, pixel.x(), pixel.y()) - (bgr[0] + bgr[1] + bgr[2]) / 3.0);
    }
  }
  EXPECT_GT(compared, 25000);
  EXPECT_LT(depth_off, 0.003 * compared);
  EXPECT_LT(gray_error / compared, 5.0);
}

TEST_P(EveryPath, HasManyWellSpreadCorners) {
  SyntheticOptions options;
  options.path = GetParam();
  options.scenario = SyntheticScenario::kStatic;
  options.frames = 600;
  const SyntheticWorld world(options);
  for (const int i : {0, 240, 480}) {
    const SyntheticFrame frame = world.Render(i);
    const cv::Mat bgr(480, 640, CV_8UC3, const_cast<std::uint8_t*>(frame.rgbd.image->data.data()));
    cv::Mat gray;
    cv::cvtColor(bgr, gray, cv::COLOR_BGR2GRAY);
    std::vector<cv::KeyPoint> corners;
    cv::FAST(gray, corners, 20);
    EXPECT_GT(corners.size(), 600U) << "frame " << i;
    std::vector<int> cells(48);
    for (const cv::KeyPoint& corner : corners) {
      ++cells[static_cast<std::size_t>(static_cast<int>(corner.pt.y) / 80 * 8 + static_cast<int>(corner.pt.x) / 80)];
    }
    EXPECT_GT(std::count_if(cells.begin(), cells.end(), [](int n) { return n >= 3; }), 30) << "frame " << i;
    const cv::Scalar mean = cv::mean(gray);
    EXPECT_GT(mean[0], 60) << "frame " << i;
    EXPECT_LT(mean[0], 190) << "frame " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Paths, EveryPath,
                         testing::Values(SyntheticPath::kOrbit, SyntheticPath::kLoop, SyntheticPath::kXyz,
                                         SyntheticPath::kRpy, SyntheticPath::kHalfsphere, SyntheticPath::kStatic),
                         [](const auto& the) { return std::string(NameOf(the.param)); });

class EveryScenario : public testing::TestWithParam<SyntheticScenario> {};

// Against the same world without movers: everything outside the mask is the same, nearly everything inside differs.
TEST_P(EveryScenario, MaskCoversExactlyTheMovers) {
  SyntheticOptions options = Small(GetParam(), SyntheticPath::kOrbit);
  options.noise = false;
  const SyntheticWorld with(options);
  options.movers = 0;
  options.scenario = SyntheticScenario::kStatic;
  const SyntheticWorld without(options);
  double covered = 0;
  for (const int i : {0, 30, 59}) {
    const SyntheticFrame a = with.Render(i);
    const SyntheticFrame b = without.Render(i);
    int masked = 0;
    int same_inside = 0;
    for (int y = 0; y < 240; ++y) {
      for (int x = 0; x < 320; ++x) {
        const bool same =
            a.rgbd.depth->At(x, y) == b.rgbd.depth->At(x, y) &&
            std::equal(a.rgbd.image->Row(y) + 3 * x, a.rgbd.image->Row(y) + 3 * x + 3, b.rgbd.image->Row(y) + 3 * x);
        ASSERT_EQ(b.mask->At(x, y), 0);
        ASSERT_TRUE(same || a.mask->At(x, y) == 255) << x << " " << y;
        masked += a.mask->At(x, y) == 255 ? 1 : 0;
        same_inside += same && a.mask->At(x, y) == 255 ? 1 : 0;
      }
    }
    EXPECT_LE(same_inside, 0.01 * masked);
    covered += masked / (3.0 * 320 * 240);
  }
  EXPECT_GT(covered, 0.02);
  EXPECT_LT(covered, 0.6);
}

INSTANTIATE_TEST_SUITE_P(Scenarios, EveryScenario,
                         testing::Values(SyntheticScenario::kWalking, SyntheticScenario::kSitting,
                                         SyntheticScenario::kCrowd, SyntheticScenario::kCarried,
                                         SyntheticScenario::kCrossing),
                         [](const auto& the) { return std::string(NameOf(the.param)); });

TEST(SyntheticWorld, MoversMove) {
  const SyntheticWorld world(Small(SyntheticScenario::kWalking, SyntheticPath::kStatic));
  EXPECT_NE(world.Render(0).mask->data, world.Render(20).mask->data);
  EXPECT_GT(world.MoverClearanceM(0), 0.2);
  EXPECT_GT(world.StaticClearanceM(0), 0.2);
}

TEST(SyntheticWorld, BadOptionsAreRefused) {
  SyntheticOptions options;
  options.frames = 0;
  EXPECT_THROW(SyntheticWorld{options}, InputError);
  options = {};
  options.movers = kMaxSyntheticMovers + 1;
  EXPECT_THROW(SyntheticWorld{options}, InputError);
  options = {};
  options.camera.distortion[0] = 0.1;
  EXPECT_THROW(SyntheticWorld{options}, InputError);
  options = {};
  options.camera = MakeSyntheticCamera(8, 6);
  EXPECT_THROW(SyntheticWorld{options}, InputError);
  EXPECT_THROW(ParseSyntheticScenario("wlaking"), InputError);
  EXPECT_EQ(ParseSyntheticPath("halfsphere"), SyntheticPath::kHalfsphere);
}

}  // namespace
}  // namespace rds
