// SPDX-License-Identifier: Apache-2.0
#include "eval/plot.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "eval/svg.h"
#include "eval/ticks.h"

namespace rds {
namespace {

constexpr double kMarginLeft = 72;
constexpr double kMarginTop = 84;
constexpr double kMarginRight = 118;
constexpr double kMarginBottom = 58;
constexpr double kLargestWidth = 640;  // of the area that shows the paths, pixels
constexpr double kLargestHeight = 520;
constexpr double kSmallestSide = 220;
constexpr int kColors = 32;

// Ground truth and estimate on two axes, meters; one estimated point for each match.
struct Paths {
  std::array<int, 2> axes{};
  std::vector<Eigen::Vector2d> truth;
  std::vector<Eigen::Vector2d> estimate;
};

// The two axes of largest variance, in alphabetical order.
std::array<int, 2> ChooseAxes(const std::vector<MatchedPose>& matches) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (const MatchedPose& match : matches) {
    sum += match.ground_truth.translation;
    squares += match.ground_truth.translation.cwiseAbs2();
  }
  const double n = static_cast<double>(matches.size());
  const Eigen::Vector3d variance = squares / n - (sum / n).cwiseAbs2();
  Eigen::Index least = 0;
  variance.minCoeff(&least);
  return least == 0 ? std::array{1, 2} : least == 1 ? std::array{0, 2} : std::array{0, 1};
}

Paths Project(const Evaluation& evaluation) {
  Paths paths;
  paths.axes = ChooseAxes(evaluation.matches);
  const auto project = [&](const Rigid3& pose) {
    return Eigen::Vector2d(pose.translation[paths.axes[0]], pose.translation[paths.axes[1]]);
  };
  for (const StampedPose& pose : evaluation.ground_truth) {
    paths.truth.push_back(project(pose.world_from_camera));
  }
  for (const MatchedPose& match : evaluation.matches) {
    paths.estimate.push_back(project(match.estimate));
  }
  return paths;
}

// A window on the world: meters to pixels at one scale for both axes.
class Window {
 public:
  explicit Window(const Paths& paths) {
    Eigen::AlignedBox2d box;
    for (const auto* path : {&paths.truth, &paths.estimate}) {
      for (const Eigen::Vector2d& point : *path) {
        box.extend(point);
      }
    }
    const double margin_m = std::max(0.05 * box.sizes().maxCoeff(), 1e-3);
    low_ = box.min().array() - margin_m;
    const Eigen::Vector2d size_m = box.sizes().array() + 2 * margin_m;
    pixels_per_m_ = std::min(kLargestWidth / size_m.x(), kLargestHeight / size_m.y());
    const Eigen::Vector2d wanted = pixels_per_m_ * size_m;
    size_ = wanted.cwiseMax(kSmallestSide);
    low_ -= (size_ - wanted) / (2 * pixels_per_m_);  // a flat path lies in the middle
    high_ = low_ + size_ / pixels_per_m_;
  }

  [[nodiscard]] SvgPoint At(const Eigen::Vector2d& point_m) const {
    return {Left() + pixels_per_m_ * (point_m.x() - low_.x()), Bottom() - pixels_per_m_ * (point_m.y() - low_.y())};
  }
  [[nodiscard]] const Eigen::Vector2d& low() const { return low_; }    // meters
  [[nodiscard]] const Eigen::Vector2d& high() const { return high_; }  // meters
  [[nodiscard]] const Eigen::Vector2d& size() const { return size_; }  // pixels
  [[nodiscard]] double Left() const { return kMarginLeft; }
  [[nodiscard]] double Right() const { return kMarginLeft + size_.x(); }
  [[nodiscard]] double Top() const { return kMarginTop; }
  [[nodiscard]] double Bottom() const { return kMarginTop + size_.y(); }

