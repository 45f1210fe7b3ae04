// SPDX-License-Identifier: Apache-2.0
#include "map/map.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/error.h"

namespace rds {
namespace {

// Where the observation by a keyframe is, or would be.
template <typename Observations>
auto PlaceOf(Observations& observations, KeyframeId keyframe) {
  return std::ranges::lower_bound(observations, keyframe, {}, &Observation::keyframe);
}

bool Sees(const MapPoint& point, KeyframeId keyframe) {
  const auto place = PlaceOf(point.observations, keyframe);
  return place != point.observations.end() && place->keyframe == keyframe;
}

}  // namespace

Map::Map(const ScalePyramid& pyramid, const MovingProbabilityOptions& probability, std::size_t point_pages)
    : pyramid_(pyramid), probabilities_(probability, point_pages), points_(point_pages) {}

const Keyframe* Map::Find(KeyframeId id) const {
  return id.index() < keyframes_.size() ? keyframes_[id.index()].get() : nullptr;
}

const Keyframe* Map::FindByFrame(FrameId frame) const {
  const auto place = std::ranges::lower_bound(keyframe_ids_, frame, {}, [&](KeyframeId id) { return At(id).frame; });
  return place != keyframe_ids_.end() && At(*place).frame == frame ? &At(*place) : nullptr;
}

const Keyframe& Map::At(KeyframeId id) const {
  const Keyframe* keyframe = Find(id);
  Check(keyframe != nullptr, "the keyframe is in the map");
  return *keyframe;
}

const MapPoint& Map::At(PointId id) const {
  const MapPoint* point = Find(id);
  Check(point != nullptr, "the point is in the map");
  return *point;
}

KeyframeId Map::AddKeyframe(FrameId frame, double timestamp_s, const Rigid3& camera_from_world,
                            std::shared_ptr<const FrameData> data, WorldId world) {
  if (!world.valid()) {
    world = worlds_.empty() ? AddWorld() : WorldId{static_cast<std::uint32_t>(worlds_.size() - 1)};
  }
  world = Resolve(world);
  probabilities_.Release(points_.TakeFreedPages());
  auto keyframe = std::make_unique<Keyframe>();
  keyframe->id = KeyframeId{static_cast<std::uint32_t>(keyframes_.size())};
  keyframe->world = world;
  keyframe->frame = frame;
  keyframe->timestamp_s = timestamp_s;
  keyframe->camera_from_world = camera_from_world;
  keyframe->points.assign(data->size(), PointId{});
  keyframe->data = std::move(data);
  World& home = worlds_.at(world.index());
  if (!home.root.valid()) {
    home.root = keyframe->id;
  }
  ++home.keyframes;
  keyframe_ids_.push_back(keyframe->id);
  erased_.emplace_back();
  shared_.push_back(0);
  return keyframes_.emplace_back(std::move(keyframe))->id;
}

void Map::SetPose(KeyframeId id, const Rigid3& camera_from_world) {
  Keyframe& keyframe = Mutable(id);
  keyframe.camera_from_world = camera_from_world;
  ++keyframe.pose_revision;
}

void Map::Label(KeyframeId id, std::vector<KeypointLabel> labels, bool certain) {
  Keyframe& keyframe = Mutable(id);
  Check(labels.size() == keyframe.points.size(), "a label for each keypoint");
  keyframe.labels = std::move(labels);
  keyframe.certain = certain;
  for (const PointId point : keyframe.points) {
    if (point.valid()) {
      Observation& observation = *PlaceOf(Mutable(point).observations, id);
      probabilities_.Retract(point, std::exchange(observation.log_odds, 0.0F));
      CountLabel(keyframe, observation, point);
    }
  }
}

void Map::CountLabel(const Keyframe& keyframe, Observation& observation, PointId point) {
  if (keyframe.IsLabeled() && keyframe.labels[observation.keypoint] != KeypointLabel::kNone) {
    const bool dynamic = keyframe.labels[observation.keypoint] == KeypointLabel::kDynamic;
    for (int times = dynamic && keyframe.certain ? 2 : 1; times > 0; --times) {
      observation.log_odds += probabilities_.Observe(point, dynamic);
    }
  }
}

void Map::KeepEarlyLabels(FrameId frame, std::vector<KeypointLabel> labels) {
  if (keyframe_ids_.empty() || At(newest()).frame < frame) {
    early_labels_[frame] = std::move(labels);
  }
}

std::vector<KeypointLabel> Map::TakeEarlyLabels(FrameId frame) {
  auto found = early_labels_.extract(frame);
  return found ? std::move(found.mapped()) : std::vector<KeypointLabel>{};
}

PointId Map::AddPoint(const Eigen::Vector3d& position, KeyframeId keyframe, std::uint32_t keypoint) {
  auto added = std::make_unique<MapPoint>();
  const PointId id = points_.NextId();
  added->id = id;
  added->position = position;
  added->reference = keyframe;
  added->created_at = newest();
  points_.Add(std::move(added));
  Check(Observe(id, keyframe, keypoint), "a new point takes a free keypoint");
  UpdateAppearance(id);
  return id;
}

bool Map::Observe(PointId id, KeyframeId keyframe_id, std::uint32_t keypoint) {
  MapPoint& point = Mutable(id);
  Keyframe& keyframe = Mutable(keyframe_id);
  if (keyframe.points.at(keypoint).valid() || Sees(point, keyframe_id)) {
    return false;
  }
  Check(WorldOf(point.reference) == keyframe.world, "a keyframe sees points of its own world");
  const auto place = point.observations.insert(PlaceOf(point.observations, keyframe_id), {keyframe_id, keypoint, 0});
  keyframe.points[keypoint] = id;
  CountLabel(keyframe, *place, id);
  return true;
}

void Map::Forget(PointId id, KeyframeId keyframe) {
  MapPoint& point = Mutable(id);
  const auto place = PlaceOf(point.observations, keyframe);
  if (place != point.observations.end() && place->keyframe == keyframe) {
    probabilities_.Retract(id, place->log_odds);
    Unlink(point, keyframe);
  }
}

void Map::Unlink(MapPoint& point, KeyframeId keyframe) {
  const auto place = PlaceOf(point.observations, keyframe);
  Mutable(keyframe).points[place->keypoint] = PointId{};
  point.observations.erase(place);
  if (point.observations.empty()) {
    ErasePoint(point.id);
  } else if (point.reference == keyframe) {
    point.reference = point.observations.front().keyframe;
  }
}

void Map::Move(PointId id, const Eigen::Vector3d& position) {
  MapPoint& point = Mutable(id);
  point.position = position;
  ++point.revision;
  UpdateNormal(point);
}

void Map::ErasePoint(PointId id) {
  for (const Observation& observation : At(id).observations) {
    Mutable(observation.keyframe).points[observation.keypoint] = PointId{};
  }
  points_.Erase(id);
}

void Map::Fuse(PointId from_id, PointId to_id) {
  Check(from_id != to_id, "a point is not fused with itself");
  const MapPoint& from = At(from_id);
  MapPoint& to = Mutable(to_id);
  Check(WorldOf(from.reference) == WorldOf(to.reference), "only points of one world are fused");
  for (const Observation& observation : from.observations) {
    if (Sees(to, observation.keyframe)) {  // one mask speaks of a point once
      probabilities_.Retract(from_id, observation.log_odds);
    }
  }
  probabilities_.Set(
      to_id, FuseProbabilities(probabilities_.Get(from_id), probabilities_.Get(to_id), probabilities_.options()));
  to.visible += from.visible;
  to.found += from.found;
  const std::vector<Observation> observations = from.observations;
  ErasePoint(from_id);
  for (const Observation& observation : observations) {
    if (!Sees(to, observation.keyframe)) {
      to.observations.insert(PlaceOf(to.observations, observation.keyframe), observation);
      Mutable(observation.keyframe).points[observation.keypoint] = to_id;
    }
  }
  replaced_by_[from_id] = to_id;
  fused_.push_back(from_id);
  if (fused_.size() > kRemembered) {
    replaced_by_.erase(fused_.front());
    fused_.pop_front();
  }
  UpdateAppearance(to_id);
}

PointId Map::Resolve(PointId id) const {
  while (id.valid() && points_.Find(id) == nullptr) {
    const auto next = replaced_by_.find(id);
    id = next != replaced_by_.end() ? next->second : PointId{};
  }
  return id;
}

std::vector<std::pair<PointId, PointId>> Map::RecentReplacements() const {
  std::vector<std::pair<PointId, PointId>> replacements;
  for (std::size_t i = fused_.size() - std::min(fused_.size(), kRecent); i < fused_.size(); ++i) {
    if (const PointId now = Resolve(fused_[i]); now.valid()) {
      replacements.emplace_back(fused_[i], now);
    }
  }
  std::ranges::sort(replacements);
  return replacements;
}

void Map::CountUse(PointId id, int visible, int found) {
  MapPoint& point = Mutable(id);
  point.visible += visible;
  point.found += found;
}

void Map::UpdateAppearance(PointId id) {
  MapPoint& point = Mutable(id);
  std::vector<const Descriptor*> descriptors;
  for (const Observation& observation : point.observations) {
    descriptors.push_back(&At(observation.keyframe).data->descriptors()[observation.keypoint]);
  }
  // The descriptor with the least median distance to all others; a cap keeps this cheap for long-lived points.
  constexpr std::size_t kMost = 16;
  if (descriptors.size() > kMost) {
    descriptors.erase(descriptors.begin(), descriptors.end() - static_cast<std::ptrdiff_t>(kMost));
  }
  int best_median = 257;
  for (const Descriptor* candidate : descriptors) {
    std::array<int, kMost> distances{};
    for (std::size_t i = 0; i < descriptors.size(); ++i) {
      distances[i] = HammingDistance(*candidate, *descriptors[i]);
    }
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>((descriptors.size() - 1) / 2);
    std::nth_element(distances.begin(), middle, distances.begin() + static_cast<std::ptrdiff_t>(descriptors.size()));
    if (*middle < best_median) {
      best_median = *middle;
      point.descriptor = *candidate;
    }
  }
  UpdateNormal(point);
}

void Map::UpdateNormal(MapPoint& point) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Observation& observation : point.observations) {
    sum += (point.position - At(observation.keyframe).CameraCenter()).normalized();
  }
  point.normal = sum.normalized();
  const Keyframe& reference = At(point.reference);
  const auto octave = reference.data->keypoints()[PlaceOf(point.observations, reference.id)->keypoint].octave;
  const auto distance = static_cast<float>((point.position - reference.CameraCenter()).norm());
  point.max_distance_m = distance * pyramid_.scale[octave];
  point.min_distance_m = point.max_distance_m / pyramid_.scale.back();
}

}  // namespace rds
