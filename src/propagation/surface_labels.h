// SPDX-License-Identifier: Apache-2.0
// Labels that spread over the surfaces of one depth image.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "feature/frame_data.h"
#include "map/keyframe.h"
#include "propagation/propagation_options.h"

namespace rds {

// What a sample of a depth grid is said to be, and how far the place is whose label says so.
struct SurfaceLabel {
  static constexpr int kNone = 256;  // px: no label

  std::uint16_t distance_px = kNone;  // along the surface, with the distance at which the label started
  bool dynamic = false;

  [[nodiscard]] bool IsKnown() const { return distance_px < kNone; }
};

// A label of a mask, at its place.
inline SurfaceLabel ToSurfaceLabel(KeypointLabel label) {
  return label == KeypointLabel::kNone ? SurfaceLabel{} : SurfaceLabel{0, label == KeypointLabel::kDynamic};
}

// Gives each sample of a frame's depth grid the label that is nearest along the surface: a path over neighboring
// samples without a jump in depth. Labels of people stop at their outlines, those of a wall reach all of it. Keeps its
// buffers between calls; not thread-safe.
class SurfaceLabels {
 public:
  explicit SurfaceLabels(const SurfaceLabelOptions& options) : options_(options) {}

  // Forgets everything and takes the surfaces of a frame.
  void Start(const DepthGrid& grid);
  // What is known of each sample of the grid (or nothing: empty), as if from `farther_px` farther away. Of several
  // labels of a sample the one of the least distance counts, of equals the first.
  void Add(std::span<const SurfaceLabel> samples, int farther_px = 0);
  void Add(std::span<const KeypointLabel> samples, int farther_px = 0);
  // Lets the labels spread over their surfaces.
  void Spread();
  // The labels of all samples, row by row.
  [[nodiscard]] std::vector<SurfaceLabel> Labels() const;

 private:
  using Cell = std::uint32_t;

  void Offer(Cell cell, int distance_px, bool dynamic);

  SurfaceLabelOptions options_;
  int columns_ = 0;             // with a border of one sample without depth on each side
  std::vector<float> depth_m_;  // row by row
  std::vector<SurfaceLabel> cells_;
  std::array<std::vector<Cell>, SurfaceLabel::kNone> queue_;  // by distance
};

// The labels of a frame's keypoints, spread over the surfaces that they lie on: one for each sample of its depth grid,
// row by row. Of several keypoints of a sample a dynamic one counts.
[[nodiscard]] std::vector<SurfaceLabel> SpreadLabels(const FrameData& data, std::span<const KeypointLabel> labels,
                                                     int reach_px);

}  // namespace rds
