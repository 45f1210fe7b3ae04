#include "cli/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rds {
namespace {

// `values` sorted, not empty.
double Quantile(const std::vector<double>& values, double fraction) {
  const double position = fraction * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return std::lerp(values[below], values[above], position - static_cast<double>(below));
}

}  // namespace

Summary Summarize(std::vector<double> values) {
  if (values.empty()) {
    return {};
  }
  std::sort(values.begin(), values.end());
  Summary summary;
  summary.count = values.size();
  summary.median = Quantile(values, 0.5);
  summary.mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  summary.p95 = Quantile(values, 0.95);
  summary.max = values.back();
  return summary;
}

nlohmann::ordered_json ToJson(const Summary& summary) {
  if (summary.count == 0) {
    return nullptr;
  }
  return {{"median", summary.median}, {"mean", summary.mean}, {"p95", summary.p95}, {"max", summary.max}};
}

}  // namespace rds
