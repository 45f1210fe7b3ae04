// SPDX-License-Identifier: Apache-2.0
// The picture that explains a frame: the image with its features in the paper's colors, the newest mask, and the map
// seen from above.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "base/ids.h"
#include "base/image.h"
#include "system/frame.h"
#include "system/slam.h"

namespace rds {

// What one picture shows. Copies and shared images, so that it can be drawn on another thread.
struct RunViewContent {
  std::shared_ptr<const Image8> image;  // as recorded, BGR or gray
  FrameResult result;                   // with features (SystemOptions::keep_features)
  MaskView mask;
  std::shared_ptr<const MapView> map;  // may be some frames old; null = none yet
  double frames_per_s = 0;             // measured
  std::string note;                    // to be read below the status; "" = none
};

// Draws pictures of consecutive frames; remembers the path walked and the bounds of the map, so that the view from
// above grows but never jumps. Features: blue static, green unknown, red rejected (the paper's figures 12, 13, 15).
// Not thread-safe. Deterministic.
class RunView {
 public:
  // Size of every picture, for images of this size.
  static int Width(int image_width, int image_height) { return image_width + image_height; }
  static int Height(int image_height) { return image_height; }

  // A BGR picture of Width x Height.
  [[nodiscard]] Image8 Draw(const RunViewContent& content);

 private:
  void GrowBounds(const Eigen::Vector3d& point_in_world);

  WorldId world_;                                            // that the path is in
  std::vector<Eigen::Vector3d> path_in_world_;               // camera centers; meters
  Eigen::Vector2d low_m_ = Eigen::Vector2d::Constant(-0.5);  // of (x, z) in the world
  Eigen::Vector2d high_m_ = Eigen::Vector2d::Constant(0.5);
};

}  // namespace rds
