// SPDX-License-Identifier: Apache-2.0
#include "io/camera_file.h"

#include <spdlog/fmt/fmt.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/strict_yaml.h"
#include "base/suggest.h"
#include "feature/undistortion.h"
#include "geometry/distortion.h"
#include "io/camera_foreign.h"
#include "io/camera_plausibility.h"
#include "io/known_cameras.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

constexpr double kMostRollingShutter_s = 0.1;
constexpr double kStereoNoise_px = 0.25;  // of a disparity at a corner
constexpr double kLeastDepthNoise_m = 1e-4;

const std::vector<std::string> kKeys = {"width",       "height",     "fx",          "fy",
                                        "cx",          "cy",         "distortion",  "distortion_model",
                                        "depth_scale", "baseline_m", "depth_noise", "rolling_shutter_s",
                                        "unusual"};

// Reads typed values out of one YAML mapping; every error names file, line and key.
class CameraReader {
 public:
  CameraReader(const fs::path& path, const YAML::Node& root) : path_(path), root_(root) {}

  void CheckKeys() const {
    for (const auto& entry : root_) {
      const std::string key = entry.first.Scalar();
      if (std::find(kKeys.begin(), kKeys.end(), key) == kKeys.end()) {
        throw Error(entry.first, "unknown key '" + key + "'" + Suggestion(key, kKeys));
      }
    }
  }

  // A number in (0, limit), or up to it and whole for sizes.
  [[nodiscard]] double Positive(const char* key, double limit = 1e9) const {
    const double value = Number(Required(key), key);
    if (!(value > 0 && value < limit)) {
      const bool mirrored = value < 0 && std::string(key) == "fy";  // ICL-NUIM's files
      throw Error(root_[key],
                  fmt::format("'{}' is {}, it must be more than 0 and less than {}{}", key, value, limit,
                              mirrored ? fmt::format("; write {}, rows are counted from above", -value) : ""));
    }
    return value;
  }
  [[nodiscard]] int Size(const char* key) const {
    const double value = Positive(key, 20000);
    if (value != std::floor(value)) {
      throw Error(root_[key], fmt::format("'{}' is {}, it must be a whole number of pixels", key, value));
    }
    return static_cast<int>(value);
  }
  [[nodiscard]] double Within(const char* key, double least, double most) const {
    const double value = Number(Required(key), key);
    if (!(value >= least && value <= most)) {
      throw Error(root_[key], fmt::format("'{}' is {}, it must be from {} to {}", key, value, least, most));
    }
    return value;
  }
  // A kind of sensor, or two numbers.
  void ReadDepthNoise(PinholeCamera& camera) const {
    const YAML::Node node = root_["depth_noise"];
    if (!node) {
      return;
    }
    const std::string name = node.IsScalar() ? node.Scalar() : "";
    if (name == "structured_light") {
      camera.depth_noise = DepthNoiseModel{};
    } else if (name == "stereo") {
      camera.depth_noise = {0.002, kStereoNoise_px / (camera.fx * camera.baseline_m)};
    } else if (name == "time_of_flight") {
      camera.depth_noise = {0.01, 0};
    } else if (node.IsSequence() && node.size() == 2) {
      camera.depth_noise = {Number(node[0], "depth_noise"), Number(node[1], "depth_noise")};
      if (!(camera.depth_noise.constant_m >= 0 && camera.depth_noise.constant_m <= 1 &&
            camera.depth_noise.quadratic_per_m >= 0 && camera.depth_noise.quadratic_per_m <= 1 &&
            camera.depth_noise.Sigma_m(1) >= kLeastDepthNoise_m)) {
        throw Error(node, "'depth_noise' must be two numbers from 0 to 1, of a tenth of a millimeter at 1 m at least");
      }
    } else {
      throw Error(node,
                  "'depth_noise' must be structured_light, stereo or time_of_flight, or [constant in m, quadratic in "
                  "1/m]: the standard deviation at a depth is constant + quadratic * depth^2");
    }
  }
  // Four numbers or five, or eight with the rational model.
  void ReadDistortion(PinholeCamera& camera) const {
    const YAML::Node model = root_["distortion_model"];
    if (model) {
      const std::string name = model.IsScalar() ? model.Scalar() : "";
      if (name != "brown_conrady" && name != "fisheye") {
        throw Error(model, "'distortion_model' must be brown_conrady or fisheye");
      }
      camera.distortion_model = name == "fisheye" ? DistortionModel::kFisheye : DistortionModel::kBrownConrady;
    }
    const YAML::Node node = root_["distortion"];
    if (!node) {
      return;
    }
    const bool fisheye = camera.distortion_model == DistortionModel::kFisheye;
    const std::size_t count = node.IsSequence() ? node.size() : 0;
    if (count != 4 && (fisheye || (count != 5 && count != 8))) {
      throw Error(node, fisheye ? "'distortion' must be a list of four numbers: [k1, k2, k3, k4]"
                                : "'distortion' must be a list of five numbers: [k1, k2, p1, p2, k3], or of eight with "
                                  "k4, k5, k6 of the rational model");
    }
    for (std::size_t i = 0; i < count; ++i) {
      camera.distortion[i] = Number(node[i], "distortion");
    }
  }
  [[nodiscard]] bool IsUnusual() const {
    const YAML::Node node = root_["unusual"];
    bool value = false;
    if (node && !(node.IsScalar() && YAML::convert<bool>::decode(node, value))) {
      throw Error(node, "'unusual' must be true or false");
    }
    return value;
  }
  [[nodiscard]] bool Has(const char* key) const { return root_[key].IsDefined(); }

