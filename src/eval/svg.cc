// SPDX-License-Identifier: Apache-2.0
#include "eval/svg.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>

namespace rds {
namespace {

// A tenth of a pixel is fine enough; -0.0 and 0.0 are written alike.
std::string Number(double value) { return fmt::format("{:.1f}", std::abs(value) < 0.05 ? 0.0 : value); }

std::string Escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      default:
        escaped += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  }
  return escaped;
}

const char* AnchorName(SvgAnchor anchor) {
  return anchor == SvgAnchor::kStart ? "start" : anchor == SvgAnchor::kMiddle ? "middle" : "end";
}

}  // namespace

SvgWriter::SvgWriter(double width, double height) {
  body_ = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{0}' height='{1}' viewBox='0 0 {0} {1}' "
      "font-family='Helvetica, Arial, sans-serif' font-size='13' fill='#333'>\n",
      Number(width), Number(height));
}

void SvgWriter::Rectangle(const SvgPoint& corner, double width, double height, std::string_view attributes) {
  body_ += fmt::format("<rect x='{}' y='{}' width='{}' height='{}' {}/>\n", Number(corner.x()), Number(corner.y()),
                       Number(width), Number(height), attributes);
}

void SvgWriter::Circle(const SvgPoint& center, double radius, std::string_view attributes) {
  body_ += fmt::format("<circle cx='{}' cy='{}' r='{}' {}/>\n", Number(center.x()), Number(center.y()), Number(radius),
                       attributes);
}

void SvgWriter::Line(const SvgPoint& from, const SvgPoint& to, std::string_view attributes) {
  body_ += fmt::format("<line x1='{}' y1='{}' x2='{}' y2='{}' {}/>\n", Number(from.x()), Number(from.y()),
                       Number(to.x()), Number(to.y()), attributes);
}

void SvgWriter::Polyline(std::span<const SvgPoint> points, std::string_view attributes) {
  if (points.size() < 2) {
    return;
  }
  body_ += "<polyline points='";
  for (const SvgPoint& point : points) {
    body_ += Number(point.x()) + "," + Number(point.y()) + " ";
  }
  body_.back() = '\'';
  body_ += fmt::format(" fill='none' {}/>\n", attributes);
}

void SvgWriter::Text(const SvgPoint& at, SvgAnchor anchor, std::string_view text, std::string_view attributes) {
  body_ += fmt::format("<text x='{}' y='{}' text-anchor='{}' {}>{}</text>\n", Number(at.x()), Number(at.y()),
                       AnchorName(anchor), attributes, Escaped(text));
}

void SvgWriter::UprightText(const SvgPoint& at, SvgAnchor anchor, std::string_view text, std::string_view attributes) {
  const std::string turn = fmt::format("transform='rotate(-90 {} {})' {}", Number(at.x()), Number(at.y()), attributes);
  Text(at, anchor, text, turn);
}

std::string SvgWriter::Finish() const { return body_ + "</svg>\n"; }

}  // namespace rds
