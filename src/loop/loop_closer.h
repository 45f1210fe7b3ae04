// SPDX-License-Identifier: Apache-2.0
// Places that are seen again: lost frames found, loops closed, worlds merged.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <unordered_set>
#include <vector>

#include "loop/essential_graph.h"
#include "loop/loop_options.h"
#include "map/map_access.h"
#include "place/place_search.h"

namespace rds {

// What a keyframe that was seen again led to.
struct Closure {
  KeyframeId keyframe;
  KeyframeId place;       // keyframe that shows the same place
  WorldId world;          // that both are in now
  WorldId merged;         // that was merged into it; invalid for a loop
  Rigid3 into_from_from;  // where what was moved is now: of the merged world, or of the keyframe for a loop
  int matches = 0;
  bool moved = true;      // false: all was in place already, points were fused only
  bool moved_far = true;  // so far that all of the world is worth a bundle adjustment
};

// Knows no thread; one caller at a time but for Adjust. Publishes nothing: the caller does where a Closure comes back.
class LoopCloser {
 public:
  LoopCloser(const LoopOptions& options, const ScalePyramid& pyramid, const PoseOptimizerOptions& pose, bool semantics);

  // A keyframe that is new, or was labeled since: by its static part it is found from now on.
  void Index(const MapAccess& map, KeyframeId keyframe);
  // Where in the map, in whatever world, a frame was taken. Where few matches say so, only once the frame asked for
  // before, not long ago, was found beside it.
  [[nodiscard]] std::optional<PlaceFound> Relocalize(const MapAccess& map, const PlaceQuery& query, double timestamp_s);
  // Looks for the place of a keyframe elsewhere in the map: in its own world among what is not tied to it by points
  // that both see, which is a loop, or in another, which is merged. Points that it or those beside it see already do
  // not count. Both need more matches than chance has, and a witness: a keyframe beside it whose pose is confirmed by
  // what that implies; a loop corrects no more than the way travelled since explains. Corrects the map.
  [[nodiscard]] std::optional<Closure> Close(MapAccess& map, KeyframeId keyframe);
  // Full bundle adjustment of a world, on a copy; nothing of it is kept if `stop` says so or if many poses of the map
  // have changed since. Whether it was applied. May run beside the rest.
  [[nodiscard]] bool Adjust(MapAccess& map, WorldId world, const std::function<bool()>& stop) const;

  [[nodiscard]] const PlaceIndex& index() const { return index_; }

 private:
  struct Sighting {
    double timestamp_s = 0;
    PlaceFound found;
  };
  // A keyframe that may be seen again, with all that is asked of the map at once.
  struct Subject {
    KeyframeId id;
    PlaceQuery query;
    WorldId world;
    Rigid3 camera_from_world;
    std::vector<PointId> known;             // that it or its best covisible keyframes see, ascending
    std::unordered_set<KeyframeId> around;  // what shares points with it, its parent and children
    std::vector<KeyframeId> witnesses;      // best covisible ones
  };

  [[nodiscard]] std::optional<Subject> Describe(const MapAccess& map, KeyframeId keyframe) const;
  // `scores` are those of the subject.
  [[nodiscard]] std::optional<PlaceFound> FindAgain(const MapAccess& map, const Subject& subject,
                                                    std::span<const PlaceScore> scores, bool in_own_world) const;
  // Whether the way between the two explains the correction that the pose found implies.
  [[nodiscard]] static bool IsExplained(const MapAccess& map, const Subject& subject, const PlaceFound& found);
  // Whether a witness sees what the pose found implies, in the same surroundings.
  [[nodiscard]] bool IsWitnessed(const MapAccess& map, const Subject& subject, const PlaceCandidate& surroundings,
                                 const PlaceFound& found) const;
  [[nodiscard]] std::optional<Closure> CloseLoop(MapAccess& map, const Subject& subject, const PlaceFound& found);
  [[nodiscard]] std::optional<Closure> MergeWorlds(MapAccess& map, KeyframeId keyframe, const PlaceFound& found);
  void Weld(MapAccess& map, KeyframeId keyframe, const PlaceFound& found);
  void DropErased(const MapAccess& map);

  LoopOptions options_;
  ScalePyramid pyramid_;
  PoseOptimizerOptions pose_;
  bool semantics_;
  PlaceIndex index_;
  std::vector<LoopEdge> loops_;
  std::optional<Sighting> sighting_;  // of a lost frame, which waits for another that agrees
  int indexed_ = 0;                   // keyframes since erased ones were dropped
};

}  // namespace rds
