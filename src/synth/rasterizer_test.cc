// SPDX-License-Identifier: Apache-2.0
#include "synth/rasterizer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "synth/synthetic_options.h"
#include "testing/matchers.h"

namespace rds::synthetic {
namespace {

std::shared_ptr<const Texture> Plain(float value) {
  Canvas canvas(1, 1, 0.1);
  canvas.Fill({value, value, value});
  return std::make_shared<Texture>(canvas);
}

// Upright before a camera that looks along z: right = +x, down = +y.
Quad Facing(double z, float value) { return {{-1, -1, z}, {1, 0, 0}, {0, 1, 0}, 2, 2, Plain(value)}; }

float DepthAt(const Drawing& drawing, const PinholeCamera& camera, int x, int y) {
  return drawing.depth_m[static_cast<std::size_t>(y * camera.width + x)];
}

TEST(Rasterizer, NearerSurfaceHidesTheOther) {
  const PinholeCamera camera = MakeSyntheticCamera(160, 120);
  Scene scene;
  scene.quads = {Facing(2, 50), Facing(3, 200)};
  scene.quads[0].corner.x() = 0;  // right half only
  const Drawing drawing = Draw(scene, camera, {});
  EXPECT_FLOAT_EQ(DepthAt(drawing, camera, 100, 60), 2);
  EXPECT_FLOAT_EQ(DepthAt(drawing, camera, 60, 60), 3);
  EXPECT_FLOAT_EQ(DepthAt(drawing, camera, 0, 0), 0);  // the quads end before the image's corner
  EXPECT_NEAR(drawing.color[3 * (60 * 160 + 100)], 50, 1e-3);
  EXPECT_NEAR(drawing.color[3 * (60 * 160 + 60)], 200, 1e-3);
}

TEST(Rasterizer, BackSidesAreNotSeen) {
  const PinholeCamera camera = MakeSyntheticCamera(160, 120);
  Scene scene;
  scene.quads = {Facing(2, 50)};
  scene.quads[0].corner.x() = 1;
  scene.quads[0].right = {-1, 0, 0};
  EXPECT_GT(scene.quads[0].Normal().z(), 0.9);
  EXPECT_FLOAT_EQ(DepthAt(Draw(scene, camera, {}), camera, 80, 60), 0);
}

TEST(Rasterizer, ObliquePlaneHasTheDepthOfTheRay) {
  const PinholeCamera camera = MakeSyntheticCamera(160, 120);
  Scene scene;
  Quad floor{{-20, 1.2, 40}, {1, 0, 0}, {0, 0, -1}, 40, 40, Plain(90)};  // y = 1.2 below the camera
  scene.quads = {floor};
  const Drawing drawing = Draw(scene, camera, {});
  for (const int y : {75, 90, 119}) {
    const double ray_y = (y - camera.cy) / camera.fy;
    EXPECT_NEAR(DepthAt(drawing, camera, 33, y), 1.2 / ray_y, 1e-4 * 1.2 / ray_y);
  }
}

TEST(Rasterizer, CapsuleSurfaceLiesOnTheCapsule) {
  const PinholeCamera camera = MakeSyntheticCamera(320, 240);
  Rigid3 camera_from_world;
  camera_from_world.rotation = ExpSo3({0.1, -0.2, 0.3});
  camera_from_world.translation = {0.05, 0.02, 2.0};
  Scene scene;
  scene.capsules = {MakeLimb({0, 0.4, 0.1}, {0.2, -0.3, -0.1}, Eigen::Vector3d::UnitX(), 0.15, 0.15, Plain(90))};
  scene.capsules[0].is_mover = true;
  const Drawing drawing = Draw(scene, camera, camera_from_world);
  int hits = 0;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const double depth = static_cast<double>(DepthAt(drawing, camera, x, y));
      if (depth == 0) {
        continue;
      }
      ++hits;
      ASSERT_EQ(drawing.mask.At(x, y), 255);
      const Eigen::Vector3d point =
          camera_from_world.Inverse() * camera.Unproject({static_cast<double>(x), static_cast<double>(y)}, depth);
      // Distance from the segment, by projection on it.
      const Eigen::Vector3d a(0, 0.4, 0.1);
      const Eigen::Vector3d along(0.2, -0.7, -0.2);
      const double share = std::clamp((point - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
      ASSERT_NEAR((point - a - share * along).norm(), 0.15, 1e-4) << x << " " << y;
    }
  }
  EXPECT_GT(hits, 3000);
}

TEST(Rasterizer, SquashedCapsuleIsMeasuredInItsOwnAxes) {
  Scene scene;
  Capsule ball;
  ball.center = {0, 0, 3};
  ball.axes = Eigen::Vector3d(0.3, 0.2, 0.5).asDiagonal();
  ball.texture = Plain(100);
  scene.capsules = {ball};
  const PinholeCamera odd = MakeSyntheticCamera(161, 121);  // a ray through the very middle
  const Drawing drawing = Draw(scene, odd, {});
  EXPECT_NEAR(DepthAt(drawing, odd, 80, 60), 2.5, 1e-6);
  EXPECT_EQ(drawing.mask.At(80, 60), 0);
}

// A picture under a filter must have the same mean however far it is.
TEST(Rasterizer, FarTexturesAreFilteredNotSampled) {
  Canvas canvas(2, 2, 0.01);
  canvas.Fill({0, 0, 0});
  for (int y = 0; y < canvas.height(); ++y) {
    for (int x = (y % 2); x < canvas.width(); x += 2) {
      canvas.At(x, y) = {200, 200, 200};
    }
  }
  const PinholeCamera camera = MakeSyntheticCamera(160, 120);
  Scene scene;
  scene.quads = {Facing(12, 0)};
  scene.quads[0].texture = std::make_shared<Texture>(canvas);
  const Drawing drawing = Draw(scene, camera, {});
  for (int x = 72; x < 88; ++x) {
    EXPECT_NEAR(drawing.color[static_cast<std::size_t>(3 * (60 * 160 + x))], 100, 8);
  }
}

TEST(Box, DistanceAndRays) {
  const Box box({1, 0, 0}, {0.5, 0.25, 1}, M_PI / 2);  // turned: .25 in x, .5 in y
  EXPECT_NEAR(box.Distance({2, 0, 0}), 0.75, 1e-12);
  EXPECT_NEAR(box.Distance({1, 0, 0.9}), 0, 1e-12);
  EXPECT_TRUE(box.Meets({0, 0.45, 0}, {1, 0, 0}, 0, 10));
  EXPECT_FALSE(box.Meets({0, 0.55, 0}, {1, 0, 0}, 0, 10));
  EXPECT_FALSE(box.Meets({0, 0.45, 0}, {1, 0, 0}, 0, 0.7));
  EXPECT_FALSE(box.Meets({0, 0.45, 0}, {-1, 0, 0}, 0, 10));
}

}  // namespace
}  // namespace rds::synthetic
