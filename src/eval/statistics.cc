// SPDX-License-Identifier: Apache-2.0
#include "eval/statistics.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace rds {

Statistics Summarize(std::span<const double> values) {
  Statistics result;
  if (values.empty()) {
    return result;
  }
  const double n = static_cast<double>(values.size());
  double sum = 0;
  double squares = 0;
  for (const double value : values) {
    sum += value;
    squares += value * value;
  }
  result.count = values.size();
  result.mean = sum / n;
  result.rmse = std::sqrt(squares / n);
  double deviations = 0;
  for (const double value : values) {
    deviations += (value - result.mean) * (value - result.mean);
  }
  result.std = std::sqrt(deviations / n);
  result.median = Percentile(values, 50);
  const auto [min, max] = std::minmax_element(values.begin(), values.end());
  result.min = *min;
  result.max = *max;
  return result;
}

double Percentile(std::span<const double> values, double percent) {
  if (values.empty()) {
    return 0;
  }
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const double at = std::clamp(percent / 100, 0.0, 1.0) * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], at - static_cast<double>(below));
}

}  // namespace rds
