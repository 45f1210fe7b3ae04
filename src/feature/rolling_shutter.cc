// SPDX-License-Identifier: Apache-2.0
#include "feature/rolling_shutter.h"

namespace rds {

void CorrectRollingShutter(const PinholeCamera& camera, const Tangent6& velocity, std::vector<Keypoint>& keypoints) {
  if (camera.rolling_shutter_s == 0 || velocity.isZero(0)) {
    return;
  }
  for (Keypoint& keypoint : keypoints) {
    const double after_s = (static_cast<double>(keypoint.raw_y) / camera.height - 0.5) * camera.rolling_shutter_s;
    const Eigen::Vector3d ray = camera.Unproject(keypoint.Pixel(), 1);
    const double inverse_depth = keypoint.HasDepth() ? 1 / static_cast<double>(keypoint.depth_m) : 0;
    const Eigen::Vector3d motion = inverse_depth * velocity.head<3>() + velocity.tail<3>().cross(ray);
    keypoint.x -= static_cast<float>(after_s * camera.fx * (motion.x() - ray.x() * motion.z()));
    keypoint.y -= static_cast<float>(after_s * camera.fy * (motion.y() - ray.y() * motion.z()));
  }
}

}  // namespace rds
