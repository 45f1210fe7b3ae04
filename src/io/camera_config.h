// SPDX-License-Identifier: Apache-2.0
// Which camera recorded a sequence: a file, a built-in one by name, or as the folder tells.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/camera.h"
#include "io/known_cameras.h"

namespace rds {

std::vector<std::string> BuiltInCameraNames();

// A built-in camera by its bare name ("tum_fr3"), else the file of that path. InputError listing the names otherwise.
PinholeCamera FindCamera(const std::string& name_or_path);

// Name of the built-in camera that recorded a TUM or Bonn sequence, from the names of its folder and the folder above:
// rgbd_dataset_freiburg1_desk, fr1/desk and fr1_desk give tum_fr1; rgbd_bonn_balloon gives bonn.
std::optional<std::string> RecognizeCamera(const std::filesystem::path& sequence_folder);

// A camera and, for people, what it is called and why it was taken.
struct FoundCamera {
  PinholeCamera camera;
  std::string name;    // "tum_fr3", "file path/camera.yaml"
  std::string reason;  // "from the sequence's folder"
};

// The camera of a sequence: `name_or_path` if given (not empty); else camera.yaml in the sequence's folder; else as
// recognized from the folder's name. Else InputError that asks for --camera and says how to write a camera file.
FoundCamera CameraOfSequence(const std::filesystem::path& sequence_folder, const std::string& name_or_path);

}  // namespace rds
