// Image-space tracks of keypoints, and what labels of earlier keyframes say of the keypoints of this frame.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "base/ids.h"
#include "feature/frame_data.h"
#include "semantic/moving_probability.h"

namespace rds {

struct FeatureTrackOptions {
  bool enabled = true;
  double window_px = 20;       // around where the track is expected
  double vote_window_px = 30;  // neighbourhood of a keypoint without a label of its own
  double vote_depth = 0.1;     // neighbours' depth may differ by this share
  int votes = 2;               // neighbours that must speak for dynamic, and be twice as many as those against
};

// Follows keypoints from frame to frame by appearance alone, whatever moves: a person's features keep their tracks
// while they walk, which no map point does. A label that arrives late for a keyframe names tracks, and so reaches the
// same features in the frame of the moment. Not thread-safe; the labels live in a wait-free table.
class FeatureTracks {
 public:
  // Tracks are numbered round and round below this, so that the table of labels stays small.
  static constexpr std::uint32_t kMostTracks = 1U << 20U;

  explicit FeatureTracks(const FeatureTrackOptions& options) : options_(options) {}

  // Continues tracks into the next frame and starts new ones there, whose entry in `labels` is reset.
  void Advance(std::shared_ptr<const FrameData> frame, MovingProbabilities& labels);

  // Track of each keypoint of the newest frame.
  [[nodiscard]] std::span<const PointId> ids() const { return ids_; }

  // Moving probability of each keypoint of the newest frame: its track's label or, without one, high where neighbours
  // of the same depth are on dynamic tracks; else unknown.
  [[nodiscard]] std::vector<double> Probabilities(const MovingProbabilities& labels,
                                                  const MovingProbabilityOptions& options) const;

 private:
  struct Flow {
    float x = 0;  // px a frame
    float y = 0;
  };

  FeatureTrackOptions options_;
  std::shared_ptr<const FrameData> frame_;
  std::vector<PointId> ids_;
  std::vector<Flow> flows_;
  std::uint32_t next_ = 0;
};

}  // namespace rds
