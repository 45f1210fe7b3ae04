// SPDX-License-Identifier: Apache-2.0
#include "map/local_map.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <numeric>
#include <unordered_map>
#include <unordered_set>

#include "base/error.h"

namespace rds {
namespace {

constexpr std::size_t kRecentKeyframes = 64;

// Ids around `center`, ascending.
std::vector<KeyframeId> SelectKeyframes(const Map& map, KeyframeId center, const LocalMapOptions& options) {
  const auto most = static_cast<std::size_t>(options.keyframes);
  std::vector<KeyframeId> chosen = {center};
  std::unordered_set<KeyframeId> taken = {center};
  const auto take = [&](KeyframeId id) {
    if (id.valid() && chosen.size() < most && taken.insert(id).second) {
      chosen.push_back(id);
    }
  };
  for (const Covisible& edge : map.At(center).covisible) {
    take(edge.keyframe);
  }
  const std::size_t direct = chosen.size();
  for (std::size_t i = 0; i < direct && chosen.size() < most; ++i) {
    const Keyframe& keyframe = map.At(chosen[i]);
    for (const KeyframeId neighbor : map.BestCovisible(keyframe.id, static_cast<std::size_t>(options.neighbors))) {
      take(neighbor);
    }
    take(keyframe.parent);
    for (const KeyframeId child : keyframe.children) {
      take(child);
    }
  }
  std::ranges::sort(chosen);
  return chosen;
}

// The points of some keyframes, and where each is among them in ascending order: a bit for each id, by pages.
class PointSet {
 public:
  PointSet(const Map& map, std::span<const KeyframeId> keyframes) {
    for (const KeyframeId keyframe : keyframes) {
      for (const PointId point : map.At(keyframe).points) {
        if (point.valid()) {
          pages_[point.index() / kIdsPerPage].ids.set(point.index() % kIdsPerPage);
        }
      }
    }
    std::vector<std::size_t> numbers;
    for (const auto& [number, page] : pages_) {
      numbers.push_back(number);
    }
    std::ranges::sort(numbers);
    for (const std::size_t number : numbers) {
      Page& page = pages_[number];
      for (std::size_t i = 0; i < kIdsPerPage; ++i) {
        page.place[i] = static_cast<std::uint32_t>(ids_.size());
        if (page.ids[i]) {
          ids_.emplace_back(static_cast<std::uint32_t>(number * kIdsPerPage + i));
        }
      }
    }
  }

  // Ascending.
  [[nodiscard]] const std::vector<PointId>& Ids() const { return ids_; }
  // The point must be one of them.
  [[nodiscard]] std::uint32_t IndexOf(PointId point) const {
    return pages_.at(point.index() / kIdsPerPage).place[point.index() % kIdsPerPage];
  }

