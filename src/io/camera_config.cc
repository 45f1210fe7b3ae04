#include "io/camera_config.h"

#include <spdlog/fmt/fmt.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/error.h"
#include "base/suggest.h"
#include "io/text_table.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

// TUM and Bonn: the calibrations that the benchmarks publish (640 x 480, depth registered to colour, 5000 units a
// metre). 7-Scenes publishes 585, 320, 240 for its Kinect.
constexpr std::array<NamedCamera, 5> kCameras = {{
    {"tum_fr1",
     {.fx = 517.306408,
      .fy = 516.469215,
      .cx = 318.643040,
      .cy = 255.313989,
      .distortion = {0.262383, -0.953104, -0.005358, 0.002628, 1.163314}}},
    {"tum_fr2",
     {.fx = 520.908620,
      .fy = 521.007327,
      .cx = 325.141442,
      .cy = 249.701764,
      .distortion = {0.231222, -0.784899, -0.003257, -0.000105, 0.917205}}},
    {"tum_fr3", {.fx = 535.4, .fy = 539.2, .cx = 320.1, .cy = 247.6}},
    {"bonn",
     {.fx = 542.822841,
      .fy = 542.576870,
      .cx = 315.593520,
      .cy = 237.756098,
      .distortion = {0.039903, -0.099343, -0.000730, -0.000144, 0.0}}},
    {"redkitchen", {.fx = 585, .fy = 585, .cx = 320, .cy = 240}},
}};

const std::vector<std::string> kKeys = {"width", "height",     "fx",          "fy",        "cx",
                                        "cy",    "distortion", "depth_scale", "baseline_m"};

// Reads typed values out of one YAML mapping; every error names file, line and key.
class CameraReader {
 public:
  CameraReader(const fs::path& path, const YAML::Node& root) : path_(path), root_(root) {}

  void CheckKeys() const {
    std::vector<std::string> seen;
    for (const auto& entry : root_) {
      const std::string key = entry.first.Scalar();
      if (std::find(kKeys.begin(), kKeys.end(), key) == kKeys.end()) {
        throw Error(entry.first, "unknown key '" + key + "'" + Suggestion(key, kKeys));
      }
      if (std::find(seen.begin(), seen.end(), key) != seen.end()) {
        throw Error(entry.first, "key '" + key + "' stands there twice");
      }
      seen.push_back(key);
    }
  }

  // A number in (0, limit), or up to it and whole for sizes.
  [[nodiscard]] double Positive(const char* key, double limit = 1e9) const {
    const double value = Number(Required(key), key);
    if (!(value > 0 && value < limit)) {
      throw Error(root_[key], fmt::format("'{}' is {}, it must be more than 0 and less than {}", key, value, limit));
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
  [[nodiscard]] std::array<double, 5> Distortion() const {
    std::array<double, 5> distortion{};
    const YAML::Node node = root_["distortion"];
    if (!node) {
      return distortion;
    }
    if (!node.IsSequence() || node.size() != distortion.size()) {
      throw Error(node, "'distortion' must be a list of five numbers: [k1, k2, p1, p2, k3]");
    }
    for (std::size_t i = 0; i < distortion.size(); ++i) {
      distortion[i] = Number(node[i], "distortion");
    }
    return distortion;
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
    return InputError(fmt::format("{}:{}: {}", path_.string(), node.Mark().line + 1, what));
  }

  const fs::path& path_;
  const YAML::Node root_;
};

YAML::Node ParseMapping(const fs::path& path) {
  YAML::Node root;
  try {
    root = YAML::Load(ReadFile(path));
  } catch (const YAML::ParserException& error) {
    throw InputError(fmt::format("{}:{}: not YAML: {}", path.string(), error.mark.line + 1, error.msg));
  }
  if (!root.IsMap()) {
    throw InputError(path.string() +
                     ": not a camera file: rows of 'key: value' are wanted; see config/redkitchen.yaml");
  }
  return root;
}

const NamedCamera* FindBuiltIn(std::string_view name) {
  const auto found = std::find_if(kCameras.begin(), kCameras.end(), [&](const auto& c) { return c.name == name; });
  return found == kCameras.end() ? nullptr : &*found;
}

std::string JoinedNames() {
  std::string names;
  for (const NamedCamera& camera : kCameras) {
    names += (names.empty() ? "" : ", ") + std::string(camera.name);
  }
  return names;
}

// True if `word` stands in `text` with no letter or digit on either side.
bool HasWord(std::string_view text, std::string_view word) {
  const auto is_alnum = [&](std::size_t i) { return std::isalnum(static_cast<unsigned char>(text[i])) != 0; };
  for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !is_alnum(at - 1)) && (end == text.size() || !is_alnum(end))) {
      return true;
    }
  }
  return false;
}

