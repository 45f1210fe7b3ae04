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

PointUse& PointUses::Of(PointId point) {
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

}  // namespace rds
