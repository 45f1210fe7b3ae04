// SPDX-License-Identifier: Apache-2.0
#include "map/map.h"

#include <algorithm>
#include <utility>

#include "base/error.h"

namespace rds {
namespace {

auto ObservationOf(MapPoint& point, KeyframeId keyframe) {
  return std::lower_bound(point.observations.begin(), point.observations.end(), keyframe,
                          [](const Observation& s, KeyframeId id) { return s.keyframe < id; });
}

}  // namespace

const Keyframe* Map::Find(KeyframeId id) const {
  return id.index() < keyframes_.size() ? keyframes_[id.index()].get() : nullptr;
}
Keyframe* Map::Find(KeyframeId id) { return const_cast<Keyframe*>(std::as_const(*this).Find(id)); }

const MapPoint* Map::Find(PointId id) const { return points_.Find(id); }
MapPoint* Map::Find(PointId id) { return const_cast<MapPoint*>(std::as_const(*this).Find(id)); }

const Keyframe& Map::At(KeyframeId id) const {
  const Keyframe* keyframe = Find(id);
  Check(keyframe != nullptr, "the keyframe is in the map");
  return *keyframe;
}
Keyframe& Map::At(KeyframeId id) { return const_cast<Keyframe&>(std::as_const(*this).At(id)); }

const MapPoint& Map::At(PointId id) const {
  const MapPoint* point = Find(id);
  Check(point != nullptr, "the point is in the map");
  return *point;
}
MapPoint& Map::At(PointId id) { return const_cast<MapPoint&>(std::as_const(*this).At(id)); }

Keyframe& Map::AddKeyframe(FrameId frame, double timestamp_s, const Rigid3& camera_from_world,
                           std::shared_ptr<const FrameData> data) {
  auto keyframe = std::make_unique<Keyframe>();
  keyframe->id = KeyframeId{static_cast<std::uint32_t>(keyframes_.size())};
  keyframe->frame = frame;
  keyframe->timestamp_s = timestamp_s;
  keyframe->camera_from_world = camera_from_world;
  keyframe->points.assign(data->size(), PointId{});
  keyframe->data = std::move(data);
  keyframe_ids_.push_back(keyframe->id);
  erased_.emplace_back();
  return *keyframes_.emplace_back(std::move(keyframe));
}

MapPoint& Map::AddPoint(const Eigen::Vector3d& position, KeyframeId keyframe, std::uint32_t keypoint) {
  auto added = std::make_unique<MapPoint>();
  added->id = points_.NextId();
  added->position = position;
  added->reference = keyframe;
  added->created_at = newest();
  MapPoint& point = points_.Add(std::move(added));
  Check(AddObservation(point.id, keyframe, keypoint), "a new point takes a free keypoint");
  UpdateAppearance(point.id);
  return point;
}

bool Map::AddObservation(PointId id, KeyframeId keyframe_id, std::uint32_t keypoint) {
  MapPoint& point = At(id);
  Keyframe& keyframe = At(keyframe_id);
  const auto place = ObservationOf(point, keyframe_id);
  if (keyframe.points.at(keypoint).valid() || (place != point.observations.end() && place->keyframe == keyframe_id)) {
    return false;
  }
  point.observations.insert(place, {keyframe_id, keypoint});
  keyframe.points[keypoint] = id;
  return true;
}

void Map::RemoveObservation(PointId id, KeyframeId keyframe_id) {
  MapPoint& point = At(id);
  const auto place = ObservationOf(point, keyframe_id);
  if (place == point.observations.end() || place->keyframe != keyframe_id) {
    return;
  }
  At(keyframe_id).points[place->keypoint] = PointId{};
  point.observations.erase(place);
  if (point.observations.empty()) {
    ErasePoint(id);
  } else if (point.reference == keyframe_id) {
    point.reference = point.observations.front().keyframe;
  }
}

void Map::ErasePoint(PointId id) {
  for (const Observation& observation : At(id).observations) {
    At(observation.keyframe).points[observation.keypoint] = PointId{};
  }
  points_.Erase(id);
}

void Map::Fuse(PointId from_id, PointId to_id) {
  Check(from_id != to_id, "a point is not fused with itself");
  MapPoint& from = At(from_id);
  MapPoint& to = At(to_id);
  to.visible += from.visible;
  to.found += from.found;
  const std::vector<Observation> observations = from.observations;
  ErasePoint(from_id);
  for (const Observation& observation : observations) {
    AddObservation(to_id, observation.keyframe, observation.keypoint);
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

void Map::UpdateAppearance(PointId id) {
  MapPoint& point = At(id);
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
  UpdateNormal(id);
}

void Map::UpdateNormal(PointId id) {
  MapPoint& point = At(id);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Observation& observation : point.observations) {
    sum += (point.position - At(observation.keyframe).CameraCenter()).normalized();
  }
  point.normal = sum.normalized();
  const Keyframe& reference = At(point.reference);
  const auto host = std::lower_bound(point.observations.begin(), point.observations.end(), point.reference,
                                     [](const Observation& s, KeyframeId k) { return s.keyframe < k; });
  const auto octave = reference.data->keypoints()[host->keypoint].octave;
  const auto distance = static_cast<float>((point.position - reference.CameraCenter()).norm());
  point.max_distance_m = distance * pyramid_.scale[octave];
  point.min_distance_m = point.max_distance_m / pyramid_.scale.back();
}

void Map::SetPose(KeyframeId id, const Rigid3& camera_from_world) {
  Keyframe& keyframe = At(id);
  keyframe.camera_from_world = camera_from_world;
  ++keyframe.pose_revision;
}

}  // namespace rds
