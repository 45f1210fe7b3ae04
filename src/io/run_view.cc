// SPDX-License-Identifier: Apache-2.0
#include "io/run_view.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "base/error.h"

namespace rds {
namespace {

const cv::Scalar kStaticColor(235, 110, 30);
const cv::Scalar kUnknownColor(60, 200, 60);
const cv::Scalar kRejectedColor(50, 50, 235);
const cv::Scalar kBackground(250, 250, 250);
const cv::Scalar kPointColor(150, 150, 150);
const cv::Scalar kPathColor(200, 90, 20);
const cv::Scalar kText(255, 255, 255);
constexpr int kBarHeight = 22;
constexpr double kFontScale = 0.42;

cv::Mat View(Image8& image) {
  return {image.height, image.width, image.channels == 3 ? CV_8UC3 : CV_8UC1, image.data.data()};
}

// A view for reading only.
cv::Mat View(const Image8& image) { return View(const_cast<Image8&>(image)); }

void PutText(cv::Mat& canvas, const std::string& text, cv::Point at, const cv::Scalar& color = kText) {
  cv::putText(canvas, text, at, cv::FONT_HERSHEY_SIMPLEX, kFontScale, color, 1, cv::LINE_AA);
}

// A dark bar to write on.
void Darken(cv::Mat area) { area.convertTo(area, -1, 0.35); }

void DrawFeatures(const std::vector<FeatureView>& features, cv::Mat& canvas) {
  for (const FeatureView& feature : features) {
    const cv::Point at(static_cast<int>(std::lround(feature.x)), static_cast<int>(std::lround(feature.y)));
    switch (feature.state) {
      case FeatureState::kUnmatched:
        break;
      case FeatureState::kStatic:
        cv::circle(canvas, at, 3, kStaticColor, cv::FILLED, cv::LINE_AA);
        break;
      case FeatureState::kUnknown:
        cv::circle(canvas, at, 3, kUnknownColor, cv::FILLED, cv::LINE_AA);
        break;
      case FeatureState::kRejected:
        cv::circle(canvas, at, 3, kRejectedColor, cv::FILLED, cv::LINE_AA);
        break;
    }
  }
}

// The newest mask, small, in the lower left corner.
void DrawMask(const MaskView& mask, const FrameResult& result, cv::Mat& canvas) {
  if (mask.mask == nullptr || mask.mask->empty()) {
    return;
  }
  const cv::Size size(canvas.cols / 4, canvas.rows / 4);
  cv::Mat small;
  cv::resize(View(*mask.mask), small, size, 0, 0, cv::INTER_NEAREST);
  cv::Mat inset = canvas(cv::Rect({6, canvas.rows - size.height - 6}, size));
  Darken(inset);
  inset.setTo(kRejectedColor, small);
  cv::rectangle(canvas, cv::Rect({5, canvas.rows - size.height - 7}, size + cv::Size(2, 2)), kText, 1);
  const auto age = static_cast<long>(result.frame.value) - static_cast<long>(mask.frame.value);
  PutText(inset, fmt::format("mask: {} frames old", age), {4, 13});
}

void DrawStatus(const RunViewContent& content, cv::Mat& canvas) {
  const FrameResult& result = content.result;
  const std::string delay = result.semantic_delay_frames
                                ? fmt::format("  semantic delay {} frames", *result.semantic_delay_frames)
                                : std::string();
  Darken(canvas(cv::Rect(0, 0, canvas.cols, kBarHeight)));
  PutText(canvas,
          fmt::format("frame {}  {}  {:.1f} fps{}", result.frame.value, ToString(result.state), content.frames_per_s,
                      delay),
          {6, 15});
  if (!content.note.empty()) {
    Darken(canvas(cv::Rect(0, kBarHeight, canvas.cols, kBarHeight)));
    PutText(canvas, content.note, {6, kBarHeight + 15});
  }
}

void DrawLegend(const FrameResult& result, cv::Mat& canvas) {
  const int top = canvas.rows - kBarHeight;
  const int left = canvas.cols / 4 + 14;
  Darken(canvas(cv::Rect(left, top, canvas.cols - left, kBarHeight)));
  int x = left + 8;
  const auto item = [&](const std::string& text, const cv::Scalar& color) {
    cv::circle(canvas, {x + 4, top + 11}, 4, color, cv::FILLED, cv::LINE_AA);
    PutText(canvas, text, {x + 13, top + 15});
    x += 13 + cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, kFontScale, 1, nullptr).width + 14;
  };
  item(fmt::format("static {}", result.static_matches), kStaticColor);
  item(fmt::format("unknown {}", result.unknown_matches), kUnknownColor);
  item(fmt::format("rejected {}", result.rejected_matches), kRejectedColor);
}

// The plane of x (to the right) and z (upwards in the picture) of the world, fitted into a square.
class TopView {
 public:
  TopView(cv::Mat canvas, const Eigen::Vector2d& low_m, const Eigen::Vector2d& high_m) : canvas_(std::move(canvas)) {
    const double extent_m = (high_m - low_m).maxCoeff() * 1.08;
    px_per_m_ = canvas_.rows / extent_m;
    center_m_ = (low_m + high_m) / 2;
    canvas_.setTo(kBackground);
  }

