// How often points were there to be seen, and found.
#pragma once

#include <vector>

#include "base/ids.h"
#include "map/keyframe_candidate.h"

namespace rds {

// Counts since the last keyframe, which takes them to the map. Not thread-safe.
class PointUses {
 public:
  void CountVisible(PointId point) { ++Of(point).visible; }
  void CountFound(PointId point) { ++Of(point).found; }
  // All points that were counted, in the order in which they first were.
  [[nodiscard]] std::vector<PointUse> List() const;
  void Clear();

 private:
  PointUse& Of(PointId point) {
    if (uses_.size() <= point.index()) {
      uses_.resize(point.index() + 1);
    }
    PointUse& use = uses_[point.index()];
    if (!use.point.valid()) {
      use.point = point;
      used_.push_back(point);
    }
    return use;
  }

  std::vector<PointUse> uses_;  // by point id, value-initialised where unused
  std::vector<PointId> used_;   // ids whose entry is in use
};

}  // namespace rds
