// SPDX-License-Identifier: Apache-2.0
#include "io/camera_config.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cctype>

#include "base/error.h"
#include "base/suggest.h"
#include "io/camera_file.h"
#include "io/known_cameras.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

const NamedCamera* FindBuiltIn(std::string_view name) {
  const auto cameras = BuiltInCameras();
  const auto found = std::ranges::find(cameras, name, &NamedCamera::name);
  return found == cameras.end() ? nullptr : &*found;
}

std::string JoinedNames() {
  std::string names;
  for (const NamedCamera& camera : BuiltInCameras()) {
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

std::optional<std::string> RecognizeName(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const char digit : {'1', '2', '3'}) {
    if (HasWord(name, std::string("freiburg") + digit) || HasWord(name, std::string("fr") + digit)) {
      return std::string("tum_fr") + digit;
    }
  }
  return HasWord(name, "bonn") ? std::optional<std::string>("bonn") : std::nullopt;
}

struct RecognizedCamera {
  std::string name;
  std::string folder;  // whose name tells
};

std::optional<RecognizedCamera> Recognize(const fs::path& sequence_folder) {
  std::error_code ignored;
  fs::path folder = fs::weakly_canonical(sequence_folder, ignored);
  if (!folder.has_filename()) {
    folder = folder.parent_path();
  }
  for (const fs::path& named : {folder, folder.parent_path()}) {
    if (const std::optional<std::string> name = RecognizeName(named.filename().string())) {
      return RecognizedCamera{*name, named.filename().string()};
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::string> BuiltInCameraNames() {
  std::vector<std::string> names;
  for (const NamedCamera& camera : BuiltInCameras()) {
    names.emplace_back(camera.name);
  }
  return names;
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

std::optional<std::string> RecognizeCamera(const fs::path& sequence_folder) {
  const std::optional<RecognizedCamera> found = Recognize(sequence_folder);
  return found ? std::optional(found->name) : std::nullopt;
}

FoundCamera CameraOfSequence(const fs::path& sequence_folder, const std::string& name_or_path) {
  if (!name_or_path.empty()) {
    const bool built_in = FindBuiltIn(name_or_path) != nullptr;
    return {FindCamera(name_or_path), built_in ? name_or_path : "file " + name_or_path, "as given with --camera"};
  }
  const fs::path own = sequence_folder / "camera.yaml";
  std::error_code ignored;
  if (fs::exists(own, ignored)) {
    return {ReadCamera(own), "file " + own.string(), "from the sequence's folder"};
  }
  if (const std::optional<RecognizedCamera> found = Recognize(sequence_folder)) {
    return {FindBuiltIn(found->name)->camera, found->name, "recognized from the folder's name '" + found->folder + "'"};
  }
  throw InputError(fmt::format(
      "{}: the camera is not recognized from the folder's name: give it with --camera. Built in are {}; for another "
      "camera copy config/redkitchen.yaml, put your numbers in, and give that file, or lay it beside the images as "
      "camera.yaml",
      sequence_folder.string(), JoinedNames()));
}

}  // namespace rds