 private:
  Eigen::Vector2d low_;
  Eigen::Vector2d high_;
  Eigen::Vector2d size_;
  double pixels_per_m_ = 1;
};

void DrawAxes(SvgWriter& svg, const Window& window, const std::array<int, 2>& axes) {
  constexpr const char* kGrid = "stroke='#e4e4e4'";
  const double step = TickStep((window.high() - window.low()).maxCoeff(), 8);
  for (const double x : Ticks(window.low().x(), window.high().x(), step)) {
    const double px = window.At({x, 0}).x();
    svg.Line({px, window.Top()}, {px, window.Bottom()}, kGrid);
    svg.Text({px, window.Bottom() + 18}, SvgAnchor::kMiddle, TickText(x, step));
  }
  for (const double y : Ticks(window.low().y(), window.high().y(), step)) {
    const double py = window.At({0, y}).y();
    svg.Line({window.Left(), py}, {window.Right(), py}, kGrid);
    svg.Text({window.Left() - 8, py + 4}, SvgAnchor::kEnd, TickText(y, step));
  }
  svg.Rectangle({window.Left(), window.Top()}, window.size().x(), window.size().y(), "fill='none' stroke='#999'");
  constexpr std::array<const char*, 3> kNames = {"x [m]", "y [m]", "z [m]"};
  svg.Text({(window.Left() + window.Right()) / 2, window.Bottom() + 42}, SvgAnchor::kMiddle,
           kNames[static_cast<std::size_t>(axes[0])]);
  svg.UprightText({window.Left() - 50, (window.Top() + window.Bottom()) / 2}, SvgAnchor::kMiddle,
                  kNames[static_cast<std::size_t>(axes[1])]);
}

// Dark blue for none to orange for the largest error.
std::string ColorOf(int bin) {
  constexpr std::array<std::array<double, 3>, 5> kStops = {
      {{21, 30, 138}, {96, 20, 160}, {180, 42, 130}, {228, 92, 74}, {250, 165, 46}}};
  const double at = static_cast<double>(bin) / (kColors - 1) * static_cast<double>(kStops.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(at), kStops.size() - 2);
  std::array<int, 3> color{};
  for (std::size_t c = 0; c < 3; ++c) {
    color[c] = static_cast<int>(
        std::lround(std::lerp(kStops[below][c], kStops[below + 1][c], at - static_cast<double>(below))));
  }
  return fmt::format("#{:02x}{:02x}{:02x}", color[0], color[1], color[2]);
}

// True where the estimate jumps over time: no line is drawn between.
std::vector<bool> FindBreaks(const std::vector<MatchedPose>& matches) {
  std::vector<double> intervals_s;
  for (std::size_t i = 1; i < matches.size(); ++i) {
    intervals_s.push_back(matches[i].timestamp_s - matches[i - 1].timestamp_s);
  }
  const double longest_s = std::max(0.5, 5 * Percentile(intervals_s, 50));
  std::vector<bool> breaks(matches.size());
  for (std::size_t i = 1; i < matches.size(); ++i) {
    breaks[i] = intervals_s[i - 1] > longest_s;
  }
  return breaks;
}

void DrawPaths(SvgWriter& svg, const Window& window, const Paths& paths, const Evaluation& evaluation) {
  std::vector<SvgPoint> points;
  for (const Eigen::Vector2d& point : paths.truth) {
    points.push_back(window.At(point));
  }
  svg.Polyline(points, "stroke='#8a8a8a' stroke-width='1.6' stroke-dasharray='5 3' stroke-linejoin='round'");
  const std::vector<bool> breaks = FindBreaks(evaluation.matches);
  const double largest_m = std::max(evaluation.ate_m.max, 1e-12);
  const auto bin_of = [&](std::size_t i) {  // of the piece that ends in match i
    const double mean_m = (evaluation.position_error_m[i - 1] + evaluation.position_error_m[i]) / 2;
    return std::clamp(static_cast<int>(mean_m / largest_m * kColors), 0, kColors - 1);
  };
  // Neighboring pieces of one color go into one line.
  std::vector<SvgPoint> piece;
  int bin = 0;
  const auto flush = [&] {
    svg.Polyline(piece,
                 "stroke='" + ColorOf(bin) + "' stroke-width='2.2' stroke-linecap='round' stroke-linejoin='round'");
  };
  for (std::size_t i = 1; i < paths.estimate.size(); ++i) {
    if (piece.empty() || breaks[i] || bin_of(i) != bin) {
      flush();
      piece = {window.At(paths.estimate[i - 1])};
      bin = bin_of(i);
    }
    if (breaks[i]) {
      piece.clear();
    } else {
      piece.push_back(window.At(paths.estimate[i]));
    }
  }
  flush();
  svg.Circle(window.At(paths.estimate.front()), 5, "fill='#fff' stroke='#111' stroke-width='2'");
  const SvgPoint end = window.At(paths.estimate.back());
  svg.Rectangle(end - SvgPoint(4.5, 4.5), 9, 9, "fill='#111' stroke='#fff'");
}

// Meters, centimeters or millimeters, whichever reads best.
struct Unit {
  const char* name;
  double per_m;
};
Unit UnitFor(double value_m) {
  return value_m >= 1 ? Unit{"m", 1} : value_m >= 0.01 ? Unit{"cm", 100} : Unit{"mm", 1000};
}

void DrawColorBar(SvgWriter& svg, const Window& window, double largest_m) {
  const double left = window.Right() + 24;
  const double height = std::min(window.size().y(), 260.0);
  const double top = window.Top() + (window.size().y() - height) / 2;
  const double cell = height / kColors;
  for (int i = 0; i < kColors; ++i) {
    svg.Rectangle({left, top + height - (i + 1) * cell}, 14, cell + 0.5, "fill='" + ColorOf(i) + "'");
  }
  const Unit unit = UnitFor(largest_m);
  const double largest = std::max(largest_m * unit.per_m, 1e-9);
  const double step = TickStep(largest, 5);
  for (const double value : Ticks(0, largest * (1 + 1e-9), step)) {
    const double y = top + height * (1 - value / largest);
    svg.Line({left + 14, y}, {left + 18, y}, "stroke='#333'");
    svg.Text({left + 22, y + 4}, SvgAnchor::kStart, TickText(value, step), "font-size='12'");
  }
  svg.UprightText({left + 66, top + height / 2}, SvgAnchor::kMiddle, fmt::format("position error [{}]", unit.name));
}

void DrawHeader(SvgWriter& svg, const Window& window, const Evaluation& evaluation, const std::string& title) {
  const Unit unit = UnitFor(evaluation.ate_m.rmse);
  const std::string ate = fmt::format("ATE {:.2f} {} RMSE", evaluation.ate_m.rmse * unit.per_m, unit.name);
  svg.Text({window.Left(), 32}, SvgAnchor::kStart, title.empty() ? ate : title + ": " + ate,
           "font-size='18' font-weight='bold' fill='#111'");
  const double y = 60;
  double x = window.Left();
  svg.Line({x, y - 4}, {x + 28, y - 4}, "stroke='#8a8a8a' stroke-width='1.6' stroke-dasharray='5 3'");
  svg.Text({x += 34, y}, SvgAnchor::kStart, "ground truth");
  x += 100;
  svg.Line({x, y - 4}, {x + 28, y - 4}, "stroke='" + ColorOf(kColors / 3) + "' stroke-width='2.2'");
  svg.Text({x += 34, y}, SvgAnchor::kStart, "estimate");
  x += 78;
  svg.Circle({x + 5, y - 4}, 5, "fill='#fff' stroke='#111' stroke-width='2'");
  svg.Text({x += 16, y}, SvgAnchor::kStart, "start");
  x += 52;
  svg.Rectangle({x, y - 8.5}, 9, 9, "fill='#111' stroke='#fff'");
  svg.Text({x + 15, y}, SvgAnchor::kStart, "end");
}

}  // namespace

std::string PlotTrajectories(const Evaluation& evaluation, const std::string& title) {
  const Paths paths = Project(evaluation);
  const Window window(paths);
  const double width = std::max(window.Right() + kMarginRight, 520.0);
  const double height = window.Bottom() + kMarginBottom;
  SvgWriter svg(width, height);
  svg.Rectangle({0, 0}, width, height, "fill='#fff'");
  DrawHeader(svg, window, evaluation, title);
  DrawAxes(svg, window, paths.axes);
  DrawPaths(svg, window, paths, evaluation);
  DrawColorBar(svg, window, evaluation.ate_m.max);
  return svg.Finish();
}

}  // namespace rds
