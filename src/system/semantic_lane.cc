// SPDX-License-Identifier: Apache-2.0
#include "system/semantic_lane.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <exception>
#include <utility>

#include "base/log.h"
#include "base/time.h"
#include "propagation/keyframe_labels.h"
#include "segmentation/mask.h"
#include "semantic/keypoint_labels.h"
#include "semantic/semantic_optimizer.h"

namespace rds {

SemanticLane::SemanticLane(const Options& options, std::shared_ptr<Segmenter> segmenter, Backend& backend)
    : options_(options.semantic),
      pyramid_(options.orb.levels, options.orb.scale_factor),
      pose_options_(options.pose),
      segmenter_(std::move(segmenter)),
      backend_(backend) {}

LabeledRound SemanticLane::Segment(std::vector<BacklogItem> items) {
  LabeledRound round;
  std::vector<SegmentationInput> inputs;
  for (const BacklogItem& item : items) {
    inputs.push_back({item.frame, item.timestamp_s, item.image});
  }
  round.items = std::move(items);
  Stopwatch watch;
  try {
    round.masks = segmenter_->Segment(inputs);
  } catch (const std::exception& error) {
    round.failures += static_cast<int>(inputs.size());
    WarnOfSegmentation(
        fmt::format("segmentation failed ({}): {}; going on without this label", segmenter_->Name(), error.what()));
  }
  const bool answered = round.failures == 0;
  round.segmentation_ms = watch.Milliseconds();
  watch.Restart();
  round.masks.resize(round.items.size());
  round.astray.resize(round.items.size());
  for (std::size_t i = 0; i < round.items.size(); ++i) {
    Image8& mask = round.masks[i];
    if (mask.empty()) {
      round.failures += answered ? 1 : 0;
      continue;
    }
    const Image8& image = *round.items[i].image;
    if (const auto problem = MaskProblem(mask, image.width, image.height, options_.max_mask_ratio)) {
      ++round.failures;
      if (mask.width == image.width && mask.height == image.height && mask.channels == 1) {
        PublishAnswer(round.items[i], {});  // it covers nearly all: nothing static is to be seen
      }
      WarnOfSegmentation(
          fmt::format("unusable mask of frame {} ({}): {}", round.items[i].frame.value, segmenter_->Name(), *problem));
      mask = {};
    } else {
      if (options_.motion) {
        const BacklogItem& item = round.items[i];
        round.astray[i] = MarkMoving(backend_, recent_.Read([](const RecentFrames& recent) { return recent; }),
                                     {item.frame, item.timestamp_s, item.data}, pyramid_, mask);
      }
      mask = Dilate(mask, DilationRadius(image.width, options_.dilation_px));
    }
    round.items[i].image.reset();  // used up
  }
  round.mask_ms = watch.Milliseconds();
  return round;
}

void SemanticLane::Remember(RecentFrames::Entry frame) {
  if (options_.motion && HasSegmenter()) {
    recent_.Write([&](RecentFrames& recent) { recent.Add(std::move(frame)); });
  }
}

void SemanticLane::WarnOfSegmentation(const std::string& text) {
  constexpr int kMost = 5;
  if (segmentation_warnings_++ < kMost) {
    log::warn("{}", text);
  }
  if (segmentation_warnings_ == kMost) {
    log::warn("more failures of segmentation are counted, not shown");
  }
}

void SemanticLane::Apply(const LabeledRound& round) {
  std::vector<LabelEvent> events;
  std::vector<std::size_t> fronts;  // of `events`
  for (std::size_t i = 0; i < round.items.size(); ++i) {
    if (!round.masks[i].empty()) {
      const LabelEvent event = ApplyMask(round.items[i], round.masks[i], round.astray[i].has_value());
      if (round.items[i].again) {
        continue;  // it counts once
      }
      if (round.items[i].from_front) {
        fronts.push_back(events.size());
      }
      events.push_back(event);
      events.back().segmentation_ms = round.segmentation_ms;
      events.back().mask_ms = round.mask_ms;
    }
  }
  for (const std::optional<LedAstray>& astray : round.astray) {
    if (astray) {
      LabelAgain(backend_, *astray);
    }
  }
  if (options_.optimizer.enabled) {
    for (const std::optional<LedAstray>& astray : round.astray) {
      if (astray) {
        OptimizeFrom(astray->witness);
      }
    }
    for (const std::size_t front : fronts) {
      const Stopwatch watch;
      OptimizeFrom(events[front].labeled_frame);
      events[front].optimization_ms = watch.Milliseconds();
    }
  }
  PublishLabeledViews(round);
  metrics_.Write([&](Metrics& metrics) {
    metrics.events.insert(metrics.events.end(), events.begin(), events.end());
    metrics.failures += round.failures;
  });
  backend_.PublishView();
}

void SemanticLane::PublishLabeledViews(const LabeledRound& round) {
  for (std::size_t i = 0; i < round.items.size(); ++i) {
    if (!round.masks[i].empty()) {
      const BacklogItem& item = round.items[i];
      std::erase_if(labeled_, [&](const DepthView& view) { return view.frame == item.frame; });
      labeled_.push_back(MakeView(item.frame, item.data, {}, LabelGrid(*item.data, round.masks[i])));
    }
  }
  std::ranges::sort(labeled_, std::ranges::greater(), &DepthView::frame);
  if (labeled_.size() > kFreeSpaceViews) {
    labeled_.resize(kFreeSpaceViews);
  }
  auto views = std::make_shared<std::vector<DepthView>>(labeled_);
  const std::uint32_t epoch =
      backend_.Read([&](const Map& map) {  // the poses as they are now; a keyframe may be gone or not be there yet
        std::erase_if(*views, [&](DepthView& view) {
          const Keyframe* const keyframe = map.FindByFrame(view.frame);
          if (keyframe != nullptr) {
            view.camera_from_world = keyframe->camera_from_world;
          }
          return keyframe == nullptr;
        });
        return map.epoch();
      });
  views_.Publish(std::make_shared<const Views>(Views{epoch, std::move(views)}));
}

LabelEvent SemanticLane::ApplyMask(const BacklogItem& item, const Image8& mask, bool certain) {
  const Stopwatch watch;
  const std::vector<KeypointLabel> labels = LabelKeypoints(*item.data, mask);
  LabelKeyframe(backend_, item.frame, labels, certain, options_.free_space);
  PublishAnswer(item, labels);  // whoever sees it finds the labels in the map
  LabelEvent event;
  event.labeled_frame = item.frame;
  event.current_frame = FrameId{current_frame_.load(std::memory_order_relaxed)};
  event.update_ms = watch.Milliseconds();
  if (newest_labeled() < static_cast<std::int64_t>(item.frame.value)) {
    newest_labeled_.store(item.frame.value, std::memory_order_relaxed);
    mask_.Publish(std::make_shared<const MaskView>(MaskView{item.frame, std::make_shared<const Image8>(mask)}));
  }
  return event;
}

void SemanticLane::PublishAnswer(const BacklogItem& item, const std::vector<KeypointLabel>& labels) {
  const bool compared =
      item.again || recent_.Read([&](const RecentFrames& recent) { return recent.ReachBeyond(item.timestamp_s); });
  Answer answer{item.frame, 0, compared};
  for (std::size_t i = 0; i < labels.size(); ++i) {
    answer.usable_keypoints += labels[i] != KeypointLabel::kDynamic && item.data->keypoints()[i].HasDepth() ? 1 : 0;
  }
  if (const auto newest = answer_.Get(); newest == nullptr || newest->frame <= answer.frame) {
    answer_.Publish(std::make_shared<const Answer>(answer));
  }
}

std::optional<SemanticLane::Answer> SemanticLane::NewestAnswer() const {
  const auto answer = answer_.Get();
  return answer ? std::optional(*answer) : std::nullopt;
}

void SemanticLane::OptimizeFrom(FrameId frame) {
  const std::vector<KeyframeId> keyframes = backend_.Read([&](const Map& map) {
    const auto& ids = map.keyframes();
    std::vector<KeyframeId> from;
    for (auto id = std::ranges::lower_bound(ids, frame, {}, [&](KeyframeId one) { return map.At(one).frame; });
         id != ids.end() && std::ssize(from) < options_.optimizer.most_keyframes; ++id) {
      if (from.empty() || map.WorldOf(*id) == map.WorldOf(from.front())) {
        from.push_back(*id);
      }
    }
    return from;
  });
  for (const KeyframeId keyframe : keyframes) {
    backend_.Commit([&](const Map& map) { return PlanSemanticPose(map, keyframe, options_.optimizer); },
                    [&](const auto& problem) { return SolveSemanticPose(problem, pose_options_, options_.optimizer); });
  }
}

void SemanticLane::Cancel() {
  if (segmenter_) {
    segmenter_->Cancel();
  }
}

MaskView SemanticLane::NewestMask() const {
  const auto view = mask_.Get();
  return view ? *view : MaskView{};
}

std::vector<LabelEvent> SemanticLane::events() const {
  return metrics_.Read([](const Metrics& metrics) { return metrics.events; });
}

int SemanticLane::failures() const {
  return metrics_.Read([](const Metrics& metrics) { return metrics.failures; });
}

}  // namespace rds
