// SPDX-License-Identifier: Apache-2.0
// Camera files of other programs.
#pragma once

#include <filesystem>
#include <optional>

#include "geometry/camera.h"

namespace YAML {
class Node;
}

namespace rds {

// Reads the settings of ORB-SLAM2 and 3, the calibration files of OpenCV, CameraInfo of ROS (files and echoed messages)
// and Open3D's intrinsics. Nothing if the file is none of them. InputError for one whose numbers cannot be read, or
// that does not say the scale of depth (most cannot): the message asks for the line to add.
[[nodiscard]] std::optional<PinholeCamera> ReadForeignCamera(const std::filesystem::path& path, const YAML::Node& root);

}  // namespace rds
