// SPDX-License-Identifier: Apache-2.0
// How corrections come into the map.
#include "map/correction.h"

#include <vector>

#include "map/map.h"

namespace rds {
namespace {

template <typename Item, typename Judge>
std::vector<const Item*> Those(const std::vector<Item>& items, Judge&& is_wanted) {
  std::vector<const Item*> wanted;
  for (const Item& item : items) {
    if (is_wanted(item)) {
      wanted.push_back(&item);
    }
  }
  return wanted;
}

}  // namespace

bool Map::IsCurrent(const KeyframeVersion& version) const {
  const Keyframe* const keyframe = Find(version.keyframe);
  return keyframe != nullptr && keyframe->pose_revision == version.revision;
}

Applied Map::Apply(const Correction& correction) {
  Applied applied;
  // What is stale is judged before anything is written.
  const auto poses = Those(correction.poses, [&](const auto& pose) { return IsCurrent(pose.of); });
  const auto points = Those(correction.points, [&](const auto& point) {
    const MapPoint* const now = Find(point.point);
    return now != nullptr && now->revision == point.revision && IsCurrent(point.reference);
  });
  const auto new_points = Those(correction.new_points,
                                [&](const auto& point) { return IsCurrent(point.first) && IsCurrent(point.second); });
  const auto matches = Those(correction.matches, [&](const auto& match) { return IsCurrent(match.in); });

  for (const Correction::Pose* pose : poses) {
    const Keyframe& keyframe = At(pose->of.keyframe);
    const Rigid3 new_world_from_old_world = pose->camera_from_world.Inverse() * keyframe.camera_from_world;
    SetPose(keyframe.id, pose->camera_from_world);
    for (std::size_t i = 0; pose->points_follow && i < keyframe.points.size(); ++i) {
      if (keyframe.points[i].valid() && At(keyframe.points[i]).IsMadeBy(keyframe.id)) {
        Move(keyframe.points[i], new_world_from_old_world * At(keyframe.points[i]).position);
      }
    }
    ++applied.poses;
  }
  for (const Correction::Removal& removal : correction.removals) {
    if (Find(removal.point) != nullptr && Find(removal.keyframe) != nullptr) {
      Forget(removal.point, removal.keyframe);
    }
  }
  for (const Correction::Point* point : points) {
    if (Find(point->point) != nullptr) {  // else it was left without observations just now
      Move(point->point, point->position);
      ++applied.points;
    }
  }
  for (const Correction::NewPoint* point : new_points) {
    const auto is_free = [&](const KeyframeVersion& of, std::uint32_t keypoint) {
      return !At(of.keyframe).points.at(keypoint).valid();
    };
    if (is_free(point->first, point->first_keypoint) && is_free(point->second, point->second_keypoint)) {
      const PointId id = AddPoint(point->position, point->first.keyframe, point->first_keypoint);
      Observe(id, point->second.keyframe, point->second_keypoint);
      UpdateAppearance(id);
      applied.new_points.push_back(id);
    }
  }
  for (const Correction::Match* match : matches) {
    const PointId point = Resolve(match->point);
    const PointId there = At(match->in.keyframe).points.at(match->keypoint);
    if (!point.valid() || point == there) {
      continue;
    }
    if (!there.valid()) {
      Observe(point, match->in.keyframe, match->keypoint);
    } else if (At(there).observations.size() >= At(point).observations.size()) {
      Fuse(point, there);
    } else {
      Fuse(there, point);
    }
  }
  return applied;
}

}  // namespace rds
