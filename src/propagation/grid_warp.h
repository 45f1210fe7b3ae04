// SPDX-License-Identifier: Apache-2.0
// Where what one view sees lies in another view of the same camera, in samples of the depth grid.
#pragma once

#include <Eigen/Core>

#include "feature/frame_data.h"
#include "geometry/camera.h"
#include "geometry/rigid3.h"

namespace rds {

// A place of a view: sample (i, j) of the depth grid covers [i, i + 1) x [j, j + 1), so a keypoint lies at its recorded
// pixel over kDepthGridStep.
struct GridPlace {
  float column = 0;
  float row = 0;
  float depth_m = 0;  // not above 0: behind the camera
};

// Takes places of one view to another. In single precision: samples are coarse, and there are many. Distortion of the
// lens, a few pixels, is not taken out.
class GridWarp {
 public:
  GridWarp(const PinholeCamera& camera, const Rigid3& to_from_from) {
    Eigen::Matrix3d k;
    k << camera.fx / kDepthGridStep, 0, camera.cx / kDepthGridStep,  //
        0, camera.fy / kDepthGridStep, camera.cy / kDepthGridStep,   //
        0, 0, 1;
    turn_ = (k * to_from_from.RotationMatrix() * k.inverse()).cast<float>();
    shift_ = (k * to_from_from.translation).cast<float>();
  }

  [[nodiscard]] GridPlace operator()(const GridPlace& from) const {
    const Eigen::Vector3f there = from.depth_m * (turn_ * Eigen::Vector3f(from.column, from.row, 1)) + shift_;
    return {there.x() / there.z(), there.y() / there.z(), there.z()};
  }

 private:
  Eigen::Matrix3f turn_;
  Eigen::Vector3f shift_;
};

}  // namespace rds
