// SPDX-License-Identifier: Apache-2.0
#include "io/dataset_association.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace rds {

std::vector<std::pair<std::size_t, std::size_t>> AssociateByTime(std::span<const double> first,
                                                                 std::span<const double> second,
                                                                 double max_difference_s) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> candidates;
  std::size_t low = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    while (low < second.size() && second[low] < first[i] - max_difference_s) {
      ++low;
    }
    for (std::size_t j = low; j < second.size() && second[j] <= first[i] + max_difference_s; ++j) {
      candidates.emplace_back(std::abs(first[i] - second[j]), i, j);
    }
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<bool> first_used(first.size());
  std::vector<bool> second_used(second.size());
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (const auto& [difference, i, j] : candidates) {
    if (!first_used[i] && !second_used[j]) {
      first_used[i] = second_used[j] = true;
      pairs.emplace_back(i, j);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace rds