 private:
  struct Page {
    std::bitset<kIdsPerPage> ids;
    std::array<std::uint32_t, kIdsPerPage> place;  // of the first point that is not below each id
  };
  std::unordered_map<std::size_t, Page> pages_;
  std::vector<PointId> ids_;
};

void AppendPoint(const MapPoint& point, LocalMap* local) {
  local->ids.push_back(point.id);
  local->x.push_back(static_cast<float>(point.position.x()));
  local->y.push_back(static_cast<float>(point.position.y()));
  local->z.push_back(static_cast<float>(point.position.z()));
  local->normal_x.push_back(static_cast<float>(point.normal.x()));
  local->normal_y.push_back(static_cast<float>(point.normal.y()));
  local->normal_z.push_back(static_cast<float>(point.normal.z()));
  local->min_distance_m.push_back(point.min_distance_m);
  local->max_distance_m.push_back(point.max_distance_m);
  local->descriptors.push_back(point.descriptor);
  local->observations.push_back(static_cast<std::uint8_t>(std::min<std::size_t>(point.observations.size(), 255)));
}

}  // namespace

std::shared_ptr<const LocalMap> BuildLocalMap(const Map& map, KeyframeId center, const LocalMapOptions& options) {
  auto local = std::make_shared<LocalMap>();
  const std::vector<KeyframeId> chosen = SelectKeyframes(map, center, options);
  const PointSet points(map, chosen);
  const std::vector<PointId>& ids = points.Ids();
  const std::size_t enough_observations = map.keyframes().size() <= 2 ? 1 : 2;
  for (const PointId id : ids) {
    const MapPoint& point = map.At(id);
    AppendPoint(point, local.get());
    local->confirmed.push_back(point.observations.size() >= enough_observations ? 1 : 0);
  }
  for (const KeyframeId id : chosen) {
    const Keyframe& keyframe = map.At(id);
    LocalKeyframe copy{id, keyframe.frame, keyframe.camera_from_world, keyframe.data, {}};
    for (std::size_t i = 0; i < keyframe.points.size(); ++i) {
      if (keyframe.points[i].valid()) {
        copy.links.push_back({static_cast<std::uint32_t>(i), points.IndexOf(keyframe.points[i])});
      }
    }
    local->keyframes.push_back(std::move(copy));
  }
  local->CollectViews();
  local->replaced = map.RecentReplacements();
  local->world = map.At(center).world;
  local->epoch = map.epoch();
  const std::vector<KeyframeId>& all = map.keyframes();
  for (std::size_t i = all.size() - std::min(all.size(), kRecentKeyframes); i < all.size(); ++i) {
    if (map.At(all[i]).world == local->world) {
      local->recent.emplace_back(all[i], map.At(all[i]).camera_from_world);
    }
  }
  local->keyframes_in_map = static_cast<int>(map.keyframes().size());
  local->points_in_map = static_cast<int>(map.point_count());
  return local;
}

std::optional<std::uint32_t> LocalMap::IndexOf(PointId id) const {
  const auto place = std::ranges::lower_bound(ids, id);
  if (place != ids.end() && *place == id) {
    return static_cast<std::uint32_t>(place - ids.begin());
  }
  const auto substitute = std::ranges::lower_bound(replaced, id, {}, &std::pair<PointId, PointId>::first);
  if (substitute != replaced.end() && substitute->first == id) {
    return IndexOf(substitute->second);
  }
  return std::nullopt;
}

const LocalKeyframe& LocalMap::MostShared(std::span<const std::uint32_t> points) const {
  std::vector<int> shared(keyframes.size(), 0);
  for (const std::uint32_t point : points) {
    for (std::uint32_t i = first_view[point]; i < first_view[point + 1]; ++i) {
      ++shared[views[i]];
    }
  }
  const auto most = std::ranges::max_element(shared.rbegin(), shared.rend());
  return keyframes[static_cast<std::size_t>(shared.rend() - most) - 1];
}

std::optional<Rigid3> LocalMap::CameraFromWorld(KeyframeId id) const {
  if (const LocalKeyframe* const keyframe = Find(id)) {
    return keyframe->camera_from_world;
  }
  const auto place = std::ranges::lower_bound(recent, id, {}, &std::pair<KeyframeId, Rigid3>::first);
  return place != recent.end() && place->first == id ? std::optional(place->second) : std::nullopt;
}

void LocalMap::CollectViews() {
  first_view.assign(size() + 1, 0);
  for (const LocalKeyframe& keyframe : keyframes) {
    for (const LocalKeyframe::Link& link : keyframe.links) {
      ++first_view[link.point + 1];
    }
  }
  std::partial_sum(first_view.begin(), first_view.end(), first_view.begin());
  views.resize(first_view.back());
  std::vector<std::uint32_t> next(first_view.begin(), first_view.end() - 1);
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    for (const LocalKeyframe::Link& link : keyframes[k].links) {
      views[next[link.point]++] = static_cast<std::uint16_t>(k);
    }
  }
}

const LocalKeyframe* LocalMap::FindByFrame(FrameId frame) const {
  const auto place = std::ranges::lower_bound(keyframes, frame, {}, &LocalKeyframe::frame);
  return place != keyframes.end() && place->frame == frame ? &*place : nullptr;
}

const LocalKeyframe* LocalMap::Find(KeyframeId id) const {
  const auto place = std::ranges::lower_bound(keyframes, id, {}, &LocalKeyframe::id);
  return place != keyframes.end() && place->id == id ? &*place : nullptr;
}

}  // namespace rds