  [[nodiscard]] cv::Point At(const Eigen::Vector3d& point_in_world) const {
    const auto pixel = [](double value) { return static_cast<int>(std::lround(std::clamp(value, -1e4, 1e4))); };
    return {pixel(canvas_.cols / 2.0 + (point_in_world.x() - center_m_.x()) * px_per_m_),
            pixel(canvas_.rows / 2.0 - (point_in_world.z() - center_m_.y()) * px_per_m_)};
  }

  void DrawPoints(const MapView& map) {
    const cv::Rect bounds(1, 1, canvas_.cols - 2, canvas_.rows - 2);
    for (std::size_t i = 0; i < map.points.size(); ++i) {
      const cv::Point at = At(map.points[i].cast<double>());
      if (bounds.contains(at)) {
        const bool moves = i < map.moving_probability.size() && map.moving_probability[i] > 0.6F;
        cv::circle(canvas_, at, 1, moves ? kRejectedColor : kPointColor, cv::FILLED);
      }
    }
  }

  void DrawPath(const std::vector<Eigen::Vector3d>& path_in_world) {
    for (std::size_t i = 1; i < path_in_world.size(); ++i) {
      cv::line(canvas_, At(path_in_world[i - 1]), At(path_in_world[i]), kPathColor, 2, cv::LINE_AA);
    }
  }

  // The camera as a triangle that opens in the direction of view.
  void DrawCamera(const Rigid3& world_from_camera) {
    const double size_m = 14 / px_per_m_;
    const cv::Point apex = At(world_from_camera.translation);
    const cv::Point left = At(world_from_camera * Eigen::Vector3d(-0.6 * size_m, 0, size_m));
    const cv::Point right = At(world_from_camera * Eigen::Vector3d(0.6 * size_m, 0, size_m));
    const std::vector<cv::Point> triangle = {apex, left, right};
    cv::fillConvexPoly(canvas_, triangle, kUnknownColor, cv::LINE_AA);
    cv::polylines(canvas_, triangle, true, cv::Scalar(40, 90, 40), 1, cv::LINE_AA);
  }

  void DrawCaption(const FrameResult& result) {
    const cv::Scalar dark(60, 60, 60);
    PutText(canvas_, fmt::format("from above: {} keyframes, {} points", result.keyframes_in_map, result.points_in_map),
            {8, 16}, dark);
    const cv::Point from(10, canvas_.rows - 12);
    const cv::Point to(from.x + static_cast<int>(std::lround(px_per_m_)), from.y);
    cv::line(canvas_, from, to, dark, 2);
    PutText(canvas_, "1 m", {from.x, from.y - 6}, dark);
  }

 private:
  cv::Mat canvas_;
  double px_per_m_ = 1;
  Eigen::Vector2d center_m_;
};

}  // namespace

void RunView::GrowBounds(const Eigen::Vector3d& point_in_world) {
  const Eigen::Vector2d at(point_in_world.x(), point_in_world.z());
  low_m_ = low_m_.cwiseMin(at);
  high_m_ = high_m_.cwiseMax(at);
}

Image8 RunView::Draw(const RunViewContent& content) {
  Check(content.image != nullptr && !content.image->empty(), "a view needs an image");
  const Image8& image = *content.image;
  Image8 picture(Width(image.width, image.height), Height(image.height), 3);
  cv::Mat canvas = View(picture);

  cv::Mat left = canvas(cv::Rect(0, 0, image.width, image.height));
  if (image.channels == 3) {
    View(image).copyTo(left);
  } else {
    cv::cvtColor(View(image), left, cv::COLOR_GRAY2BGR);
  }
  DrawFeatures(content.result.features, left);
  DrawMask(content.mask, content.result, left);
  DrawStatus(content, left);
  DrawLegend(content.result, left);

  if (content.result.world_from_camera && content.result.world != world_) {  // the path before has no place in this one
    world_ = content.result.world;
    path_in_world_.clear();
  }
  if (content.result.world_from_camera) {
    path_in_world_.push_back(content.result.world_from_camera->translation);
    GrowBounds(path_in_world_.back());
  }
  if (content.map != nullptr) {
    // Bounds from what lies within 4 m of the camera's path: far points are few, noisy and would shrink the rest.
    for (const Eigen::Vector3f& point : content.map->points) {
      if (!path_in_world_.empty() && (point.cast<double>() - path_in_world_.back()).norm() < 4.0) {
        GrowBounds(point.cast<double>());
      }
    }
  }
  TopView top(canvas(cv::Rect(image.width, 0, image.height, image.height)), low_m_, high_m_);
  if (content.map != nullptr) {
    top.DrawPoints(*content.map);
  }
  top.DrawPath(path_in_world_);
  if (content.result.world_from_camera) {
    top.DrawCamera(*content.result.world_from_camera);
  }
  top.DrawCaption(content.result);
  return picture;
}

}  // namespace rds
