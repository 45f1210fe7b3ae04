// SPDX-License-Identifier: Apache-2.0
// ORB features: pyramid, FAST corners spread evenly over the image, orientation, rotated BRIEF descriptors.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "base/image.h"
#include "feature/frame_data.h"

namespace rds {

struct OrbOptions {
  int features = 1000;           // keypoints wanted
  int levels = 8;                // pyramid levels
  double scale_factor = 1.2;     // between levels
  int fast_threshold = 20;       // gray values
  int min_fast_threshold = 7;    // used in cells where the first threshold finds nothing
  bool depth_edges = true;       // look for jumps of the depth around each keypoint, and holes where it is near
  double moving_ratio = 0.1;     // of each coarse level's: keypoints wanted in addition on what moves
  double boundary_ratio = 0.15;  // of each level's: those wanted in addition beside it
};

// Extracts ORB features (Rublee et al., "ORB: an efficient alternative to SIFT or SURF", ICCV 2011) and looks up their
// depth. Keeps its buffers between calls: use one instance per thread. Deterministic: same input, same bytes out.
class OrbExtractor {
 public:
  explicit OrbExtractor(const OrbOptions& options);
  ~OrbExtractor();
  OrbExtractor(const OrbExtractor&) = delete;
  OrbExtractor& operator=(const OrbExtractor&) = delete;

  [[nodiscard]] const ScalePyramid& pyramid() const;

  // Features of a frame; `image` is gray or BGR, both images have the camera's size (else InvariantError). Never throws
  // on image content: a black image gives no features. `motion` is that of the samples of the depth grid (or empty):
  // corners on what moves and beside it have budgets of their own, so that people take no features from the room behind
  // them.
  [[nodiscard]] FrameData Extract(const PinholeCamera& camera, const Image8& image, const Image16& depth,
                                  std::span<const SampleMotion> motion = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rds
