// SPDX-License-Identifier: Apache-2.0
#include "eval/ticks.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace rds {

double TickStep(double span, int count) {
  const double raw = std::max(span, 1e-9) / count;
  const double power = std::pow(10, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= raw * (1 - 1e-9)) {
      return factor * power;
    }
  }
  return 10 * power;
}

std::vector<double> Ticks(double low, double high, double step) {
  constexpr int kMost = 100;
  std::vector<double> ticks;
  const double first = std::ceil(low / step);
  for (int i = 0; i < kMost && (first + i) * step <= high; ++i) {
    ticks.push_back((first + i) * step);
  }
  return ticks;
}

std::string TickText(double value, double step) {
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  const std::string text = fmt::format("{:.{}f}", value, decimals);
  return text.find_first_not_of("-0.") == std::string::npos ? "0" : text;
}

}  // namespace rds
