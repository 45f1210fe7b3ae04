// Summaries of measured series.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <vector>

namespace rds {

// Of a series in any unit; all 0 for an empty one.
struct Summary {
  std::size_t count = 0;
  double median = 0;
  double mean = 0;
  double p95 = 0;  // 95 % quantile
  double max = 0;
};

// Quantiles are interpolated linearly between the sorted values, as NumPy's default does.
[[nodiscard]] Summary Summarize(std::vector<double> values);

// {"median": ..., "mean": ..., "p95": ..., "max": ...}; null for an empty series.
[[nodiscard]] nlohmann::ordered_json ToJson(const Summary& summary);

}  // namespace rds
