// Image-space tracks of keypoints, and what labels of earlier keyframes say of the keypoints of this frame.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/ids.h"
#include "feature/frame_data.h"
#include "map/keyframe.h"
#include "semantic/moving_probability.h"
#include "tracking/surface_labels.h"

namespace rds {

struct FeatureTrackOptions {
  bool enabled = true;
  double window_px = 20;  // around where the track is expected
  int spacing_px = 16;    // a new track starts where none is in a square of this size
  int frame_cost_px = 4;  // an inherited label is as if so much farther away with each frame
  SurfaceLabelOptions surface;
};

// What is known of a frame's keypoints before any of them is matched to the map.
struct KeypointLabels {
  std::vector<PointId> tracks;        // image-space track of each keypoint; invalid where there is none
  std::vector<double> probabilities;  // moving probability of each keypoint
  std::vector<std::uint8_t> moving;   // 1 for each sample of the depth grid where something moves; empty if nothing
};

// Follows keypoints from frame to frame by appearance alone, whatever moves: a person's features keep their tracks
// while they walk, which no map point does. A label that arrives late for a keyframe names tracks, and so reaches the
// same features in the frame of the moment; from there it spreads over their surface, to features that have come into
// view since, and is handed on from frame to frame until it is too far from where it came. Not thread-safe; the labels
// live in a wait-free table.
class FeatureTracks {
 public:
  // Tracks are numbered round and round below this, so that the table of labels stays small.
  static constexpr std::uint32_t kMostTracks = 1U << 20U;

  explicit FeatureTracks(const FeatureTrackOptions& options) : options_(options), surface_(options.surface) {}

  // Continues tracks into the next frame and starts new ones there, whose entry in `labels` is reset. A keypoint has
  // the probability of its track's label, else of the one that reaches it along its surface, else it is unknown.
  // `judged` says what else is known of each sample of the frame's depth grid (JudgeBySpace), or is empty.
  [[nodiscard]] KeypointLabels Follow(std::shared_ptr<const FrameData> frame, std::span<const KeypointLabel> judged,
                                      MovingProbabilities& labels, const MovingProbabilityOptions& options);

 private:
  struct Track {
    std::uint32_t keypoint = 0;
    float flow_x = 0;  // px a frame
    float flow_y = 0;
    std::optional<SurfaceLabel> inherited;
  };

  void ContinueTracks(std::shared_ptr<const FrameData> frame);
  void StartTracks(MovingProbabilities& labels);
  [[nodiscard]] std::vector<double> SpreadLabels(std::span<const KeypointLabel> judged,
                                                 const MovingProbabilities& labels,
                                                 const MovingProbabilityOptions& options);

  FeatureTrackOptions options_;
  SurfaceLabels surface_;
  std::shared_ptr<const FrameData> frame_;
  std::vector<PointId> ids_;
  std::vector<Track> tracks_;  // ascending by keypoint
  std::vector<std::uint8_t> occupied_;
  std::uint32_t next_ = 0;
};

}  // namespace rds
