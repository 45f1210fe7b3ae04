// SPDX-License-Identifier: Apache-2.0
// Summary of a series of numbers.
#pragma once

#include <cstddef>
#include <span>

namespace rds {

// All zero for an empty series.
struct Statistics {
  std::size_t count = 0;
  double rmse = 0;  // root of the mean square
  double mean = 0;
  double median = 0;  // mean of the two in the middle for an even count
  double std = 0;     // of the population: divided by the count
  double min = 0;
  double max = 0;
};

Statistics Summarize(std::span<const double> values);

// The value below which `percent` of the series lies, linear between neighbors (percent 0 .. 100); 0 for an empty one.
double Percentile(std::span<const double> values, double percent);

}  // namespace rds
