// SPDX-License-Identifier: Apache-2.0
// The part of the map that tracking reads: an immutable snapshot.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "map/map.h"
#include "map/map_options.h"

namespace rds {

// A keyframe as tracking sees it.
struct LocalKeyframe {
  struct Link {
    std::uint32_t keypoint = 0;
    std::uint32_t point = 0;  // index into LocalMap's point arrays
  };
  KeyframeId id;
  FrameId frame;
  Rigid3 camera_from_world;
  std::shared_ptr<const FrameData> data;
  std::vector<Link> links;  // ascending by keypoint
};

// Points around the newest keyframe as structure of arrays, ascending by id, and the keyframes that see them. World
// frame, meters. Never changed after BuildLocalMap: any thread may read it.
struct LocalMap {
  std::vector<PointId> ids;
  std::vector<float> x, y, z;                       // position
  std::vector<float> normal_x, normal_y, normal_z;  // mean viewing direction, unit
  std::vector<float> min_distance_m, max_distance_m;
  std::vector<Descriptor> descriptors;
  std::vector<std::uint8_t> observations;  // keyframes that see it, 255 at most
  std::vector<std::uint8_t> confirmed;     // 1 = seen by enough keyframes to count as tracked (keyframe policy)
  std::vector<LocalKeyframe> keyframes;    // ascending by id
  // Keyframes (index) that see point i: views[first_view[i]] up to views[first_view[i + 1]], ascending.
  std::vector<std::uint32_t> first_view;
  std::vector<std::uint16_t> views;
  std::vector<std::pair<PointId, PointId>> replaced;  // recently fused ids and what they became, ascending
  WorldId world;                                      // of all of it
  std::uint32_t epoch = 0;                            // Map::epoch
  std::vector<std::pair<KeyframeId, Rigid3>>
      recent;  // camera_from_world of the newest keyframes of the world, ascending
  int keyframes_in_map = 0;
  int points_in_map = 0;

  [[nodiscard]] std::size_t size() const { return ids.size(); }
  [[nodiscard]] Eigen::Vector3d Position(std::size_t i) const {
    return {static_cast<double>(x[i]), static_cast<double>(y[i]), static_cast<double>(z[i])};
  }
  // Index of a point, fusions followed; nothing if it is not in this snapshot.
  [[nodiscard]] std::optional<std::uint32_t> IndexOf(PointId id) const;
  // The keyframe that sees most of these points (indices), the newest of equals.
  [[nodiscard]] const LocalKeyframe& MostShared(std::span<const std::uint32_t> points) const;
  // Null if it is not in this snapshot.
  [[nodiscard]] const LocalKeyframe* Find(KeyframeId id) const;
  [[nodiscard]] const LocalKeyframe* FindByFrame(FrameId frame) const;
  // Of a keyframe in this snapshot, or of a recent one.
  [[nodiscard]] std::optional<Rigid3> CameraFromWorld(KeyframeId id) const;
  // Fills the views from the keyframes' links; part of making a snapshot.
  void CollectViews();
};

// Copies the surroundings of `center`: itself, its covisible keyframes, their best neighbors, parents and children,
// and all their points. The map must hold `center`.
[[nodiscard]] std::shared_ptr<const LocalMap> BuildLocalMap(const Map& map, KeyframeId center,
                                                            const LocalMapOptions& options);

}  // namespace rds