 private:
  [[nodiscard]] YAML::Node Required(const char* key) const {
    if (!Has(key)) {
      throw InputError(
          fmt::format("{}: key '{}' is missing; see config/redkitchen.yaml for a whole file", path_.string(), key));
    }
    return root_[key];
  }
  [[nodiscard]] double Number(const YAML::Node& node, const char* key) const {
    double value = 0;
    if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !std::isfinite(value)) {
      throw Error(node, fmt::format("'{}' must be a finite number{}", key,
                                    node.IsScalar() ? ", not '" + node.Scalar() + "'" : std::string()));
    }
    return value;
  }
  [[nodiscard]] InputError Error(const YAML::Node& node, const std::string& what) const {
    return InputError(WhereInYaml(path_, node) + ": " + what);
  }

  const fs::path& path_;
  const YAML::Node root_;
};

void TakeKnownSensor(PinholeCamera& camera) {
  if (const NamedCamera* known = FindKnownCamera(camera)) {
    camera.depth_noise = known->camera.depth_noise;
    camera.rolling_shutter_s = known->camera.rolling_shutter_s;
  }
}

PinholeCamera ReadOwn(const fs::path& path, const YAML::Node& root) {
  const CameraReader reader(path, root);
  reader.CheckKeys();
  PinholeCamera camera;
  camera.width = reader.Size("width");
  camera.height = reader.Size("height");
  camera.fx = reader.Positive("fx");
  camera.fy = reader.Positive("fy");
  camera.cx = reader.Positive("cx", camera.width);
  camera.cy = reader.Positive("cy", camera.height);
  camera.depth_scale = reader.Positive("depth_scale");
  reader.ReadDistortion(camera);
  if (reader.Has("baseline_m")) {
    camera.baseline_m = reader.Positive("baseline_m");
  }
  TakeKnownSensor(camera);
  reader.ReadDepthNoise(camera);
  if (reader.Has("rolling_shutter_s")) {
    camera.rolling_shutter_s = reader.Within("rolling_shutter_s", 0, kMostRollingShutter_s);
  }
  camera.unusual = reader.IsUnusual();
  return camera;
}

// Undistorted pixels must come back to where they were: else the iteration that undoes the distortion fails.
bool CanBeUndistorted(const PinholeCamera& camera) {
  constexpr int kStep_px = 16;
  constexpr double kMost_px = 1;
  std::vector<Eigen::Vector2f> raw;
  for (int y = 0; y <= camera.height; y += kStep_px) {
    for (int x = 0; x <= camera.width; x += kStep_px) {
      raw.emplace_back(std::min(x, camera.width - 1), std::min(y, camera.height - 1));
    }
  }
  std::vector<Eigen::Vector2f> undistorted = raw;
  UndistortPixels(camera, undistorted);
  for (std::size_t i = 0; i < raw.size(); ++i) {
    const Eigen::Vector2d pixel = undistorted[i].cast<double>();
    const Eigen::Vector2d again =
        Distort(camera, {(pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy});
    const Eigen::Vector2d back{camera.fx * again.x() + camera.cx, camera.fy * again.y() + camera.cy};
    if (!((back - raw[i].cast<double>()).norm() < kMost_px)) {
      return false;
    }
  }
  return true;
}

}  // namespace

PinholeCamera ReadCamera(const fs::path& path) {
  const YAML::Node root = ReadStrictYaml(path);
  if (!root.IsMap()) {
    throw InputError(path.string() +
                     ": not a camera file: rows of 'key: value' are wanted; see config/redkitchen.yaml");
  }
  std::optional<PinholeCamera> foreign = ReadForeignCamera(path, root);
  if (foreign) {
    TakeKnownSensor(*foreign);
  }
  const PinholeCamera camera = foreign ? *foreign : ReadOwn(path, root);
  if (const auto problem = CameraProblem(camera); problem && !camera.unusual) {
    throw InputError(
        fmt::format("{}: {} (if it is right all the same, add the line 'unusual: true')", path.string(), *problem));
  }
  if (camera.HasDistortion()) {
    const auto problem = DistortionProblem(camera);
    if (problem || !CanBeUndistorted(camera)) {
      throw InputError(fmt::format(
          "{}: distortion: {}; are the coefficients in the order k1, k2, p1, p2, k3 (fisheye: k1, k2, k3, k4), and "
          "of this camera?",
          path.string(), problem.value_or("it is too strong to be undone; undistort the images first")));
    }
  }
  return camera;
}

std::string FormatCamera(const PinholeCamera& camera) {
  const auto& d = camera.distortion;
  const bool fisheye = camera.distortion_model == DistortionModel::kFisheye;
  const bool rational = d[5] != 0 || d[6] != 0 || d[7] != 0;
  const std::size_t count = fisheye ? 4 : rational ? 8 : 5;
  return fmt::format(
      "width: {}  # pixels\nheight: {}\nfx: {}  # pixels\nfy: {}\ncx: {}\ncy: {}\n"
      "{}distortion: [{}]  # {}\n"
      "depth_scale: {}  # units of a depth image in a meter\nbaseline_m: {}\n"
      "depth_noise: [{}, {}]  # standard deviation, m: constant + quadratic * depth^2\n"
      "rolling_shutter_s: {}  # from the first row to the last\n{}",
      camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy,
      fisheye ? "distortion_model: fisheye\n" : "",
      fmt::join(d.begin(), d.begin() + static_cast<std::ptrdiff_t>(count), ", "),
      fisheye    ? "k1, k2, k3, k4"
      : rational ? "k1, k2, p1, p2, k3, k4, k5, k6"
                 : "k1, k2, p1, p2, k3",
      camera.depth_scale, camera.baseline_m, camera.depth_noise.constant_m, camera.depth_noise.quadratic_per_m,
      camera.rolling_shutter_s, camera.unusual ? "unusual: true\n" : "");
}

}  // namespace rds
