// Labels that follow keypoints through the images, beside tracking.
#pragma once

#include <memory>
#include <optional>

#include "runtime/bounded_queue.h"
#include "runtime/worker.h"
#include "semantic/free_space.h"
#include "tracking/feature_tracks.h"

namespace rds {

// Runs FeatureTracks on a thread of its own, so that it costs tracking no time: it works while tracking searches for
// the points of the last frame, and needs less time than that. In lockstep it works when asked. One caller: Begin, then
// Get, once each for a frame.
class LabelFollower {
 public:
  // The table of labels by track must outlive it.
  LabelFollower(const FeatureTrackOptions& options, const MovingProbabilityOptions& probability,
                const FreeSpaceOptions& space, MovingProbabilities& labels, bool lockstep);
  ~LabelFollower();

  // `views` are labelled ones, may be null; `expected` is the pose (camera from world) that the frame should have,
  // nothing where it cannot be told.
  void Begin(std::shared_ptr<const FrameData> frame, std::shared_ptr<const std::vector<SeenView>> views,
             const std::optional<Rigid3>& expected);
  // Waits for the labels of the frame that was begun. Throws what the thread threw.
  [[nodiscard]] KeypointLabels Get();

 private:
  struct Request {
    std::shared_ptr<const FrameData> frame;
    std::shared_ptr<const std::vector<SeenView>> views;
    std::optional<Rigid3> expected;
  };

  void Run();
  [[nodiscard]] KeypointLabels Follow(Request request);

  FeatureTracks tracks_;
  MovingProbabilityOptions probability_;
  FreeSpaceOptions space_;
  MovingProbabilities& labels_;
  BoundedQueue<Request> frames_{1};
  BoundedQueue<KeypointLabels> results_{1};
  int begun_ = 0;
  std::optional<Worker> worker_;  // none in lockstep
};

}  // namespace rds
