// SPDX-License-Identifier: Apache-2.0
#include "semantic/backlog.h"

#include <utility>

#include "base/error.h"

namespace rds {

int Backlog::Push(BacklogItem item) {
  Check(items_.empty() || items_.back().frame < item.frame, "keyframes come in order");
  items_.push_back(std::move(item));
  if (items_.size() <= capacity_) {
    return 0;
  }
  items_.erase(items_.begin() + static_cast<std::ptrdiff_t>(items_.size() / 2));
  return 1;
}

BacklogItem Backlog::TakeFront() {
  BacklogItem item = std::move(items_.front());
  items_.pop_front();
  item.from_front = true;
  return item;
}

BacklogItem Backlog::Revert() {
  BacklogItem item = std::move(items_.back());
  items_.pop_back();
  return item;
}

std::vector<BacklogItem> Backlog::Select(SelectionMode mode, std::size_t count) {
  std::vector<BacklogItem> selected;
  while (selected.size() < count && !items_.empty()) {
    const bool front =
        mode == SelectionMode::kSequential || (mode == SelectionMode::kBidirectional && selected.size() % 2 == 0);
    selected.push_back(front ? TakeFront() : Revert());
  }
  return selected;
}

}  // namespace rds
