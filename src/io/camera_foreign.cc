// SPDX-License-Identifier: Apache-2.0
#include "io/camera_foreign.h"

#include <spdlog/fmt/fmt.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <initializer_list>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/strict_yaml.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

using Keys = std::initializer_list<const char*>;

constexpr Keys kMatrixKeys = {"camera_matrix", "cameraMatrix", "Camera_Matrix", "K", "k", "intrinsic_matrix"};

// Looks values up under the names that different programs give them.
class ForeignReader {
 public:
  ForeignReader(const fs::path& path, const YAML::Node& root) : path_(path), root_(root) {}

  // The value under the first of the keys that is there; undefined if none is.
  [[nodiscard]] YAML::Node Find(Keys keys) const {
    for (const char* key : keys) {
      if (const YAML::Node node = root_[key]) {
        return node;
      }
    }
    return YAML::Node(YAML::NodeType::Undefined);
  }
  [[nodiscard]] bool Has(Keys keys) const { return Find(keys).IsDefined(); }
  [[nodiscard]] std::optional<double> Number(Keys keys) const {
    const YAML::Node node = Find(keys);
    return node ? std::optional(AsNumber(node)) : std::nullopt;
  }
  [[nodiscard]] double Need(Keys keys) const {
    const std::optional<double> value = Number(keys);
    if (!value) {
      throw InputError(fmt::format("{}: key '{}' is missing", path_.string(), *keys.begin()));
    }
    return *value;
  }
  [[nodiscard]] int NeedSize(Keys keys) const {
    if (!Has(keys)) {
      throw InputError(
          fmt::format("{}: a calibration that does not say the size of the images; add the lines 'width: N' "
                      "and 'height: N'",
                      path_.string()));
    }
    const double value = Need(keys);
    if (!(value >= 1 && value < 20000 && value == std::floor(value))) {
      throw InputError(
          fmt::format("{}: '{}' is {}, it must be a whole number of pixels", path_.string(), *keys.begin(), value));
    }
    return static_cast<int>(value);
  }
  [[nodiscard]] std::string Word(Keys keys) const {
    const YAML::Node node = Find(keys);
    return node && node.IsScalar() ? node.Scalar() : "";
  }
  // A list, a matrix as OpenCV and ROS write it (rows, cols, data), or a list of rows.
  [[nodiscard]] std::vector<double> Numbers(Keys keys) const {
    YAML::Node node = Find(keys);
    if (node && node.IsMap()) {
      node.reset(node["data"]);
    }
    std::vector<double> values;
    if (!node) {
      return values;
    }
    if (!node.IsSequence()) {
      throw InputError(WhereInYaml(path_, node) + ": a list of numbers is wanted");
    }
    for (const YAML::Node& entry : node) {
      if (entry.IsSequence()) {
        for (const YAML::Node& number : entry) {
          values.push_back(AsNumber(number));
        }
      } else {
        values.push_back(AsNumber(entry));
      }
    }
    return values;
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  [[nodiscard]] double AsNumber(const YAML::Node& node) const {
    double value = 0;
    if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !std::isfinite(value)) {
      throw InputError(WhereInYaml(path_, node) + ": a finite number is wanted");
    }
    return value;
  }

  const fs::path& path_;
  const YAML::Node root_;
};

void SetDistortion(const ForeignReader& reader, const std::vector<double>& values, bool fisheye,
                   PinholeCamera& camera) {
  camera.distortion_model = fisheye ? DistortionModel::kFisheye : DistortionModel::kBrownConrady;
  const std::size_t most = fisheye ? 4 : camera.distortion.size();
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i < most) {
      camera.distortion[i] = values[i];
    } else if (values[i] != 0) {
      throw InputError(fmt::format("{}: distortion with {} coefficients is not supported; undistort the images first",
                                   reader.path().string(), values.size()));
    }
  }
}

