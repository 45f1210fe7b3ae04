// SPDX-License-Identifier: Apache-2.0
// The map: keyframes, points, labels, moving probabilities, covisibility graph and spanning trees.
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "map/correction.h"
#include "map/id_table.h"
#include "map/keyframe.h"
#include "map/map_point.h"
#include "map/moving_probability.h"

namespace rds {

// One database of everything that was mapped, by ids that never change. A keyframe belongs to a world: a connected
// piece with an origin and a root keyframe of its own; a point belongs to the world of the keyframes that see it.
// Outside it is const; it changes by the named operations below, which keep both sides of every link true and count
// each label once, and by Apply. Validate says what is wrong. Not thread-safe, but for probabilities(), which any
// thread may read at any time; the system keeps it behind a lock. Every loop over it runs in order of ids, so that the
// same input gives the same map.
class Map {
 public:
  // `point_pages`: see IdTable; smaller in tests.
  explicit Map(const ScalePyramid& pyramid, const MovingProbabilityOptions& probability = {},
               std::size_t point_pages = kIdPages);

  // ---- What is there.
  [[nodiscard]] const ScalePyramid& pyramid() const { return pyramid_; }
  [[nodiscard]] const MovingProbabilities& probabilities() const { return probabilities_; }
  // Null if there is no such keyframe or point (any more).
  [[nodiscard]] const Keyframe* Find(KeyframeId id) const;
  [[nodiscard]] const MapPoint* Find(PointId id) const { return points_.Find(id); }
  // The keyframe made from a frame; null if there is none (any more, or yet).
  [[nodiscard]] const Keyframe* FindByFrame(FrameId frame) const;
  // Throw InvariantError where Find would return null.
  [[nodiscard]] const Keyframe& At(KeyframeId id) const;
  [[nodiscard]] const MapPoint& At(PointId id) const;
  // The living ones, ascending.
  [[nodiscard]] const std::vector<KeyframeId>& keyframes() const { return keyframe_ids_; }
  [[nodiscard]] std::vector<PointId> Points() const { return points_.Ids(); }
  [[nodiscard]] std::size_t point_count() const { return points_.size(); }
  [[nodiscard]] KeyframeId newest() const { return keyframe_ids_.empty() ? KeyframeId{} : keyframe_ids_.back(); }
  // Pose of a keyframe in its world, of an erased one too (through its parent). Throws InvariantError for an id never
  // given.
  [[nodiscard]] Rigid3 CameraFromWorld(KeyframeId id) const;
  // The `count` keyframes with most shared points, best first.
  [[nodiscard]] std::vector<KeyframeId> BestCovisible(KeyframeId keyframe, std::size_t count) const;
  // What keyframes see, ascending, each once.
  [[nodiscard]] std::vector<PointId> PointsOf(std::span<const KeyframeId> keyframes) const;
  // The living point that took the place of an id, following fusions: the id itself if it lives, invalid if it is gone.
  // Fusions are remembered for the newest kRemembered; who asks holds an id for a few keyframes at most.
  [[nodiscard]] PointId Resolve(PointId id) const;
  // The latest fusions (at most kRecent) as (from, what it is now), ascending by `from`.
  [[nodiscard]] std::vector<std::pair<PointId, PointId>> RecentReplacements() const;

  // ---- Worlds.
  // A new, empty world; keyframes are added to it from now on unless told otherwise.
  WorldId AddWorld();
  // World of a keyframe, of an erased one too.
  [[nodiscard]] WorldId WorldOf(KeyframeId id) const;
  // The keyframe that holds a world in place, its oldest one; invalid while the world is empty or once it is merged.
  [[nodiscard]] KeyframeId Root(WorldId world) const { return worlds_.at(world.index()).root; }
  [[nodiscard]] bool IsRoot(KeyframeId keyframe) const { return Root(WorldOf(keyframe)) == keyframe; }
  [[nodiscard]] std::size_t KeyframesIn(WorldId world) const { return worlds_.at(world.index()).keyframes; }
  // What a world has become: itself, or what it was merged into.
  [[nodiscard]] WorldId Resolve(WorldId world) const;
  // Joins the world of `child` into that of `parent`: its keyframes and points are moved by `parent_from_child`, the
  // transform between the frames of the two worlds, and its tree hangs on `parent` by `child` from now on. Ids stay.
  // Throws InvariantError if both are of one world.
  void Merge(KeyframeId child, KeyframeId parent, const Rigid3& parent_from_child);

  // Bends a world: each keyframe moves as a rigid body, with the points that it hosts, by its
  // `new_world_from_old_world`; keyframes that are not named (added since, say) follow their
  // parents. What the moves were computed from may have changed since: they are relative. Erased keyframes follow.
  struct WorldMove {
    KeyframeId keyframe;
    Rigid3 new_world_from_old_world;
  };
  void Bend(std::span<const WorldMove> moves);
  // Grows whenever many poses change at once (Merge, Bend): poses in a world's frame that were copied out before are
  // not to be mixed with later ones.
  [[nodiscard]] std::uint32_t epoch() const { return epoch_; }

