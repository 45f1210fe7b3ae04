// SPDX-License-Identifier: Apache-2.0
// Tracks images from memory: a camera slides 10 mm a frame along a wall of random tiles, 2 m away.
#include <cstdio>
#include <memory>

#include "system/slam.h"

// Brightness of a tile of the wall, 0 .. 255.
std::uint8_t Brightness(int column, int row) {
  unsigned hash = static_cast<unsigned>(column) * 73856093U ^ static_cast<unsigned>(row) * 19349663U;
  hash = (hash ^ hash >> 13U) * 0x5bd1e995U;
  return static_cast<std::uint8_t>(hash >> 24U);
}

int main() {
  const rds::PinholeCamera camera{.width = 640, .height = 480, .fx = 400, .fy = 400, .cx = 320, .cy = 240};
  rds::Slam slam(camera, rds::Options{});
  for (int i = 0; i < 60; ++i) {
    auto image = std::make_shared<rds::Image8>(640, 480);
    auto depth = std::make_shared<rds::Image16>(640, 480, 1, 2 * 5000);  // 5000 units a meter
    for (int y = 0; y < 480; ++y) {
      for (int x = 0; x < 640; ++x) {
        image->At(x, y) = Brightness((x + 2 * i) / 14, y / 14);
      }
    }
    const rds::FrameResult result = slam.Process({.timestamp_s = i / 30.0, .image = image, .depth = depth});
    if (result.world_from_camera) {
      std::printf("frame %d: x = %.4f m\n", i, result.world_from_camera->translation.x());
    }
  }
  const rds::SlamResult result = slam.Finish();
  std::printf("tracked %d of %d frames\n", result.tracked_frames, result.processed_frames);
}
