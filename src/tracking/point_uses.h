// SPDX-License-Identifier: Apache-2.0
// How often points were there to be seen, and found.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "map/keyframe_candidate.h"
#include "map/local_map.h"

namespace rds {

// Counts since the last keyframe, which takes them to the map. Not thread-safe.
class PointUses {
 public:
  // From now on points are those of this snapshot.
  void Rebase(std::shared_ptr<const LocalMap> map);
  void CountVisible(std::span<const std::uint32_t> points) {
    for (const std::uint32_t point : points) {
      ++counts_[point].visible;
    }
  }
  void CountFound(std::uint32_t point) { ++counts_[point].found; }
  // All points that were counted. Those of one snapshot are ascending; a point of several has an entry for each.
  [[nodiscard]] std::vector<PointUse> List() const;
  void Clear();

 private:
  struct Counts {
    int visible = 0;
    int found = 0;
  };
  void AppendCounts(std::vector<PointUse>* uses) const;

  std::shared_ptr<const LocalMap> map_;
  std::vector<Counts> counts_;    // by point of the snapshot
  std::vector<PointUse> before_;  // of earlier snapshots
};

}  // namespace rds
