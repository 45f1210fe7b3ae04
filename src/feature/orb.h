// SPDX-License-Identifier: Apache-2.0
// ORB features: pyramid, FAST corners spread evenly over the image, orientation, rotated BRIEF descriptors.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "base/image.h"
#include "feature/frame_data.h"
#include "feature/orb_options.h"

namespace rds {

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
  // them. `velocity` is that of points at rest in the frame of the camera (m/s, rad/s): what a rolling shutter makes of
  // it is taken out of their places.
  [[nodiscard]] FrameData Extract(const PinholeCamera& camera, const Image8& image, const Image16& depth,
                                  std::span<const SampleMotion> motion = {},
                                  const Tangent6& velocity = Tangent6::Zero());

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rds
