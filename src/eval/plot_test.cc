// SPDX-License-Identifier: Apache-2.0
#include "eval/plot.h"

#include <gmock/gmock.h>

#include <regex>

#include "eval/svg.h"

namespace rds {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// A round in the plane of two axes, with an error of up to `error_m`.
Evaluation Round(int first_axis, int second_axis, double error_m, double radius_m = 2) {
  Trajectory truth;
  Trajectory estimate;
  for (int i = 0; i < 200; ++i) {
    const double a = 0.0314 * i;
    StampedPose pose;
    pose.timestamp_s = 0.1 * i;
    pose.world_from_camera.translation[first_axis] = radius_m * std::cos(a);
    pose.world_from_camera.translation[second_axis] = radius_m * std::sin(a);
    truth.push_back(pose);
    pose.world_from_camera.translation[first_axis] += error_m * std::sin(5 * a);
    estimate.push_back(pose);
  }
  return Evaluate(estimate, truth);
}

// Every point of every polyline lies in the picture.
void ExpectInside(const std::string& svg) {
  std::smatch size;
  ASSERT_TRUE(std::regex_search(svg, size, std::regex("viewBox='0 0 ([0-9.]+) ([0-9.]+)'")));
  const std::regex number("([-0-9.]+),([-0-9.]+)[ ']");
  int points = 0;
  for (std::sregex_iterator it(svg.begin(), svg.end(), number), end; it != end; ++it, ++points) {
    EXPECT_GT(std::stod((*it)[1]), 0);
    EXPECT_LT(std::stod((*it)[1]), std::stod(size[1]));
    EXPECT_GT(std::stod((*it)[2]), 0);
    EXPECT_LT(std::stod((*it)[2]), std::stod(size[2]));
  }
  EXPECT_GT(points, 100);
}

TEST(Plot, IsAWholeDocument) {
  const std::string svg = PlotTrajectories(Round(0, 1, 0.05), "round & <round>");
  EXPECT_TRUE(svg.starts_with("<svg xmlns='http://www.w3.org/2000/svg'"));
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  EXPECT_THAT(svg, HasSubstr(">round &amp; &lt;round&gt;: ATE 3."));
  EXPECT_THAT(svg, HasSubstr(" cm RMSE<"));
  EXPECT_THAT(svg, HasSubstr(">position error [cm]<"));
  EXPECT_THAT(svg, HasSubstr(">ground truth<"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  ExpectInside(svg);
  EXPECT_EQ(svg, PlotTrajectories(Round(0, 1, 0.05), "round & <round>"));
}

TEST(Plot, ChoosesTheAxesOfThePath) {
  const std::string xy = PlotTrajectories(Round(0, 1, 0.05));
  EXPECT_THAT(xy, HasSubstr(">x [m]<"));
  EXPECT_THAT(xy, HasSubstr(">y [m]<"));
  const std::string xz = PlotTrajectories(Round(2, 0, 0.05));
  EXPECT_THAT(xz, HasSubstr(">x [m]<"));
  EXPECT_THAT(xz, HasSubstr(">z [m]<"));
  EXPECT_THAT(PlotTrajectories(Round(2, 1, 0.05)), Not(HasSubstr(">x [m]<")));
}

TEST(Plot, ChoosesUnits) {
  EXPECT_THAT(PlotTrajectories(Round(0, 1, 0.002)), HasSubstr(">position error [mm]<"));
  EXPECT_THAT(PlotTrajectories(Round(0, 1, 9, 50)), HasSubstr(">position error [m]<"));
}

TEST(Plot, StandsExtremes) {
  for (const double radius_m : {0.0, 1e-6, 1e6}) {
    for (const double error_m : {0.0, 1e-9, 1.0}) {
      const std::string svg = PlotTrajectories(Round(0, 1, error_m, radius_m));
      EXPECT_THAT(svg, Not(HasSubstr("nan")));
      EXPECT_THAT(svg, Not(HasSubstr("inf")));
      EXPECT_LT(svg.size(), 100'000U);
    }
  }
}

TEST(Plot, LeavesAGapWhereTrackingWasLost) {
  Trajectory truth;
  for (int i = 0; i < 300; ++i) {
    truth.push_back({0.1 * i, {Eigen::Quaterniond::Identity(), {0.01 * i, std::sin(0.05 * i), 0}}});
  }
  Trajectory estimate = truth;
  estimate.erase(estimate.begin() + 100, estimate.begin() + 200);
  const auto lines = [](const std::string& svg) {
    const std::regex polyline("<polyline");
    return std::distance(std::sregex_iterator(svg.begin(), svg.end(), polyline), std::sregex_iterator());
  };
  EXPECT_EQ(lines(PlotTrajectories(Evaluate(truth, truth))), 2);
  EXPECT_EQ(lines(PlotTrajectories(Evaluate(estimate, truth))), 3);
}

TEST(Svg, EscapesAndRounds) {
  SvgWriter svg(10, 20);
  svg.Text({1.04, -0.01}, SvgAnchor::kEnd, "a<b>&c\n");
  svg.Polyline({}, "");
  EXPECT_THAT(svg.Finish(), HasSubstr("<text x='1.0' y='0.0' text-anchor='end' >a&lt;b&gt;&amp;c </text>"));
  EXPECT_THAT(svg.Finish(), Not(HasSubstr("polyline")));
}

}  // namespace
}  // namespace rds
