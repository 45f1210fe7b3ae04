// SPDX-License-Identifier: Apache-2.0
// The phases that both executors run: what happens to a keyframe, and to a label.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "map/local_map.h"
#include "mapping/local_mapper.h"
#include "runtime/guarded.h"
#include "runtime/published.h"
#include "segmentation/segmenter.h"
#include "semantic/backlog.h"
#include "system/options.h"
#include "system/slam.h"

namespace rds {

// Everything behind the door: the map, and labels that arrived before their keyframe was in it.
struct World {
  explicit World(const ScalePyramid& pyramid) : map(pyramid) {}

  Map map;
  std::map<FrameId, std::vector<KeypointLabel>> early_labels;
};

// Masks of one round, dilated; empty = unusable.
struct LabeledRound {
  std::vector<BacklogItem> items;
  std::vector<Image8> masks;  // one for each item
  double segmentation_ms = 0;
  double mask_ms = 0;
  int failures = 0;  // keyframes without a usable mask
};

// State shared by tracking, mapping and semantics, and the phases that change it. MapKeyframe and its kin belong to the
// mapping thread, Segment and ApplyRound to the semantic thread; what they share is behind the door (`world`),
// published, or atomic.
class Pipeline {
 public:
  Pipeline(const Options& options, const ScalePyramid& pyramid, std::shared_ptr<Segmenter> segmenter);

  // Mapping. Inserts the keyframe and publishes; then, unless `should_stop()` says that another one waits, refines,
  // adjusts, culls and publishes again.
  void MapKeyframe(const KeyframeCandidate& candidate, const std::function<bool()>& should_stop);

  // Semantics. Asks the back end for masks and dilates them; never throws what the back end throws.
  [[nodiscard]] LabeledRound Segment(std::vector<BacklogItem> items);
  // Labels keypoints, updates probabilities, corrects poses of keyframes from the front of the backlog.
  void ApplyRound(const LabeledRound& round);

  [[nodiscard]] bool HasSegmenter() const { return segmenter_ != nullptr; }
  void CancelSegmenter();

  [[nodiscard]] std::shared_ptr<const LocalMap> CurrentLocalMap() const { return local_map_.Get(); }
  [[nodiscard]] const MovingProbabilities& probabilities() const { return probabilities_; }
  // The newest labeled keyframes with their poses, newest first; null before the first label.
  [[nodiscard]] std::shared_ptr<const std::vector<DepthView>> LabeledViews() const { return views_.Get(); }
  [[nodiscard]] std::shared_ptr<const MapView> ViewMap() const;
  [[nodiscard]] MaskView ViewMask() const;
  // Newest frame that has been labeled; -1 before the first.
  [[nodiscard]] std::int64_t newest_labeled() const { return newest_labeled_.load(std::memory_order_relaxed); }
  // The newest frame that tracking has begun, for the events' sake.
  void SetCurrentFrame(FrameId frame) { current_frame_.store(frame.value, std::memory_order_relaxed); }

  // Final poses and figures; after all threads have ended.
  void FillResult(SlamResult* result) const;
  [[nodiscard]] Rigid3 CameraFromWorld(KeyframeId keyframe) const;

 private:
  struct Metrics {
    std::vector<double> local_ba_ms;
    std::vector<LabelEvent> labels;
    int segmentation_failures = 0;
  };

  void AdjustLocally(KeyframeId keyframe, const std::function<bool()>& should_stop);
  void PublishAround(KeyframeId keyframe);
  // For drawing, if it is wanted.
  void PublishView();
  [[nodiscard]] MapView MakeMapView() const;
  // Logs the first few, and that there are more.
  void WarnOfSegmentation(const std::string& text);
  // Makes labels dynamic where something has moved in since earlier keyframes; leaves them if the frame is not in the
  // map (yet).
  void AddFreeSpaceViolations(FrameId frame, std::vector<KeypointLabel>& labels) const;
  // Labels of keypoints for the keyframe made from a frame; kept if it is not in the map yet, dropped if no more.
  void ApplyToMap(FrameId frame, std::vector<KeypointLabel> labels);
  // Publishes the newest labeled views.
  void PublishLabeledViews(const LabeledRound& round);
  // One label's way into the map.
  LabelEvent ApplyMask(const BacklogItem& item, const Image8& mask);
  // Corrects the keyframe of a frame and those after it, in their order.
  void OptimizeFrom(FrameId frame);

  Options options_;
  ScalePyramid pyramid_;
  std::shared_ptr<Segmenter> segmenter_;
  MovingProbabilities probabilities_;  // by map point
  LocalMapper mapper_;
  Guarded<World> world_;
  Guarded<Metrics> metrics_;
  Published<LocalMap> local_map_;
  Published<MaskView> mask_;
  Published<MapView> view_;
  int segmentation_warnings_ = 0;   // the semantic thread's
  std::vector<DepthView> labeled_;  // the newest ones, newest first; the semantic thread's
  Published<std::vector<DepthView>> views_;
  std::atomic<std::int64_t> newest_labeled_ = -1;
  std::atomic<std::uint32_t> current_frame_ = 0;
};

}  // namespace rds
