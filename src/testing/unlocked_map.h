// SPDX-License-Identifier: Apache-2.0
// Access to a map that nobody else touches.
#pragma once

#include "map/map_access.h"

namespace rds {

class UnlockedMap final : public MapAccess {
 public:
  explicit UnlockedMap(Map& map) : map_(map) {}

 protected:
  void DoRead(const std::function<void(const Map&)>& function) const override { function(map_); }
  void DoWrite(const std::function<void(Map&)>& function) override { function(map_); }

 private:
  Map& map_;
};

}  // namespace rds