  // ---- Keyframes.
  // Adds a keyframe without points and edges to a world, or what that was merged into; none named: the newest one.
  // UpdateCovisibility must follow once its points are there.
  KeyframeId AddKeyframe(FrameId frame, double timestamp_s, const Rigid3& camera_from_world,
                         std::shared_ptr<const FrameData> data, WorldId world = {});
  void SetPose(KeyframeId keyframe, const Rigid3& camera_from_world);
  // Recomputes the covisibility edges of a keyframe (edges from kMinShared points on, else the single best one) and
  // gives it a parent if it has none.
  void UpdateCovisibility(KeyframeId keyframe);
  // Stores the labels of a keyframe's keypoints and takes one Bayes step for each point that it sees, two for a dynamic
  // one where they are `certain`; steps by an earlier label of the keyframe are taken back. Throws InvariantError if
  // there is not one label for each keypoint.
  void Label(KeyframeId keyframe, std::vector<KeypointLabel> labels, bool certain = false);
  // Keeps labels of a frame whose keyframe is still to come; they are dropped if it cannot come any more.
  void KeepEarlyLabels(FrameId frame, std::vector<KeypointLabel> labels);
  [[nodiscard]] std::vector<KeypointLabel> TakeEarlyLabels(FrameId frame);
  // Erases a keyframe (never a root): its children go to the most covisible candidate parent, and frames that hang
  // on it hang on its parent from now on. What its labels said of points stays known.
  void EraseKeyframe(KeyframeId keyframe);

  // ---- Points.
  // Adds a point seen first by keypoint `keypoint` of `keyframe`, which must be free.
  PointId AddPoint(const Eigen::Vector3d& position, KeyframeId keyframe, std::uint32_t keypoint);
  // Links both sides; the label of the keypoint, if there is one, counts for the point. False (and nothing done) if the
  // keypoint has a point or the keyframe sees the point already.
  bool Observe(PointId point, KeyframeId keyframe, std::uint32_t keypoint);
  // Unlinks both sides and takes back what the keypoint's label said of the point, which was a mistake; a point left
  // without observations is erased.
  void Forget(PointId point, KeyframeId keyframe);
  // Moves the observations of `from` to `to` where `to` is not seen yet, joins what is known of both, and erases
  // `from`, whose id Resolve follows from now on.
  void Fuse(PointId from, PointId to);
  void Move(PointId point, const Eigen::Vector3d& position);
  void ErasePoint(PointId point);
  // Replaces what is known of a point's motion.
  void SetMovingProbability(PointId point, double probability) { probabilities_.Set(At(point).id, probability); }
  // Adds to the counts of frames that had the point in view and that matched it.
  void CountUse(PointId point, int visible, int found);
  // Recomputes descriptor, normal and distance range of a point from its observations.
  void UpdateAppearance(PointId point);

  // ---- Corrections.
  // The only rule of staleness: a pose is left alone that was changed since the correction was computed, or whose
  // keyframe is gone; so is a point that was moved since, or whose reference keyframe was; new points and matches of a
  // keyframe that was moved since are left out.
  Applied Apply(const Correction& correction);

  // What is wrong, in words; empty if every invariant holds. Walks over everything; for tests.
  [[nodiscard]] std::vector<std::string> Validate() const;

  static constexpr int kMinShared = 15;
  static constexpr std::size_t kRecent = 2000;
  static constexpr std::size_t kRemembered = 50'000;

 private:
  struct World {
    KeyframeId root;
    std::size_t keyframes = 0;
    WorldId merged_into;  // invalid while it is a world of its own
  };
  struct Erased {  // what remains of an erased keyframe
    KeyframeId parent;
    Rigid3 self_from_parent;
  };

  [[nodiscard]] Keyframe& Mutable(KeyframeId id) { return const_cast<Keyframe&>(std::as_const(*this).At(id)); }
  [[nodiscard]] MapPoint& Mutable(PointId id) { return const_cast<MapPoint&>(std::as_const(*this).At(id)); }
  // The living keyframe that an id hangs on: itself, or an ancestor.
  [[nodiscard]] KeyframeId LivingAncestor(KeyframeId id) const;
  [[nodiscard]] bool IsCurrent(const KeyframeVersion& version) const;
  // The step that a keyframe's label of a keypoint makes, if there is one.
  void CountLabel(const Keyframe& keyframe, Observation& observation, PointId point);
  void Unlink(MapPoint& point, KeyframeId keyframe);
  void UpdateNormal(MapPoint& point);
  void SetEdge(Keyframe& keyframe, KeyframeId other, int shared_points);
  void RemoveEdge(Keyframe& keyframe, KeyframeId other);
  void AdoptChildren(Keyframe& erased);
  void MakeRoot(KeyframeId keyframe);

  ScalePyramid pyramid_;
  MovingProbabilities probabilities_;
  std::uint32_t epoch_ = 0;
  std::vector<World> worlds_;                         // by id
  std::vector<std::unique_ptr<Keyframe>> keyframes_;  // by id; null = erased
  std::vector<std::optional<Erased>> erased_;         // by id
  std::vector<KeyframeId> keyframe_ids_;
  std::map<FrameId, std::vector<KeypointLabel>> early_labels_;
  IdTable<PointId, MapPoint> points_;
  std::unordered_map<PointId, PointId> replaced_by_;  // of those in fused_
  std::deque<PointId> fused_;                         // the newest kRemembered
  std::vector<int> shared_;                           // by keyframe, all 0 between calls of UpdateCovisibility
};

}  // namespace rds
