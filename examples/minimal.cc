// SPDX-License-Identifier: Apache-2.0
// Tracks images from memory, with a segmenter of its own: a camera slides 10 mm a frame along a wall of random tiles,
// 2 m away, while something red walks through half of the picture.
#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "segmentation/mask.h"
#include "system/slam.h"

// Any back end: images in, masks out. A network goes here; this one knows that what moves is red.
class RedSegmenter final : public rds::Segmenter {
 public:
  std::vector<rds::Image8> Segment(std::span<const rds::SegmentationInput> inputs) override {
    std::vector<rds::Image8> masks;
    for (const rds::SegmentationInput& input : inputs) {
      const rds::Image8& image = *input.image;
      rds::Image8& mask = masks.emplace_back(image.width, image.height);
      for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
          mask.At(x, y) = image.At(x, y, 0) == 0 && image.At(x, y, 2) > 0 ? rds::kDynamicPixel : rds::kStaticPixel;
        }
      }
    }
    return masks;
  }
  void Cancel() override {}
  std::string Name() const override { return "red"; }
};

// Brightness of a tile, 1 .. 255.
std::uint8_t Brightness(int column, int row) {
  unsigned hash = static_cast<unsigned>(column) * 73856093U ^ static_cast<unsigned>(row) * 19349663U;
  hash = (hash ^ hash >> 13U) * 0x5bd1e995U;
  return static_cast<std::uint8_t>(1U + (hash >> 24U) * 254U / 255U);
}

int main() {
  const rds::PinholeCamera camera{.width = 640, .height = 480, .fx = 400, .fy = 400, .cx = 320, .cy = 240};
  rds::Slam slam(camera, rds::Options{}, std::make_unique<RedSegmenter>());
  for (int i = 0; i < 60; ++i) {
    auto image = std::make_shared<rds::Image8>(640, 480, 3);             // BGR
    auto depth = std::make_shared<rds::Image16>(640, 480, 1, 2 * 5000);  // 5000 units a meter
    const int left = 4 * i;                                              // of what walks
    for (int y = 0; y < 480; ++y) {
      for (int x = 0; x < 640; ++x) {
        if (x >= left && x < left + 320) {
          image->At(x, y, 2) = Brightness((x - left) / 14, y / 14);
          depth->At(x, y) = 1 * 5000;
        } else {
          for (int channel = 0; channel < 3; ++channel) {
            image->At(x, y, channel) = Brightness((x + 2 * i) / 14, y / 14);
          }
        }
      }
    }
    const rds::FrameResult result = slam.Process({.timestamp_s = i / 30.0, .image = image, .depth = depth});
    if (result.world_from_camera) {
      std::printf("frame %d: x = %.4f m\n", i, result.world_from_camera->translation.x());
    }
  }
  const rds::SlamResult result = slam.Finish();
  std::printf("tracked %d of %d frames; keyframes labeled: %zu\n", result.tracked_frames, result.processed_frames,
              result.labels.size());
}
