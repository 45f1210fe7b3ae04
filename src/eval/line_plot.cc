// SPDX-License-Identifier: Apache-2.0
#include "eval/line_plot.h"

#include <spdlog/fmt/fmt.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "eval/svg.h"
#include "eval/ticks.h"

namespace rds {
namespace {

constexpr double kLeft = 64;
constexpr double kTop = 44;
constexpr double kWidth = 640;  // of the area with the lines, pixels
constexpr double kHeight = 260;
constexpr double kLegendRow = 20;
// Told apart by most color-blind people (Okabe and Ito).
constexpr std::array kLineColors = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"};

}  // namespace

std::string PlotLines(const std::string& title, const std::string& x_label, const std::string& y_label,
                      std::span<const LineSeries> series) {
  Eigen::AlignedBox2d box(Eigen::Vector2d(0, 0), Eigen::Vector2d(1e-9, 1e-9));
  for (const LineSeries& line : series) {
    for (const Eigen::Vector2d& point : line.points) {
      if (point.allFinite()) {
        box.extend(point);
      }
    }
  }
  const Eigen::Vector2d size = box.sizes();
  const auto at = [&](const Eigen::Vector2d& point) {
    return SvgPoint(kLeft + kWidth * (point.x() - box.min().x()) / size.x(),
                    kTop + kHeight * (1 - (point.y() - box.min().y()) / size.y()));
  };
  const double bottom = kTop + kHeight;
  const double legend = bottom + 58;
  SvgWriter svg(kLeft + kWidth + 24, legend + kLegendRow * static_cast<double>(series.size()));
  svg.Text({kLeft, 24}, SvgAnchor::kStart, title, "font-size='16' fill='#111'");
  const double step_x = TickStep(size.x(), 8);
  for (const double x : Ticks(box.min().x(), box.max().x(), step_x)) {
    const SvgPoint foot = at({x, box.min().y()});
    svg.Line(foot, {foot.x(), kTop}, "stroke='#eee'");
    svg.Text({foot.x(), bottom + 18}, SvgAnchor::kMiddle, TickText(x, step_x));
  }
  const double step_y = TickStep(size.y(), 6);
  for (const double y : Ticks(box.min().y(), box.max().y(), step_y)) {
    const SvgPoint foot = at({box.min().x(), y});
    svg.Line(foot, {kLeft + kWidth, foot.y()}, "stroke='#eee'");
    svg.Text({kLeft - 8, foot.y() + 4}, SvgAnchor::kEnd, TickText(y, step_y));
  }
  svg.Rectangle({kLeft, kTop}, kWidth, kHeight, "fill='none' stroke='#999'");
  svg.Text({kLeft + kWidth / 2, bottom + 38}, SvgAnchor::kMiddle, x_label);
  svg.UprightText({18, kTop + kHeight / 2}, SvgAnchor::kMiddle, y_label);
  for (std::size_t i = 0; i < series.size(); ++i) {
    const char* const color = kLineColors[i % kLineColors.size()];
    const std::string stroke = fmt::format("fill='none' stroke='{}' stroke-width='1.5'", color);
    std::vector<SvgPoint> piece;
    for (const Eigen::Vector2d& point : series[i].points) {
      if (point.allFinite()) {
        piece.push_back(at(point));
      } else {
        svg.Polyline(piece, stroke);
        piece.clear();
      }
    }
    svg.Polyline(piece, stroke);
    const double y = legend + kLegendRow * static_cast<double>(i);
    svg.Line({kLeft, y}, {kLeft + 24, y}, stroke);
    svg.Text({kLeft + 32, y + 4}, SvgAnchor::kStart, series[i].name);
  }
  return svg.Finish();
}

}  // namespace rds
