// SPDX-License-Identifier: Apache-2.0
// Round numbers along the axis of a plot.
#pragma once

#include <string>
#include <vector>

namespace rds {

// 1, 2 or 5 times a power of ten, so that at most `count` steps fill the span.
[[nodiscard]] double TickStep(double span, int count);

// Multiples of the step from `low` to `high`; counted, so that they end where a step is lost in rounding, too.
[[nodiscard]] std::vector<double> Ticks(double low, double high, double step);

// With the decimals that the step needs.
[[nodiscard]] std::string TickText(double value, double step);

}  // namespace rds
