// Labels that spread over the surfaces of one depth image.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "feature/frame_data.h"
#include "map/keyframe.h"

namespace rds {

struct SurfaceLabelOptions {
  int dynamic_reach_px = 255;  // how far a label of what moves spreads over a surface, below kMostReach
  int static_reach_px = 100;   // and one of what does not
  double step_depth = 0.03;    // neighbouring samples on a surface differ in depth by at most this share
};

// What a place is said to be, and how far the keypoint is whose label says so.
struct SurfaceLabel {
  bool dynamic = false;
  int distance_px = 0;  // along the surface, with the distance at which the label started
};

// Gives each sample of a frame's depth grid the label that is nearest along the surface: a path over neighbouring
// samples without a jump in depth. Labels of people stop at their outlines, those of a wall reach all of it. Keeps its
// buffers between calls; not thread-safe.
class SurfaceLabels {
 public:
  static constexpr int kMostReach = 256;

  explicit SurfaceLabels(const SurfaceLabelOptions& options) : options_(options) {}

  // How far a label spreads.
  [[nodiscard]] int Reach(bool dynamic) const { return dynamic ? options_.dynamic_reach_px : options_.static_reach_px; }
  // Forgets everything and takes the surfaces of a frame.
  void Start(const DepthGrid& grid);
  // A labelled keypoint; without depth it has no place on a surface and is ignored.
  void Add(const Keypoint& keypoint, const SurfaceLabel& label);
  // What is known of each sample of the grid; adds nothing where a keypoint has said so already. May be empty.
  void AddSamples(std::span<const KeypointLabel> samples);
  void Spread();
  // The label of a keypoint's place; nothing where none reaches it or the keypoint has no depth.
  [[nodiscard]] std::optional<SurfaceLabel> At(const Keypoint& keypoint) const;
  // A mark for each sample of the grid: 1 where it or a neighbour is dynamic. Nothing where none is.
  [[nodiscard]] std::vector<std::uint8_t> Moving() const;

 private:
  using Cell = std::uint32_t;
  struct State {
    std::uint16_t distance_px = kMostReach;
    bool dynamic = false;
  };

  // The sample on the keypoint's surface nearest to it.
  [[nodiscard]] std::optional<Cell> Find(const Keypoint& keypoint) const;
  void Offer(Cell cell, int distance_px, bool dynamic);

  SurfaceLabelOptions options_;
  int columns_ = 0;             // with a border of one sample without depth on each side
  std::vector<float> depth_m_;  // row by row
  std::vector<State> cells_;
  std::array<std::vector<Cell>, kMostReach> queue_;  // by distance
};

}  // namespace rds
