// SPDX-License-Identifier: Apache-2.0
#include "feature/undistortion.h"

#include <opencv2/calib3d.hpp>

namespace rds {

void UndistortPixels(const PinholeCamera& camera, std::span<Eigen::Vector2f> pixels) {
  if (pixels.empty()) {
    return;
  }
  const cv::Matx33d k(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  cv::Mat points(static_cast<int>(pixels.size()), 1, CV_32FC2, pixels.data()->data());
  cv::Mat undistorted;
  if (camera.distortion_model == DistortionModel::kFisheye) {
    const cv::Vec4d coefficients(camera.distortion.data());
    cv::fisheye::undistortPoints(points, undistorted, k, coefficients, cv::noArray(), k);
  } else {
    cv::undistortPoints(points, undistorted, k, cv::Mat(camera.distortion), cv::noArray(), k);
  }
  undistorted.copyTo(points);
}

}  // namespace rds
