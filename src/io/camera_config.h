// Camera files: YAML with the intrinsics of a registered RGB-D camera. The published ones are compiled in.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/camera.h"

namespace rds {

// A camera that needs no file; config/<name>.yaml holds the same numbers, to be copied and changed.
struct NamedCamera {
  std::string_view name;
  PinholeCamera camera;
};

// tum_fr1, tum_fr2, tum_fr3, bonn, redkitchen.
std::span<const NamedCamera> BuiltInCameras();
std::vector<std::string> BuiltInCameraNames();

// Reads a camera file. Keys: width, height, fx, fy, cx, cy, depth_scale (all required), distortion (k1, k2, p1, p2, k3)
// and baseline_m. InputError, naming file, line and key, for a file that cannot be read or parsed, a missing, unknown
// or repeated key, a wrong type and a value out of range.
PinholeCamera ReadCamera(const std::filesystem::path& path);

// A built-in camera by its bare name ("tum_fr3"), else the file of that path. InputError listing the names otherwise.
PinholeCamera FindCamera(const std::string& name_or_path);

// The text of a camera file; ReadCamera gives exactly the same camera back.
std::string FormatCamera(const PinholeCamera& camera);

// Name of the built-in camera that recorded a TUM or Bonn sequence, from the names of its folder and the folder above:
// rgbd_dataset_freiburg1_desk, fr1/desk and fr1_desk give tum_fr1; rgbd_bonn_balloon gives bonn.
std::optional<std::string> RecogniseCamera(const std::filesystem::path& sequence_folder);

// The camera of a sequence: `name_or_path` if given (not empty); else camera.yaml in the sequence's folder; else as
// recognised from the folder's name. Else InputError that asks for --camera and says how to write a camera file.
PinholeCamera CameraOfSequence(const std::filesystem::path& sequence_folder, const std::string& name_or_path);

}  // namespace rds
