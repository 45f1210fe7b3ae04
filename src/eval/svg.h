// SPDX-License-Identifier: Apache-2.0
// Just enough SVG for a plot.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <string_view>

namespace rds {

// Pixels, x right, y down.
using SvgPoint = Eigen::Vector2d;

enum class SvgAnchor { kStart, kMiddle, kEnd };

// Collects shapes in drawing order. The same calls give the same text. Attributes are SVG's own ("stroke='#000'"),
// texts are escaped. Not thread-safe.
class SvgWriter {
 public:
  SvgWriter(double width, double height);

  void Rectangle(const SvgPoint& corner, double width, double height, std::string_view attributes);
  void Circle(const SvgPoint& center, double radius, std::string_view attributes);
  void Line(const SvgPoint& from, const SvgPoint& to, std::string_view attributes);
  // Nothing for fewer than two points.
  void Polyline(std::span<const SvgPoint> points, std::string_view attributes);
  void Text(const SvgPoint& at, SvgAnchor anchor, std::string_view text, std::string_view attributes = "");
  // Turned by a quarter, reading upwards.
  void UprightText(const SvgPoint& at, SvgAnchor anchor, std::string_view text, std::string_view attributes = "");

  // The whole document; ends in a line break.
  [[nodiscard]] std::string Finish() const;

 private:
  std::string body_;
};

}  // namespace rds
