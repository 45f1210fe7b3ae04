// SPDX-License-Identifier: Apache-2.0
#include "cli/play_arguments.h"

#include <spdlog/fmt/fmt.h>

#include "base/error.h"
#include "base/image.h"
#include "cli/process_info.h"
#include "io/camera_config.h"
#include "io/depth_check.h"
#include "io/ignored_pixels.h"
#include "io/options_yaml.h"
#include "segmentation/segmenter_factory.h"
#include "system/presets.h"

namespace rds {

void AddOptionArguments(CLI::App& command, OptionArguments& arguments) {
  command
      .add_option("--preset", arguments.preset,
                  "A set of options: paper = what the paper has, without what this system adds")
      ->type_name("NAME");
  command.add_option("--config", arguments.config, "YAML file of options, over the preset's (see `rds config`)")
      ->type_name("FILE");
  command
      .add_option("--set", arguments.set,
                  "One option, over the file's value; may be given several times, for instance --set orb.features=1500")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

Options ResolveOptions(const OptionArguments& arguments) {
  Options options;
  if (!arguments.preset.empty()) {
    ApplyPreset(options, arguments.preset);
  }
  if (!arguments.config.empty()) {
    ApplyOptionsFile(arguments.config, options);
  }
  for (const std::string& assignment : arguments.set) {
    SetOption(options, assignment);
  }
  ValidateOptions(options);
  return options;
}

void AddPlayArguments(CLI::App& command, PlayArguments& arguments, const std::string& default_segmenter) {
  arguments.segmenter = default_segmenter;
  command
      .add_option("sequence", arguments.sequence,
                  "Folder in the layout of the TUM and Bonn benchmarks: rgb.txt and depth.txt, or associations.txt")
      ->type_name("SEQUENCE")
      ->required();
  command
      .add_option("--camera", arguments.camera,
                  "Camera file, or one of tum_fr1, tum_fr2, tum_fr3, bonn, redkitchen; not needed where the folder has "
                  "a camera.yaml or its name tells")
      ->type_name("FILE");
  AddOptionArguments(command, arguments.options);
  command.add_option("--frames", arguments.frames, "Frames A up to, not including, B, from 0; either may be left out")
      ->type_name("A:B");
  command
      .add_option("--segmenter", arguments.segmenter,
                  "Who tells what moves: openvino (a network, people), remote (a network on a server, see "
                  "semantic.remote.url), stored (the sequence's own masks), geometry "
                  "(no network: what moves otherwise than most of the picture), none; default " +
                      default_segmenter)
      ->type_name("NAME");
  command
      .add_option("--model", arguments.model,
                  "Weights for openvino: a file, or fast or accurate for the published ones (see `rds fetch`)")
      ->type_name("WEIGHTS");
  command
      .add_option(
          "--masks", arguments.masks,
          "For stored: take the masks that mask.txt in this folder lists (see `rds segment`), not the sequence's")
      ->type_name("DIR");
}

PlaySetup PreparePlay(const PlayArguments& arguments, bool lockstep) {
  Options options = ResolveOptions(arguments.options);
  options.system.lockstep = options.system.lockstep || lockstep;
  const double rate = arguments.rate.value_or(options.system.lockstep ? 0 : 1);
  if (rate != 0 && !(rate >= .01 && rate <= 1000)) {
    throw InputError(fmt::format("--rate {}: expected 0 (as fast as it goes), or .01 to 1000 times as recorded", rate));
  }
  // Faster than recorded, mapping must be able to keep up.
  options.system.wait_for_mapping = options.system.wait_for_mapping || rate == 0 || rate > 1;
  if (!arguments.model.empty()) {
    options.segmenter.model = arguments.model;
  }
  DatasetOptions dataset_options;
  dataset_options.frames = ParseFrameRange(arguments.frames);
  dataset_options.needs_masks = arguments.segmenter == "stored";
  if (!arguments.masks.empty() && !dataset_options.needs_masks) {
    throw InputError("--masks goes with --segmenter stored");
  }
  dataset_options.masks = arguments.masks;
  Dataset dataset = Dataset::Open(arguments.sequence, dataset_options);
  FoundCamera found = CameraOfSequence(dataset.folder(), arguments.camera);
  CheckDepthScale(dataset, found.camera);
  if (!options.semantic.ignore.empty()) {
    dataset.Ignore(LoadIgnoredPixels(options.semantic.ignore, found.camera));
  }
  return {std::move(dataset),      found.camera, std::move(found.name),
          std::move(found.reason), options,      {.rate = rate, .strict = arguments.strict}};
}

std::unique_ptr<Segmenter> OpenSegmenter(const PlayArguments& arguments, const PlaySetup& setup) {
  std::vector<StoredMask> masks;
  for (const DatasetFrame& frame : setup.dataset.frames()) {
    if (!frame.mask_path.empty()) {
      masks.push_back({frame.timestamp_s, frame.mask_path.string()});
    }
  }
  if (arguments.segmenter == "geometry" && !setup.options.semantic.motion) {
    throw InputError("--segmenter geometry needs option semantic.motion: without it nothing is told from geometry");
  }
  SegmenterOptions options = setup.options.segmenter;
  if (setup.options.system.lockstep) {
    options.stored_delay_ms = 0;  // delays are counted in frames there
  }
  auto segmenter = MakeSegmenter(arguments.segmenter, options, std::move(masks),
                                 [camera = setup.camera, unsure = setup.dataset.MasksHaveUnsure()](
                                     const std::string& path) { return LoadMask(path, camera, unsure); });
  if (arguments.segmenter == "openvino") {
    // A network is compiled with its first request: now, and not while people walk by whom only its label tells.
    const SegmentationInput black{{}, 0, std::make_shared<const Image8>(setup.camera.width, setup.camera.height, 3)};
    static_cast<void>(segmenter->Segment({&black, 1}));
  }
  return segmenter;
}

RunDescription Describe(const PlaySetup& setup, const Segmenter* segmenter) {
  RunDescription description;
  description.sequence = setup.dataset.Name();
  description.segmenter = segmenter == nullptr ? "none" : segmenter->Name();
  description.rate = setup.play.rate;
  description.camera = {{"name", setup.camera_name},
                        {"reason", setup.camera_reason},
                        {"width", setup.camera.width},
                        {"height", setup.camera.height},
                        {"fx", setup.camera.fx},
                        {"fy", setup.camera.fy},
                        {"cx", setup.camera.cx},
                        {"cy", setup.camera.cy},
                        {"distortion", setup.camera.distortion},
                        {"depth_scale", setup.camera.depth_scale},
                        {"baseline_m", setup.camera.baseline_m}};
  description.input = {{"folder", setup.dataset.folder().string()},
                       {"frames", setup.dataset.size()},
                       {"first_timestamp_s", setup.dataset.frames().front().timestamp_s},
                       {"last_timestamp_s", setup.dataset.frames().back().timestamp_s},
                       {"color_images_without_depth", setup.dataset.color_images_without_depth()},
                       {"ground_truth", setup.dataset.ground_truth().has_value()},
                       {"masks", setup.dataset.HasMasks()}};
  description.lockstep = setup.options.system.lockstep;
  description.started_after_s = SecondsSinceProcessStart();
  return description;
}

void EndCommand(int exit_code) {
  if (exit_code != 0) {
    throw CLI::RuntimeError(exit_code);
  }
}

}  // namespace rds
