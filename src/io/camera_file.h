// SPDX-License-Identifier: Apache-2.0
// Camera files: YAML with the intrinsics of a registered RGB-D camera.
#pragma once

#include <filesystem>
#include <string>

#include "geometry/camera.h"

namespace rds {

// Reads a camera file. Keys: width, height, fx, fy, cx, cy, depth_scale (all required), distortion (4 to 8 numbers),
// distortion_model (brown_conrady or fisheye), baseline_m, depth_noise (a kind of sensor or [constant, quadratic]),
// rolling_shutter_s (both as in PinholeCamera; without them those of a known camera with the same numbers), and
// unusual: true for numbers that are right although no known camera has them. Files of ORB-SLAM, OpenCV's calibration,
// ROS (CameraInfo) and Open3D are read as well; those that say nothing of depth want the key depth_scale added.
// InputError, naming file, line and key, for a file that cannot be read or parsed, a missing, unknown or repeated key,
// a wrong type, a value out of range, a distortion that cannot be undone, and numbers that no RGB-D camera has, with
// what was likely meant.
PinholeCamera ReadCamera(const std::filesystem::path& path);

// The text of a camera file; ReadCamera gives exactly the same camera back.
std::string FormatCamera(const PinholeCamera& camera);

}  // namespace rds
