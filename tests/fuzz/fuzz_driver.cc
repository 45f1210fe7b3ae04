// SPDX-License-Identifier: Apache-2.0
// Reads what people give the program, one input after the other, for the fuzzer beside it: lines "KIND PATH" on
// standard input, and a line "ok ..." or "error ..." for each on standard output. Anything but InputError ends it.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <string>

#include "base/error.h"
#include "base/file.h"
#include "base/strict_yaml.h"
#include "eval/evaluation.h"
#include "eval/plot.h"
#include "io/archive.h"
#include "io/camera_file.h"
#include "io/dataset.h"
#include "io/image_io.h"
#include "io/options_yaml.h"
#include "io/trajectory_io.h"
#include "segmentation/inference_protocol.h"
#include "segmentation/segmentation_model.h"
#include "system/slam.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

// Pixels go to PATH.pixels, for a judge.
template <typename T>
std::string Pixels(const fs::path& path, const Image<T>& image) {
  std::ofstream(path.string() + ".pixels", std::ios::binary)
      .write(reinterpret_cast<const char*>(image.data.data()),
             static_cast<std::streamsize>(image.data.size() * sizeof(T)));
  return std::to_string(image.width) + " " + std::to_string(image.height);
}

// A header may claim any size; whoever uses the reader knows the camera's.
ImageFile OpenImage(const fs::path& path) {
  ImageFile file(path);
  if (file.width() > 2000 || file.height() > 2000) {
    throw InputError("larger than the camera's");
  }
  return file;
}

std::string Color(const fs::path& path) { return Pixels(path, OpenImage(path).DecodeColor()); }
std::string Depth(const fs::path& path) { return Pixels(path, OpenImage(path).DecodeDepth(5000)); }
std::string Mask(const fs::path& path) { return Pixels(path, OpenImage(path).DecodeMask()); }

std::string Camera(const fs::path& path) {
  const PinholeCamera camera = ReadCamera(path);
  if (camera.width <= 2000 && camera.height <= 2000) {  // what reading passes must do no harm
    Options options;
    options.system.lockstep = true;
    Slam slam(camera, options);
    static_cast<void>(slam.Process({0, std::make_shared<Image8>(camera.width, camera.height, 3),
                                    std::make_shared<Image16>(camera.width, camera.height)}));
  }
  return std::to_string(FormatCamera(camera).size());
}

std::string OptionsFile(const fs::path& path) {
  Options options;
  ApplyOptionsFile(path, options);
  ValidateOptions(options);
  return std::to_string(OptionsYaml(options).size());
}

std::string Model(const fs::path& path) {  // PATH is the description of a file of weights
  static_cast<void>(LoadSegmentationModel(fs::path(path).replace_extension().string()));
  return "";
}

std::string TrajectoryFile(const fs::path& path) {
  const Trajectory trajectory = ReadTrajectory(path);
  const Evaluation evaluation = Evaluate(trajectory, ReadTrajectory(path.parent_path() / "truth.txt"));
  if (!std::isfinite(evaluation.ate_m.rmse)) {
    throw InvariantError("an error that is no number");
  }
  return std::to_string(PlotTrajectories(evaluation, path.filename().string()).size());
}

std::string Sequence(const fs::path& path) {  // a folder
  const Dataset dataset = Dataset::Open(path);
  return std::to_string(dataset.size());
}

// Eight digits, the length of the JSON, before a message's body.
std::string Inference(const fs::path& path) {
  const std::string text = ReadFile(path);
  const std::string digits = text.substr(0, std::min<std::size_t>(8, text.size()));
  const InferenceMessage message =
      DecodeInference(std::string_view(text).substr(digits.size()), ParseLength(digits), "inputs");
  std::size_t numbers = 0;
  for (const InferenceTensor& tensor : message.tensors) {
    numbers += tensor.datatype == "BYTES" ? StringsOf(tensor).size() : FloatsOf(tensor).size();
  }
  return std::to_string(numbers);
}

// What is unpacked lies below PATH.folder; the fuzzer looks whether anything lies elsewhere.
std::string Archive(const fs::path& path) {
  Unpack(path, path.string() + ".folder", 1 << 20, {});
  return "";
}

int Run() {
  spdlog::set_level(spdlog::level::off);
  const std::map<std::string, std::string (*)(const fs::path&)> kinds = {{"color", Color},
                                                                         {"depth", Depth},
                                                                         {"mask", Mask},
                                                                         {"camera", Camera},
                                                                         {"options", OptionsFile},
                                                                         {"model", Model},
                                                                         {"trajectory", TrajectoryFile},
                                                                         {"sequence", Sequence},
                                                                         {"inference", Inference},
                                                                         {"archive", Archive}};
  std::string kind;
  std::string path;
  while (std::cin >> kind && std::getline(std::cin >> std::ws, path)) {
    try {
      const std::string answer = kinds.at(kind)(path);
      std::cout << "ok " << answer << std::endl;
    } catch (const InputError& error) {
      std::string text = error.what();
      std::replace(text.begin(), text.end(), '\n', ' ');
      std::cout << "error " << text << std::endl;
    }
  }
  return 0;
}

}  // namespace
}  // namespace rds

int main() { return rds::Run(); }
