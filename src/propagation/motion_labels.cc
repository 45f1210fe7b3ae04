// SPDX-License-Identifier: Apache-2.0
#include "propagation/motion_labels.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "propagation/motion_segmentation.h"
#include "segmentation/mask.h"
#include "semantic/keypoint_labels.h"

namespace rds {
namespace {

struct Relabeling {
  KeyframeId keyframe;
  std::shared_ptr<const FrameData> data;
  std::vector<KeypointLabel> labels;  // as they are
  std::vector<KeypointLabel> seeds;   // what the keyframe that was led astray says of the points that both see
};

std::vector<KeypointLabel> SeedsOf(const Map& map, const Keyframe& keyframe, const Keyframe& astray) {
  std::vector<KeypointLabel> seeds(keyframe.points.size(), KeypointLabel::kNone);
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    if (keyframe.points[i].valid()) {
      const std::vector<Observation>& seen = map.At(keyframe.points[i]).observations;
      const auto there = std::ranges::find(seen, astray.id, &Observation::keyframe);
      seeds[i] = there != seen.end() ? astray.labels[there->keypoint] : KeypointLabel::kNone;
    }
  }
  return seeds;
}

std::vector<Relabeling> PlanRelabeling(const Map& map, const LedAstray& astray) {
  std::vector<Relabeling> relabelings;
  const Keyframe* const judged = map.FindByFrame(astray.frame);
  if (judged == nullptr || !judged->IsLabeled()) {
    return relabelings;
  }
  const auto& ids = map.keyframes();
  for (auto id = std::ranges::lower_bound(ids, judged->id); id != ids.begin();) {
    const Keyframe& earlier = map.At(*--id);
    if (earlier.frame <= astray.witness || earlier.world != judged->world) {
      break;
    }
    if (earlier.IsLabeled()) {
      relabelings.push_back({earlier.id, earlier.data, earlier.labels, SeedsOf(map, earlier, *judged)});
    }
  }
  return relabelings;
}

std::vector<KeypointLabel> Solve(const Relabeling& relabeling) {
  const FrameData& data = *relabeling.data;
  Image8 mask(data.camera().width, data.camera().height, 1, kUnsurePixel);
  DrawSurfaces(data, relabeling.seeds, mask);
  std::vector<KeypointLabel> labels = LabelKeypoints(data, mask);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    labels[i] = labels[i] == KeypointLabel::kDynamic ? labels[i] : relabeling.labels[i];
  }
  return labels;
}

// The motion between two keyframes as the map has it; nothing unless both are there, in one world.
std::optional<Rigid3> MotionInMap(const Map& map, FrameId from, FrameId to) {
  const Keyframe* const a = map.FindByFrame(from);
  const Keyframe* const b = map.FindByFrame(to);
  return a != nullptr && b != nullptr && a->world == b->world
             ? std::optional(b->camera_from_world * a->camera_from_world.Inverse())
             : std::nullopt;
}

}  // namespace

std::optional<LedAstray> MarkMoving(const MapAccess& map, const RecentFrames& recent, const RecentFrames::Entry& frame,
                                    const ScalePyramid& pyramid, Image8& mask) {
  const auto witnesses = map.Read([&](const Map& locked) {
    return recent.Witnesses(frame.timestamp_s, [&](FrameId id) { return locked.FindByFrame(id) != nullptr; });
  });
  const std::vector<KeypointLabel> known = LabelKeypoints(*frame.data, mask);
  for (const RecentFrames::Entry& witness : witnesses) {
    const auto expected = map.Read([&](const Map& locked) { return MotionInMap(locked, frame.frame, witness.frame); });
    if (const auto segmented = SegmentByMotion(*frame.data, known, *witness.data, expected, pyramid)) {
      DrawSurfaces(*frame.data, segmented->labels, mask);
      return segmented->contradicts ? std::optional(LedAstray{frame.frame, witness.frame}) : std::nullopt;
    }
  }
  return std::nullopt;
}

void LabelAgain(MapAccess& map, const LedAstray& astray) {
  const auto relabelings = map.Read([&](const Map& locked) { return PlanRelabeling(locked, astray); });
  for (const Relabeling& relabeling : relabelings) {
    std::vector<KeypointLabel> labels = Solve(relabeling);
    map.Write([&](Map& locked) {
      if (locked.Find(relabeling.keyframe) != nullptr) {
        locked.Label(relabeling.keyframe, std::move(labels), true);
      }
    });
  }
}

}  // namespace rds
