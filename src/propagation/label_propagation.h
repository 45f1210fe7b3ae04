// SPDX-License-Identifier: Apache-2.0
// Labels of the surfaces that a frame sees, propagated from frame to frame.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/ids.h"
#include "feature/frame_data.h"
#include "geometry/depth_grid.h"
#include "propagation/free_space.h"
#include "propagation/propagation_options.h"
#include "propagation/surface_labels.h"

namespace rds {

// Labels of the surfaces of one frame. Immutable once made.
struct PropagatedLabels {
  FrameId frame;
  std::uint32_t epoch = 0;  // of the map that the pose is in
  PinholeCamera camera;
  Rigid3 camera_from_world;
  DepthGrid grid;
  std::vector<SurfaceLabel> labels;  // of each sample of the grid
  std::vector<SampleMotion> motion;  // of each sample, for the extractor; empty if nothing moves
};

// Moving probability of each keypoint of a later frame of the same camera, by the labels of the surface that it lies
// on; 1/2 where there is none. Surfaces are found again by their depth near the place where they would be if they kept
// still, so that those of walking people are found, too; static ones hold at their place only. Looked up when asked
// for. Immutable: safe to share.
class KeypointProbabilities {
 public:
  // `later_from_field` is the motion of the camera.
  KeypointProbabilities(std::shared_ptr<const PropagatedLabels> field, std::shared_ptr<const FrameData> later,
                        const Rigid3& later_from_field, const SurfaceLabelOptions& options);

  [[nodiscard]] double operator[](std::size_t keypoint) const;

 private:
  std::shared_ptr<const PropagatedLabels> field_;
  std::shared_ptr<const FrameData> later_;
  GridWarp field_from_later_;
  SurfaceLabelOptions options_;
};

// 1 for each sample of a later frame's depth grid that lies on a surface called static, 0 elsewhere. Looks only at
// every `step`-th sample in each direction, from step / 2 on. Otherwise like KeypointProbabilities. Re-entrant.
[[nodiscard]] std::vector<std::uint8_t> StaticSamples(const PropagatedLabels& field, const FrameData& later,
                                                      const Rigid3& later_from_field, int step);

// Propagates labels from the masks of labeled keyframes to the current frame, along the surfaces in the depth images of
// all frames since, whatever moves. Free-space violations are added as labels. Not thread-safe.
class LabelPropagator {
 public:
  LabelPropagator(const PropagationOptions& options, const FreeSpaceOptions& space)
      : options_(options), space_(space), surface_(options.surface) {}

  // The field of the next frame. `views` are the newest labeled keyframes; each is propagated here once. With poses of
  // another epoch of the map all begins anew.
  [[nodiscard]] std::shared_ptr<const PropagatedLabels> Next(FrameId frame, const FrameData& data,
                                                             const Rigid3& camera_from_world,
                                                             std::span<const DepthView> views, std::uint32_t epoch = 0);

 private:
  static constexpr std::size_t kLongestHistory = 64;  // frames over which a late label is propagated at most

  struct Source {
    std::int32_t sample = -1;  // none
    bool moved = false;        // it was next to the place: only what is dynamic has gone there
  };
  struct HistoryEntry {
    FrameId frame;
    Rigid3 camera_from_world;
    DepthGrid grid;
    std::vector<Source> sources;  // of each sample, the sample of the moment before that shows the same surface
  };

  [[nodiscard]] static std::vector<Source> FindSources(const PinholeCamera& camera, const HistoryEntry& from,
                                                       const HistoryEntry& to);
  template <typename Value>
  [[nodiscard]] static std::vector<Value> Propagate(std::span<const Source> sources, std::span<const Value> values);
  // The labels of a keyframe where its surfaces are now, over all frames since; empty if it is too long ago.
  [[nodiscard]] std::vector<KeypointLabel> PropagateFrom(const DepthView& view) const;
  [[nodiscard]] int PenaltySince(FrameId then, FrameId now) const;  // px

  PropagationOptions options_;
  FreeSpaceOptions space_;
  SurfaceLabels surface_;
  std::uint32_t epoch_ = 0;
  std::deque<HistoryEntry> history_;  // ascending by frame
  std::vector<SurfaceLabel> labels_;  // of the last moment
  std::vector<FrameId> propagated_;   // keyframes whose labels are on their way
};

}  // namespace rds
