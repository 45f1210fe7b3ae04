// SPDX-License-Identifier: Apache-2.0
#include "system/pipeline.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <exception>
#include <utility>

#include "base/log.h"
#include "base/time.h"
#include "propagation/mask_completion.h"
#include "segmentation/mask.h"
#include "semantic/evidence.h"

namespace rds {
namespace {

// The keyframe made from a frame, if it is in the map.
const Keyframe* FindByFrame(const Map& map, FrameId frame) {
  const auto& ids = map.keyframes();
  const auto place = std::ranges::lower_bound(ids, frame, {}, [&](KeyframeId id) { return map.At(id).frame; });
  return place != ids.end() && map.At(*place).frame == frame ? &map.At(*place) : nullptr;
}

}  // namespace

Pipeline::Pipeline(const Options& options, const ScalePyramid& pyramid, std::shared_ptr<Segmenter> segmenter)
    : options_(options),
      pyramid_(pyramid),
      segmenter_(std::move(segmenter)),
      mapper_(options.mapping, options.semantic.probability, probabilities_),
      world_(pyramid) {}

void Pipeline::PublishAround(KeyframeId keyframe) {
  local_map_.Publish(
      world_.Read([&](const World& world) { return BuildLocalMap(world.map, keyframe, options_.local_map); }));
}

void Pipeline::MapKeyframe(const KeyframeCandidate& candidate, const std::function<bool()>& should_stop) {
  std::vector<KeypointLabel> early;
  const KeyframeId id = world_.Write([&](World& world) {
    if (auto found = world.early_labels.extract(candidate.frame)) {
      early = std::move(found.mapped());
    }
    return mapper_.Insert(world.map, candidate);
  });
  if (!early.empty()) {
    ApplyToMap(candidate.frame, std::move(early));
  }
  PublishAround(id);
  world_.Write([&](World& world) { mapper_.Refine(world.map, id); });
  if (!should_stop()) {
    AdjustLocally(id, should_stop);
    world_.Write([&](World& world) { mapper_.CullKeyframes(world.map, id); });
  }
  world_.Write([&](World& world) { probabilities_.Release(world.map.TakeFreedPointPages()); });
  PublishAround(id);
  PublishView();
}

void Pipeline::AdjustLocally(KeyframeId keyframe, const std::function<bool()>& should_stop) {
  const Stopwatch watch;
  const LocalBundle bundle = world_.Read([&](const World& world) {
    return CopyLocalBundle(world.map, keyframe, HasSegmenter(), probabilities_, options_.semantic.probability,
                           options_.mapping.bundle);
  });
  if (!bundle.worthwhile) {
    return;
  }
  const BundleResult result = AdjustBundle(bundle.problem, options_.mapping.bundle.solver, should_stop);
  if (result.usable) {
    world_.Write([&](World& world) { ApplyLocalBundle(world.map, bundle, result); });
  }
  metrics_.Write([&](Metrics& figures) { figures.local_ba_ms.push_back(watch.Milliseconds()); });
}

LabeledRound Pipeline::Segment(std::vector<BacklogItem> items) {
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
  for (std::size_t i = 0; i < round.items.size(); ++i) {
    Image8& mask = round.masks[i];
    if (mask.empty()) {
      round.failures += answered ? 1 : 0;
      continue;
    }
    const Image8& image = *round.items[i].image;
    if (const auto problem = MaskProblem(mask, image.width, image.height, options_.semantic.max_mask_ratio)) {
      ++round.failures;
      WarnOfSegmentation(
          fmt::format("unusable mask of frame {} ({}): {}", round.items[i].frame.value, segmenter_->Name(), *problem));
      mask = {};
    } else {
      CompleteMask(round.items[i].data->depth_grid(), options_.semantic.completion_step_ratio, mask);
      mask = Dilate(mask, DilationRadius(image.width, options_.semantic.dilation_px));
    }
    round.items[i].image.reset();  // used up
  }
  round.mask_ms = watch.Milliseconds();
  return round;
}

void Pipeline::WarnOfSegmentation(const std::string& text) {
  constexpr int kMost = 5;
  if (segmentation_warnings_++ < kMost) {
    log::warn("{}", text);
  }
  if (segmentation_warnings_ == kMost) {
    log::warn("more failures of segmentation are counted, not shown");
  }
}

void Pipeline::ApplyRound(const LabeledRound& round) {
  std::vector<LabelEvent> events;
  std::vector<std::size_t> fronts;  // of `events`
  for (std::size_t i = 0; i < round.items.size(); ++i) {
    if (!round.masks[i].empty()) {
      if (round.items[i].from_front) {
        fronts.push_back(events.size());
      }
      events.push_back(ApplyMask(round.items[i], round.masks[i]));
      events.back().segmentation_ms = round.segmentation_ms;
      events.back().mask_ms = round.mask_ms;
    }
  }
  if (options_.semantic.optimizer.enabled) {
    for (const std::size_t front : fronts) {
      const Stopwatch watch;
      OptimizeFrom(events[front].labeled_frame);
      events[front].optimization_ms = watch.Milliseconds();
    }
  }
  PublishLabeledViews(round);
  metrics_.Write([&](Metrics& figures) {
    figures.labels.insert(figures.labels.end(), events.begin(), events.end());
    figures.segmentation_failures += round.failures;
  });
  PublishView();
}

void Pipeline::AddFreeSpaceViolations(FrameId frame, std::vector<KeypointLabel>& labels) const {
  struct Question {
    std::shared_ptr<const FrameData> data;
    Rigid3 camera_from_world;
    std::vector<DepthView> views;
  };
  if (!options_.semantic.free_space.enabled) {
    return;
  }
  const auto question = world_.Read([&](const World& world) -> std::optional<Question> {
    const Keyframe* const keyframe = FindByFrame(world.map, frame);
    if (keyframe == nullptr) {
      return std::nullopt;
    }
    return Question{keyframe->data, keyframe->camera_from_world, EarlierViews(world.map, keyframe->id)};
  });
  if (question) {
    MarkNewlyOccupied(
        *question->data,
        CheckFreeSpace(*question->data, question->camera_from_world, question->views, options_.semantic.free_space),
        labels);
  }
}

void Pipeline::ApplyToMap(FrameId frame, std::vector<KeypointLabel> labels) {
  AddFreeSpaceViolations(frame, labels);
  world_.Write([&](World& world) {
    const Keyframe* const keyframe = FindByFrame(world.map, frame);
    if (keyframe != nullptr) {
      ApplyLabels(world.map, keyframe->id, std::move(labels), probabilities_, options_.semantic.probability);
    } else if (world.map.keyframes().empty() || world.map.At(world.map.newest()).frame < frame) {
      world.early_labels[frame] = std::move(labels);  // mapping has not come to it yet
    }
  });
}

void Pipeline::PublishLabeledViews(const LabeledRound& round) {
  for (std::size_t i = 0; i < round.items.size(); ++i) {
    if (!round.masks[i].empty()) {
      const BacklogItem& item = round.items[i];
      labeled_.push_back(MakeView(item.frame, item.data, {}, LabelGrid(*item.data, round.masks[i])));
    }
  }
  std::ranges::sort(labeled_, std::ranges::greater(), &DepthView::frame);
  if (labeled_.size() > kFreeSpaceViews) {
    labeled_.resize(kFreeSpaceViews);
  }
  auto views = std::make_shared<std::vector<DepthView>>(labeled_);
  world_.Read([&](const World& world) {  // the poses as they are now; a keyframe may be gone or not be there yet
    std::erase_if(*views, [&](DepthView& view) {
      const Keyframe* const keyframe = FindByFrame(world.map, view.frame);
      if (keyframe != nullptr) {
        view.camera_from_world = keyframe->camera_from_world;
      }
      return keyframe == nullptr;
    });
  });
  views_.Publish(std::move(views));
}

LabelEvent Pipeline::ApplyMask(const BacklogItem& item, const Image8& mask) {
  const Stopwatch watch;
  ApplyToMap(item.frame, LabelKeypoints(*item.data, mask));
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

void Pipeline::OptimizeFrom(FrameId frame) {
  const std::vector<KeyframeId> keyframes = world_.Read([&](const World& world) {
    std::vector<KeyframeId> from;
    for (const KeyframeId id : world.map.keyframes()) {
      if (world.map.At(id).frame >= frame && std::ssize(from) < options_.semantic.optimizer.most_keyframes) {
        from.push_back(id);
      }
    }
    return from;
  });
  for (const KeyframeId keyframe : keyframes) {
    const auto problem = world_.Read([&](const World& world) {
      return CopyStaticMatches(world.map, keyframe, probabilities_, options_.semantic.probability,
                               options_.semantic.optimizer);
    });
    if (problem) {
      const PoseResult result =
          OptimizePose(problem->camera, problem->camera_from_world, problem->observations, options_.pose);
      world_.Write(
          [&](World& world) { return ApplySemanticPose(world.map, *problem, result, options_.semantic.optimizer); });
    }
  }
}

void Pipeline::CancelSegmenter() {
  if (segmenter_) {
    segmenter_->Cancel();
  }
}

std::shared_ptr<const MapView> Pipeline::ViewMap() const {
  auto view = view_.Get();
  return view ? view : std::make_shared<const MapView>();
}

void Pipeline::PublishView() {
  if (options_.system.keep_features) {
    view_.Publish(std::make_shared<const MapView>(MakeMapView()));
  }
}

MapView Pipeline::MakeMapView() const {
  return world_.Read([&](const World& world) {
    MapView view;
    for (const KeyframeId id : world.map.keyframes()) {
      view.keyframes.push_back(world.map.At(id).camera_from_world.Inverse());
    }
    for (const PointId id : world.map.Points()) {
      view.points.push_back(world.map.At(id).position.cast<float>());
      view.moving_probability.push_back(static_cast<float>(probabilities_.Get(id)));
    }
    return view;
  });
}

MaskView Pipeline::ViewMask() const {
  const auto view = mask_.Get();
  return view ? *view : MaskView{};
}

Rigid3 Pipeline::CameraFromWorld(KeyframeId keyframe) const {
  return world_.Read([&](const World& world) { return world.map.CameraFromWorld(keyframe); });
}

void Pipeline::FillResult(SlamResult* result) const {
  world_.Read([&](const World& world) {
    for (const KeyframeId id : world.map.keyframes()) {
      const Keyframe& keyframe = world.map.At(id);
      result->keyframes.push_back({keyframe.timestamp_s, keyframe.camera_from_world.Inverse()});
    }
  });
  metrics_.Read([&](const Metrics& figures) {
    result->local_ba_ms = figures.local_ba_ms;
    result->labels = figures.labels;
    result->segmentation_failures = figures.segmentation_failures;
  });
  result->map = MakeMapView();
  for (const float p : result->map.moving_probability) {
    switch (StateOf(static_cast<double>(p), options_.semantic.probability)) {
      case PointState::kStatic:
        ++result->static_points;
        break;
      case PointState::kUnknown:
        ++result->unknown_points;
        break;
      case PointState::kDynamic:
        ++result->dynamic_points;
        break;
    }
  }
}

}  // namespace rds
