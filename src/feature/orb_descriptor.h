// SPDX-License-Identifier: Apache-2.0
// Orientation and rotated BRIEF descriptors of ORB.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "feature/frame_data.h"

namespace rds {

// Pixels that orientation and descriptor use around a keypoint.
inline constexpr int kPatchRadius = 15;

// Direction from the center of a round patch of radius 15 to its centroid of intensity.
struct Orientation {
  float cosine = 1;
  float sine = 0;

  // [0, 360), to 0.3 degrees.
  [[nodiscard]] float AngleDeg() const;
};

// Orientation of the patch around `center`; all pixels up to 16 around must be readable.
[[nodiscard]] Orientation OrientationAt(const std::uint8_t* center, std::ptrdiff_t stride);

// Describes patches by 256 comparisons of two pixels of a smoothed image, turned with the patch's orientation (Rublee
// et al., section 4). The pairs are ours: drawn from a normal distribution, seeded. Immutable: safe to share.
class PatchDescriber {
 public:
  PatchDescriber();

  // Descriptor at `center` of a smoothed image; all pixels up to 15 around must be readable.
  [[nodiscard]] Descriptor Describe(const std::uint8_t* center, std::ptrdiff_t stride, Orientation orientation) const;

 private:
  static constexpr std::size_t kPoints = 512;
  // Both points of a pair side by side.
  alignas(64) std::array<float, kPoints> x_;
  alignas(64) std::array<float, kPoints> y_;
};

}  // namespace rds
