// Measured series in reports.
#pragma once

#include <nlohmann/json.hpp>
#include <span>

namespace rds {

// {"median", "mean", "p95" (95 % quantile), "max"} of a series in any unit; null for an empty one.
[[nodiscard]] nlohmann::ordered_json SeriesJson(std::span<const double> values);

}  // namespace rds
