// SPDX-License-Identifier: Apache-2.0
// What happens to a label: the paper's Algorithm 1 without its threads.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "propagation/free_space.h"
#include "propagation/motion_labels.h"
#include "propagation/recent_frames.h"
#include "runtime/guarded.h"
#include "runtime/published.h"
#include "segmentation/segmenter.h"
#include "semantic/backlog.h"
#include "system/backend.h"
#include "system/options.h"

namespace rds {

// Masks of one round, dilated; empty = unusable.
struct LabeledRound {
  std::vector<BacklogItem> items;
  std::vector<Image8> masks;                     // one for each item
  std::vector<std::optional<LedAstray>> astray;  // one for each item
  double segmentation_ms = 0;
  double mask_ms = 0;
  int failures = 0;  // keyframes without a usable mask
};

// Knows no thread. Segment and Apply have one caller at a time; the rest may be called from any thread.
class SemanticLane {
 public:
  // `segmenter` may be null: nothing is ever labeled.
  SemanticLane(const Options& options, std::shared_ptr<Segmenter> segmenter, Backend& backend);

  // Asks the back end for masks, adds what moves without a name and dilates them; never throws what the back end
  // throws.
  [[nodiscard]] LabeledRound Segment(std::vector<BacklogItem> items);
  // Labels keypoints, updates probabilities, corrects poses of keyframes from the front of the backlog.
  void Apply(const LabeledRound& round);

  [[nodiscard]] bool HasSegmenter() const { return segmenter_ != nullptr; }
  // Each frame, as it comes: what is labeled later is compared with it.
  void Remember(RecentFrames::Entry frame);
  // Asks the back end to give up.
  void Cancel();

  // The newest labeled keyframes with their poses in that epoch of the map, newest first; null before the first label,
  // and where all are older.
  [[nodiscard]] std::shared_ptr<const std::vector<DepthView>> LabeledViews(std::uint32_t epoch) const {
    const auto newest = views_.Get();
    return newest != nullptr && newest->epoch == epoch ? newest->views : nullptr;
  }
  [[nodiscard]] MaskView NewestMask() const;
  // What the newest mask leaves of its frame; nothing before the first. Its labels are in the map.
  struct Answer {
    FrameId frame;
    int usable_keypoints = 0;  // with depth, and not dynamic
    bool compared = false;     // with frames that lie apart, so that it knows what moves without a name
  };
  [[nodiscard]] std::optional<Answer> NewestAnswer() const;
  // Newest frame that has been labeled; -1 before the first.
  [[nodiscard]] std::int64_t newest_labeled() const { return newest_labeled_.load(std::memory_order_relaxed); }
  // The newest frame that tracking has begun, for the events' sake.
  void SetCurrentFrame(FrameId frame) { current_frame_.store(frame.value, std::memory_order_relaxed); }

  [[nodiscard]] std::vector<LabelEvent> events() const;
  [[nodiscard]] int failures() const;

 private:
  struct Views {
    std::uint32_t epoch = 0;
    std::shared_ptr<const std::vector<DepthView>> views;
  };
  struct Metrics {
    std::vector<LabelEvent> events;
    int failures = 0;
  };

  void PublishAnswer(const BacklogItem& item, const std::vector<KeypointLabel>& labels);
  // Logs the first few, and that there are more.
  void WarnOfSegmentation(const std::string& text);
  // Publishes the newest labeled views.
  void PublishLabeledViews(const LabeledRound& round);
  // One label's way into the map.
  LabelEvent ApplyMask(const BacklogItem& item, const Image8& mask, bool certain);
  // Corrects the keyframe of a frame and those after it, in their order.
  void OptimizeFrom(FrameId frame);

  SemanticOptions options_;
  ScalePyramid pyramid_;
  PoseOptimizerOptions pose_options_;
  std::shared_ptr<Segmenter> segmenter_;
  Backend& backend_;
  Guarded<Metrics> metrics_;
  Guarded<RecentFrames> recent_;
  Published<MaskView> mask_;
  Published<Answer> answer_;
  int segmentation_warnings_ = 0;
  std::vector<DepthView> labeled_;  // the newest ones, newest first
  Published<Views> views_;
  std::atomic<std::int64_t> newest_labeled_ = -1;
  std::atomic<std::uint32_t> current_frame_ = 0;
};

}  // namespace rds
