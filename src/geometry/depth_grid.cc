// SPDX-License-Identifier: Apache-2.0
#include "geometry/depth_grid.h"

#include <iterator>
#include <utility>

#include "base/error.h"

namespace rds {

DepthGrid::DepthGrid(int columns, int rows, std::vector<float> depth_m)
    : columns_(columns), rows_(rows), depth_m_(std::move(depth_m)) {
  Check(columns >= 0 && rows >= 0 && std::ssize(depth_m_) == std::ptrdiff_t{columns} * rows,
        "a depth for each sample of the grid");
}

}  // namespace rds
