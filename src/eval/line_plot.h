// SPDX-License-Identifier: Apache-2.0
// Lines over a common axis.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

namespace rds {

// Points in the order of x; a y that is not finite interrupts the line.
struct LineSeries {
  std::string name;
  std::vector<Eigen::Vector2d> points;
};

// SVG with axes from 0 (or the least value, if below), ticks, a line in a color of its own for each series, and a
// legend. The same input gives the same bytes.
[[nodiscard]] std::string PlotLines(const std::string& title, const std::string& x_label, const std::string& y_label,
                                    std::span<const LineSeries> series);

}  // namespace rds
