// SPDX-License-Identifier: Apache-2.0
// The map: keyframes, points, covisibility graph and spanning tree.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "map/id_table.h"
#include "map/keyframe.h"
#include "map/map_point.h"

namespace rds {

// Containers by id with the operations that keep both sides of every link true. Not thread-safe: it lives behind
// Guarded<Map>. Every loop over it runs in order of ids, so that the same input gives the same map.
class Map {
 public:
  // `point_pages`: see IdTable; smaller in tests.
  explicit Map(const ScalePyramid& pyramid, std::size_t point_pages = kIdPages)
      : pyramid_(pyramid), points_(point_pages) {}

  [[nodiscard]] const ScalePyramid& pyramid() const { return pyramid_; }

  // Null if there is no such keyframe or point (any more).
  [[nodiscard]] Keyframe* Find(KeyframeId id);
  [[nodiscard]] const Keyframe* Find(KeyframeId id) const;
  [[nodiscard]] MapPoint* Find(PointId id);
  [[nodiscard]] const MapPoint* Find(PointId id) const;
  // Throw InvariantError where Find would return null.
  [[nodiscard]] Keyframe& At(KeyframeId id);
  [[nodiscard]] const Keyframe& At(KeyframeId id) const;
  [[nodiscard]] MapPoint& At(PointId id);
  [[nodiscard]] const MapPoint& At(PointId id) const;

  // The living ones, ascending.
  [[nodiscard]] const std::vector<KeyframeId>& keyframes() const { return keyframe_ids_; }
  [[nodiscard]] std::vector<PointId> Points() const { return points_.Ids(); }
  [[nodiscard]] std::size_t point_count() const { return points_.size(); }
  [[nodiscard]] KeyframeId newest() const { return keyframe_ids_.empty() ? KeyframeId{} : keyframe_ids_.back(); }

  // Adds a keyframe without points and edges; id given here.
  Keyframe& AddKeyframe(FrameId frame, double timestamp_s, const Rigid3& camera_from_world,
                        std::shared_ptr<const FrameData> data);
  // Adds a point seen first by keypoint `keypoint` of `keyframe`.
  MapPoint& AddPoint(const Eigen::Vector3d& position, KeyframeId keyframe, std::uint32_t keypoint);

  // Links both sides. False (and nothing done) if the keypoint has a point or the keyframe sees the point already.
  bool AddObservation(PointId point, KeyframeId keyframe, std::uint32_t keypoint);
  // Unlinks both sides; a point left without observations is erased.
  void RemoveObservation(PointId point, KeyframeId keyframe);
  void ErasePoint(PointId point);
  // Moves the observations of `from` to `to` where `to` is not seen yet, and erases `from`, of which ReplacedBy then
  // tells.
  void Fuse(PointId from, PointId to);
  // The living point that took the place of an id, following fusions: the id itself if it lives, invalid if it is gone.
  // Fusions are remembered for the newest kRemembered; who asks holds an id for a few keyframes at most.
  [[nodiscard]] PointId Resolve(PointId id) const;
  // The latest fusions (at most kRecent) as (from, what it is now), ascending by `from`.
  [[nodiscard]] std::vector<std::pair<PointId, PointId>> RecentReplacements() const;

  // Recomputes descriptor, normal and distance range of a point from its observations.
  void UpdateAppearance(PointId point);
  // Recomputes normal and distance range only (after a move).
  void UpdateNormal(PointId point);
  // Recomputes the covisibility edges of a keyframe (edges from kMinShared points on, else the single best one) and
  // gives it a parent if it has none.
  void UpdateCovisibility(KeyframeId keyframe);
  // The `count` keyframes with most shared points, best first.
  [[nodiscard]] std::vector<KeyframeId> BestCovisible(KeyframeId keyframe, std::size_t count) const;

  void SetPose(KeyframeId keyframe, const Rigid3& camera_from_world);

  // Erases a keyframe (never the root): its children go to the most covisible candidate parent, and frames that hang
  // on it hang on its parent from now on.
  void EraseKeyframe(KeyframeId keyframe);

  // Pose of a keyframe, of an erased one too (through its parent). Throws InvariantError for an id never given.
  [[nodiscard]] Rigid3 CameraFromWorld(KeyframeId id) const;

  static constexpr int kMinShared = 15;
  static constexpr std::size_t kRecent = 2000;
  static constexpr std::size_t kRemembered = 50'000;

  // Pages of point ids that have died since the last call; see IdTable.
  [[nodiscard]] std::vector<std::uint32_t> TakeFreedPointPages() { return points_.TakeFreedPages(); }

 private:
  struct Erased {  // what remains of an erased keyframe
    KeyframeId parent;
    Rigid3 self_from_parent;
  };

  void SetEdge(Keyframe& keyframe, KeyframeId other, int shared_points);
  void RemoveEdge(Keyframe& keyframe, KeyframeId other);
  void AdoptChildren(Keyframe& erased);

  ScalePyramid pyramid_;
  std::vector<std::unique_ptr<Keyframe>> keyframes_;  // by id; null = erased
  std::vector<std::optional<Erased>> erased_;         // by id
  std::vector<KeyframeId> keyframe_ids_;
  IdTable<PointId, MapPoint> points_;
  std::unordered_map<PointId, PointId> replaced_by_;  // of those in fused_
  std::deque<PointId> fused_;                         // the newest kRemembered
};

}  // namespace rds
