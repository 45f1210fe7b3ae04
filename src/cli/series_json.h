// SPDX-License-Identifier: Apache-2.0
// Measured series in reports.
#pragma once

#include <nlohmann/json.hpp>
#include <span>

namespace rds {

// {"median", "mean", "p95" (95 % quantile), "max"} of a series in any unit; null for an empty one.
[[nodiscard]] nlohmann::ordered_json SeriesJson(std::span<const double> values);

// For dump(): names of files may be any bytes.
inline constexpr auto kReplaceBadUtf8 = nlohmann::ordered_json::error_handler_t::replace;

}  // namespace rds
