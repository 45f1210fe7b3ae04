// SPDX-License-Identifier: Apache-2.0
// Local mapping: what a new keyframe does to the map around it.
#pragma once

#include <functional>
#include <vector>

#include "map/keyframe_candidate.h"
#include "map/map_access.h"
#include "mapping/mapping_options.h"

namespace rds {

// The mapping thread's algorithm (local mapping of ORB-SLAM, Mur-Artal et al., T-RO 2015, section VI). Each step takes
// the map for a short time only; what is searched and solved is searched and solved outside. Knows no thread; one
// instance, one caller.
class LocalMapper {
 public:
  explicit LocalMapper(const MappingOptions& options) : options_(options) {}

  // Adds the candidate as a keyframe with the points it tracked and new ones from its depth. A candidate without a
  // reference keyframe starts a world.
  KeyframeId Insert(Map& map, const KeyframeCandidate& candidate);

  // Ends the probation of recent points, creates new ones with neighboring keyframes, fuses duplicates.
  void Refine(MapAccess& map, KeyframeId keyframe);

  // Local bundle adjustment around a keyframe; false if there was nothing to adjust. `semantics`: labels are expected
  // at all.
  bool Adjust(MapAccess& map, KeyframeId keyframe, bool semantics, const std::function<bool()>& should_stop);

  // Erases keyframes around this one whose points are well observed without them.
  void CullKeyframes(MapAccess& map, KeyframeId keyframe);

 private:
  void ObserveTrackedPoints(Map& map, KeyframeId keyframe, const KeyframeCandidate& candidate);
  void AddDepthPoints(Map& map, const Keyframe& keyframe, const KeyframeCandidate& candidate);
  void CullRecentPoints(Map& map, KeyframeId newest);
  void CreatePoints(MapAccess& map, KeyframeId keyframe);
  void FusePoints(MapAccess& map, KeyframeId keyframe);
  [[nodiscard]] bool IsRedundant(const Map& map, const Keyframe& keyframe) const;

  MappingOptions options_;
  std::vector<PointId> recent_points_;  // on probation
};

}  // namespace rds