PinholeCamera ReadOrbSlam(const ForeignReader& reader) {
  PinholeCamera camera;
  camera.fx = reader.Need({"Camera.fx", "Camera1.fx"});
  camera.fy = reader.Need({"Camera.fy", "Camera1.fy"});
  camera.cx = reader.Need({"Camera.cx", "Camera1.cx"});
  camera.cy = reader.Need({"Camera.cy", "Camera1.cy"});
  if (!reader.Has({"Camera.width"}) || !reader.Has({"Camera.height"})) {
    throw InputError(reader.path().string() +
                     ": a settings file of ORB-SLAM without the size of the images; add Camera.width and "
                     "Camera.height");
  }
  camera.width = reader.NeedSize({"Camera.width"});
  camera.height = reader.NeedSize({"Camera.height"});
  const auto value = [&](const char* one, const char* other) { return reader.Number({one, other}).value_or(0); };
  const double k1 = value("Camera.k1", "Camera1.k1");
  const double k2 = value("Camera.k2", "Camera1.k2");
  const double k3 = value("Camera.k3", "Camera1.k3");
  const bool fisheye = reader.Word({"Camera.type"}) == "KannalaBrandt8";
  SetDistortion(reader,
                fisheye ? std::vector{k1, k2, k3, value("Camera.k4", "Camera1.k4")}
                        : std::vector{k1, k2, value("Camera.p1", "Camera1.p1"), value("Camera.p2", "Camera1.p2"), k3},
                fisheye, camera);
  if (const auto baseline_m = reader.Number({"Stereo.b"})) {
    camera.baseline_m = *baseline_m;
  } else if (const auto bf = reader.Number({"Camera.bf"})) {
    camera.baseline_m = *bf / camera.fx;
  }
  return camera;
}

// Intrinsics as a matrix: OpenCV, ROS (row by row), Open3D (column by column).
PinholeCamera ReadMatrix(const ForeignReader& reader) {
  std::vector<double> k = reader.Numbers(kMatrixKeys);
  if (k.size() != 9) {
    throw InputError(
        fmt::format("{}: the camera matrix has {} numbers, 9 are wanted", reader.path().string(), k.size()));
  }
  if (k[2] == 0 && k[5] == 0) {  // column by column
    std::swap(k[2], k[6]);
    std::swap(k[5], k[7]);
  }
  PinholeCamera camera;
  camera.fx = k[0];
  camera.fy = k[4];
  camera.cx = k[2];
  camera.cy = k[5];
  camera.width = reader.NeedSize({"width", "image_width", "image_Width"});
  camera.height = reader.NeedSize({"height", "image_height", "image_Height"});
  const std::string model = reader.Word({"distortion_model"});
  SetDistortion(
      reader,
      reader.Numbers({"distortion_coefficients", "distCoeffs", "Distortion_Coefficients", "dist_coeffs", "D", "d"}),
      model == "equidistant" || model == "fisheye", camera);
  return camera;
}

}  // namespace

std::optional<PinholeCamera> ReadForeignCamera(const fs::path& path, const YAML::Node& root) {
  const ForeignReader reader(path, root);
  const bool orb_slam = reader.Has({"Camera.fx", "Camera1.fx"});
  if (!orb_slam && !reader.Has(kMatrixKeys)) {
    return std::nullopt;
  }
  PinholeCamera camera = orb_slam ? ReadOrbSlam(reader) : ReadMatrix(reader);
  if (!(camera.fx > 0 && camera.fy > 0 && camera.baseline_m > 0)) {
    throw InputError(path.string() + ": focal lengths and baseline must be more than 0");
  }
  const std::optional<double> scale = reader.Number({"depth_scale", "RGBD.DepthMapFactor", "DepthMapFactor"});
  camera.depth_scale = scale.value_or(1000);
  camera.unusual = reader.Word({"unusual"}) == "true";
  if (!scale) {
    throw InputError(fmt::format(
        "{}: a calibration that does not say the scale of depth; add the line 'depth_scale: N' with N the units of a "
        "depth image in a meter (1000 for millimeters, 5000 for TUM)",
        path.string()));
  }
  if (!(*scale > 0)) {
    throw InputError(fmt::format("{}: depth_scale is {}, it must be more than 0", path.string(), *scale));
  }
  return camera;
}

}  // namespace rds
