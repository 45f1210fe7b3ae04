// SPDX-License-Identifier: Apache-2.0
#include "io/camera_plausibility.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <cmath>
#include <numbers>

namespace rds {
namespace {

double FieldOfViewDeg(int pixels, double focal_px) {
  return 2 * std::atan(pixels / (2 * focal_px)) * 180 / std::numbers::pi;
}

std::optional<std::string> FocalProblem(const char* name, double focal, int pixels) {
  constexpr double kNarrowest_deg = 35;
  constexpr double kWidest_deg = 150;
  const double field_deg = FieldOfViewDeg(pixels, focal);
  if (field_deg >= kNarrowest_deg * (name[1] == 'y' ? 0.5 : 1) && field_deg <= kWidest_deg) {
    return std::nullopt;
  }
  std::string likely;
  if (focal > 0.2 && focal < 5) {
    likely = fmt::format("; in units of the image's side? Then {}: {:g}", name, focal * pixels);
  } else if (field_deg < kNarrowest_deg) {
    likely = fmt::format("; of pictures twice the size? Then {}: {:g}", name, focal / 2);
  }
  return fmt::format("{} {:g} makes a field of view of {:.1f} degrees over {} pixels, which no RGB-D camera has{}",
                     name, focal, field_deg, pixels, likely);
}

std::optional<std::string> CenterProblem(const char* name, double center, int pixels) {
  if (center >= 0.25 * pixels && center <= 0.75 * pixels) {
    return std::nullopt;
  }
  return fmt::format(
      "{} {:g} lies far from the middle of {} pixels; is it of another picture size, or are the numbers "
      "in another order (fx, fy, cx, cy)?",
      name, center, pixels);
}

}  // namespace

std::optional<std::string> CameraProblem(const PinholeCamera& camera) {
  if (auto problem = FocalProblem("fx", camera.fx, camera.width)) {
    return problem;
  }
  if (auto problem = FocalProblem("fy", camera.fy, camera.height)) {
    return problem;
  }
  if (auto problem = CenterProblem("cx", camera.cx, camera.width)) {
    return problem;
  }
  if (auto problem = CenterProblem("cy", camera.cy, camera.height)) {
    return problem;
  }
  if (camera.fx > 2 * camera.fy || camera.fy > 2 * camera.fx) {
    return fmt::format("fx {:g} and fy {:g} differ by more than pixels do", camera.fx, camera.fy);
  }
  if (camera.baseline_m < 0.005 || camera.baseline_m > 1) {
    const double of_bf = camera.baseline_m / camera.fx;
    const double of_mm = camera.baseline_m / 1000;
    std::string likely;
    if (of_mm >= 0.045 && of_mm <= 1) {
      likely = fmt::format("; millimeters? Then baseline_m: {:g}", of_mm);
    } else if (of_bf >= 0.005 && of_bf <= 1) {
      likely = fmt::format("; ORB-SLAM's bf? Then baseline_m: {:.4g}", of_bf);
    }
    return fmt::format("baseline_m {:g}: no RGB-D camera has it{}", camera.baseline_m, likely);
  }
  if (camera.depth_scale < 50 || camera.depth_scale > 100'000) {
    const double inverse = 1 / camera.depth_scale;
    return fmt::format(
        "depth_scale {:g}: it is the number of units in a meter, such as 1000 (millimeters) or 5000 "
        "(TUM){}",
        camera.depth_scale,
        inverse >= 50 && inverse <= 100'000 ? fmt::format("; the inverse? Then depth_scale: {:g}", inverse) : "");
  }
  return std::nullopt;
}

double LikelyDepthScale(const PinholeCamera& camera, double median_m) {
  constexpr double kLikely_m = 2;
  constexpr std::array<double, 4> kScales = {1000, 5000, 10000, 6553.5};
  const auto off = [&](double scale) { return std::abs(std::log(median_m * camera.depth_scale / scale / kLikely_m)); };
  double best = kScales[0];
  for (const double scale : kScales) {
    best = off(scale) < off(best) ? scale : best;
  }
  return best;
}

std::optional<std::string> DepthProblem(const PinholeCamera& camera, double median_m) {
  constexpr double kNearest_m = 0.1;
  constexpr double kFarthest_m = 8;
  if (camera.unusual || (median_m >= kNearest_m && median_m <= kFarthest_m)) {
    return std::nullopt;
  }
  const double likely = LikelyDepthScale(camera, median_m);
  return fmt::format(
      "half of the depth lies beyond {:.3g} m with depth_scale {:g}; likely right is depth_scale: {:g}, "
      "which makes it {:.2g} m",
      median_m, camera.depth_scale, likely, median_m * camera.depth_scale / likely);
}

}  // namespace rds