std::optional<std::string> RecogniseName(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const char digit : {'1', '2', '3'}) {
    if (HasWord(name, std::string("freiburg") + digit) || HasWord(name, std::string("fr") + digit)) {
      return std::string("tum_fr") + digit;
    }
  }
  return HasWord(name, "bonn") ? std::optional<std::string>("bonn") : std::nullopt;
}

}  // namespace

std::span<const NamedCamera> BuiltInCameras() { return kCameras; }

std::vector<std::string> BuiltInCameraNames() {
  std::vector<std::string> names;
  for (const NamedCamera& camera : kCameras) {
    names.emplace_back(camera.name);
  }
  return names;
}

PinholeCamera ReadCamera(const fs::path& path) {
  const CameraReader reader(path, ParseMapping(path));
  reader.CheckKeys();
  PinholeCamera camera;
  camera.width = reader.Size("width");
  camera.height = reader.Size("height");
  camera.fx = reader.Positive("fx");
  camera.fy = reader.Positive("fy");
  camera.cx = reader.Positive("cx", camera.width);
  camera.cy = reader.Positive("cy", camera.height);
  camera.depth_scale = reader.Positive("depth_scale");
  camera.distortion = reader.Distortion();
  if (reader.Has("baseline_m")) {
    camera.baseline_m = reader.Positive("baseline_m");
  }
  return camera;
}

PinholeCamera FindCamera(const std::string& name_or_path) {
  if (const NamedCamera* camera = FindBuiltIn(name_or_path)) {
    return camera->camera;
  }
  std::error_code ignored;
  if (!fs::exists(name_or_path, ignored)) {
    throw InputError(fmt::format("camera '{}': neither a file nor a built-in camera{}; built in are {}", name_or_path,
                                 Suggestion(fs::path(name_or_path).stem().string(), BuiltInCameraNames()),
                                 JoinedNames()));
  }
  return ReadCamera(name_or_path);
}

std::string FormatCamera(const PinholeCamera& camera) {
  const auto& d = camera.distortion;
  return fmt::format(
      "width: {}  # pixels\nheight: {}\nfx: {}  # pixels\nfy: {}\ncx: {}\ncy: {}\n"
      "distortion: [{}, {}, {}, {}, {}]  # k1, k2, p1, p2, k3\n"
      "depth_scale: {}  # units of a depth image in a metre\nbaseline_m: {}\n",
      camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy, d[0], d[1], d[2], d[3], d[4],
      camera.depth_scale, camera.baseline_m);
}

std::optional<std::string> RecogniseCamera(const fs::path& sequence_folder) {
  std::error_code ignored;
  fs::path folder = fs::weakly_canonical(sequence_folder, ignored);
  if (!folder.has_filename()) {
    folder = folder.parent_path();
  }
  const std::optional<std::string> name = RecogniseName(folder.filename().string());
  return name ? name : RecogniseName(folder.parent_path().filename().string());
}

PinholeCamera CameraOfSequence(const fs::path& sequence_folder, const std::string& name_or_path) {
  if (!name_or_path.empty()) {
    return FindCamera(name_or_path);
  }
  const fs::path own = sequence_folder / "camera.yaml";
  std::error_code ignored;
  if (fs::exists(own, ignored)) {
    return ReadCamera(own);
  }
  if (const std::optional<std::string> name = RecogniseCamera(sequence_folder)) {
    return FindBuiltIn(*name)->camera;
  }
  throw InputError(fmt::format(
      "{}: the camera is not recognised from the folder's name: give it with --camera. Built in are {}; for another "
      "camera copy config/redkitchen.yaml, put your numbers in, and give that file, or lay it beside the images as "
      "camera.yaml",
      sequence_folder.string(), JoinedNames()));
}

}  // namespace rds
