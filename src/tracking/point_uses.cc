// SPDX-License-Identifier: Apache-2.0
#include "tracking/point_uses.h"

#include <utility>

namespace rds {

void PointUses::Rebase(std::shared_ptr<const LocalMap> map) {
  AppendCounts(&before_);
  map_ = std::move(map);
  counts_.assign(map_->size(), {});
}

std::vector<PointUse> PointUses::List() const {
  std::vector<PointUse> uses = before_;
  AppendCounts(&uses);
  return uses;
}

void PointUses::Clear() {
  before_.clear();
  counts_.assign(counts_.size(), {});
}

void PointUses::AppendCounts(std::vector<PointUse>* uses) const {
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    if (counts_[i].visible > 0 || counts_[i].found > 0) {
      uses->push_back({map_->ids[i], counts_[i].visible, counts_[i].found});
    }
  }
}

}  // namespace rds
