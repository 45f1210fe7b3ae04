#include "tracking/point_uses.h"

namespace rds {

std::vector<PointUse> PointUses::List() const {
  std::vector<PointUse> uses;
  uses.reserve(used_.size());
  for (const PointId id : used_) {
    uses.push_back(uses_[id.index()]);
  }
  return uses;
}

void PointUses::Clear() {
  for (const PointId id : used_) {
    uses_[id.index()] = PointUse{};
  }
  used_.clear();
}

}  // namespace rds
