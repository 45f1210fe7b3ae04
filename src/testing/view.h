// SPDX-License-Identifier: Apache-2.0
// What a camera of tests sees of a point.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "feature/frame_data.h"
#include "geometry/camera.h"
#include "geometry/rigid3.h"

namespace rds {

// 640 x 480 pixels, 500 pixels of focal length, no distortion.
inline PinholeCamera TestCamera() {
  PinholeCamera camera;
  camera.fx = camera.fy = 500;
  camera.cx = 320;
  camera.cy = 240;
  return camera;
}

// The exact keypoint that TestCamera has of a point in the world, with or without its depth; octave and angle 0.
inline Keypoint See(const Rigid3& camera_from_world, const Eigen::Vector3d& point, bool depth = true) {
  const PinholeCamera camera = TestCamera();
  const Eigen::Vector3d in_camera = camera_from_world * point;
  const Eigen::Vector2d pixel = camera.Project(in_camera);
  Keypoint keypoint;
  keypoint.x = keypoint.raw_x = static_cast<float>(pixel.x());
  keypoint.y = keypoint.raw_y = static_cast<float>(pixel.y());
  if (depth) {
    keypoint.depth_m = static_cast<float>(in_camera.z());
    keypoint.depth_sigma_m = static_cast<float>(camera.depth_noise.Sigma_m(in_camera.z()));
  }
  return keypoint;
}

// A frame of TestCamera with these keypoints, which look all alike.
inline std::shared_ptr<const FrameData> FrameOf(std::vector<Keypoint> keypoints) {
  std::vector<Descriptor> descriptors(keypoints.size());
  return std::make_shared<const FrameData>(TestCamera(), std::move(keypoints), std::move(descriptors));
}

}  // namespace rds
