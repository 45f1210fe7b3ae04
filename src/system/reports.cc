// SPDX-License-Identifier: Apache-2.0
#include "system/reports.h"

#include <string>
#include <vector>

#include "base/error.h"

namespace rds {
namespace {

std::vector<FeatureView> ViewFeatures(const FrameData& data, const TrackOutcome& outcome) {
  std::vector<FeatureView> views;
  for (const Keypoint& keypoint : data.keypoints()) {
    views.push_back({keypoint.raw_x, keypoint.raw_y, FeatureState::kUnmatched});
  }
  for (const PointMatch& match : outcome.used) {
    views[match.keypoint].state = match.state == PointState::kStatic ? FeatureState::kStatic : FeatureState::kUnknown;
  }
  for (const PointMatch& match : outcome.rejected) {
    views[match.keypoint].state = FeatureState::kRejected;
  }
  return views;
}

LockSummary::Series Summary(const TimeHistogram& times) {
  return {times.QuantileMs(0.5), times.QuantileMs(0.95), times.max_ms()};
}

}  // namespace

std::string_view ToString(TrackingState state) {
  switch (state) {
    case TrackingState::kNotInitialized:
      return "not_initialized";
    case TrackingState::kTracked:
      return "tracked";
    case TrackingState::kLost:
      return "lost";
  }
  throw InvariantError("unknown tracking state");
}

void CheckFrame(const RgbdFrame& frame, const PinholeCamera& camera, std::optional<double> last_timestamp_s) {
  const std::string when = "frame at " + std::to_string(frame.timestamp_s) + " s: ";
  if (frame.image == nullptr || frame.depth == nullptr) {
    throw InputError(when + "an image or its depth is missing");
  }
  const auto size = [](int width, int height) { return std::to_string(width) + " x " + std::to_string(height); };
  if (frame.image->width != camera.width || frame.image->height != camera.height ||
      frame.depth->width != camera.width || frame.depth->height != camera.height) {
    throw InputError(when + "image " + size(frame.image->width, frame.image->height) + " and depth " +
                     size(frame.depth->width, frame.depth->height) + " must both be the camera's " +
                     size(camera.width, camera.height));
  }
  if ((frame.image->channels != 1 && frame.image->channels != 3) || frame.depth->channels != 1) {
    throw InputError(when + "the image must have 1 or 3 channels and the depth 1");
  }
  if (!(frame.timestamp_s > last_timestamp_s.value_or(-1e300))) {
    throw InputError(when + "timestamps must increase; the frame before was at " +
                     std::to_string(last_timestamp_s.value_or(0)) + " s");
  }
}

void FillFrameResult(const TrackOutcome& outcome, const FrameData& data, const Lanes& lanes, bool features,
                     FrameResult* result) {
  if (outcome.tracked) {
    result->world_from_camera = outcome.camera_from_world.Inverse();
    result->confidence = outcome.confidence;
  }
  for (const PointMatch& match : outcome.used) {
    ++(match.state == PointState::kStatic ? result->static_matches : result->unknown_matches);
  }
  result->rejected_matches = static_cast<int>(outcome.rejected.size());
  if (const std::int64_t labeled = lanes.semantics.newest_labeled(); labeled >= 0) {
    result->semantic_delay_frames = static_cast<int>(static_cast<std::int64_t>(result->frame.value) - labeled);
  }
  const auto map = lanes.backend.CurrentLocalMap();
  if (outcome.tracked) {
    const bool starts_world = !outcome.world.valid() && map != nullptr;  // it is what there is
    result->world = starts_world ? map->world : outcome.world;
    result->epoch = starts_world ? map->epoch : outcome.epoch;
  }
  if (map != nullptr) {
    result->keyframes_in_map = map->keyframes_in_map;
    result->points_in_map = map->points_in_map;
  }
  result->timing.matching_ms = outcome.times.matching_ms;
  result->timing.pose_ms = outcome.times.pose_ms;
  result->timing.local_map_ms = outcome.times.local_map_ms;
  if (features) {
    result->features = ViewFeatures(data, outcome);
  }
}

void FillSlamResult(const Lanes& lanes, SlamResult* result) {
  lanes.backend.Read([&](const Map& map) {
    for (WorldTrajectory& world : result->worlds) {
      for (const KeyframeId id : map.keyframes()) {
        const Keyframe& keyframe = map.At(id);
        if (keyframe.world == world.world) {
          world.keyframes.push_back({keyframe.timestamp_s, keyframe.camera_from_world.Inverse()});
        }
      }
      result->tracked_frames += static_cast<int>(world.frames.size());
    }
  });
  if (!result->worlds.empty()) {
    result->frames = result->worlds.front().frames;
    result->keyframes = result->worlds.front().keyframes;
  }
  result->events = lanes.loops.events();
  result->local_ba_ms = lanes.mapping.local_ba_ms();
  result->labels = lanes.semantics.events();
  result->segmentation_failures = lanes.semantics.failures();
  result->keyframes_left_unlabeled = lanes.waiting.Read([](const Waiting& waiting) {
    return waiting.dropped + waiting.in_flight + static_cast<int>(waiting.backlog.size());
  });
  const LockTimes times = lanes.backend.lock_times();
  result->map_lock_ms = {Summary(times.held), Summary(times.waited), times.waited_by_tracking.max_ms()};
  result->map = lanes.backend.MakeView();
  for (const float p : result->map.moving_probability) {
    switch (StateOf(static_cast<double>(p), lanes.backend.probabilities().options())) {
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
