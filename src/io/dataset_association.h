// SPDX-License-Identifier: Apache-2.0
// Which depth image belongs to which color image.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace rds {

// Pairs (i, j) with |first[i] - second[j]| <= max_difference, taken greedily from the smallest difference up, each
// index at most once; ascending in i. Both spans ascend strictly; seconds. The rule of the TUM
// benchmark's associate.py (of equal differences the earlier pair wins).
std::vector<std::pair<std::size_t, std::size_t>> AssociateByTime(std::span<const double> first,
                                                                 std::span<const double> second,
                                                                 double max_difference_s);

}  // namespace rds
