// SPDX-License-Identifier: Apache-2.0
#include "cli/series_json.h"

#include "eval/statistics.h"

namespace rds {

nlohmann::ordered_json SeriesJson(std::span<const double> values) {
  if (values.empty()) {
    return nullptr;
  }
  const Statistics statistics = Summarize(values);
  return {{"median", statistics.median},
          {"mean", statistics.mean},
          {"p95", Percentile(values, 95)},
          {"max", statistics.max}};
}

}  // namespace rds
