// SPDX-License-Identifier: Apache-2.0
// rds synth: writes a synthetic dynamic RGB-D sequence with ground truth.
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "base/error.h"
#include "base/time.h"
#include "cli/command.h"
#include "cli/progress_line.h"
#include "io/atomic_file.h"
#include "synth/synthetic_sequence.h"

namespace rds {
namespace {

constexpr const char* kFooter =
    "A furnished room, people in it, a hand-held camera; written in TUM layout: rgb/ depth/ mask/ with their lists,\n"
    "associations.txt, groundtruth.txt and camera.yaml. Same arguments, same bytes.\n"
    "\n"
    "Scenarios: static (nobody), walking (three together, standing and strolling close to the camera), sitting (on\n"
    "chairs, fidgeting), crowd (each for himself, some seated), crossing (one by one, close to the camera),\n"
    "carried (nobody, but a board is carried before the camera: see --segmenter geometry), building (a ring of\n"
    "corridors and rooms, 61 m round, where people walk; on the paths ring and ring_back).\n"
    "Paths: orbit (once round the table in 34 s), loop (looks outwards, a round in 15 s), xyz, rpy, halfsphere, "
    "static;\nring and ring_back (77 s round a building, this way or the other).\n"
    "\n"
    "Examples:\n"
    "  rds synth --out room                                          people walking, 10 s\n"
    "  rds synth --out exact --scenario static --noise off           a test of the tracker alone\n"
    "  rds synth --out ring --scenario building --frames 2700        once round a building, and on where it began\n"
    "  rds synth --out later --scenario building --path ring_back --decor 1 --frames 2700    the same, decorated anew\n"
    "  rds synth --out hall --scenario crowd --path halfsphere --frames 900 --seed 7\n";

struct SynthArguments {
  std::string out;
  std::string scenario = "walking";
  std::string path;  // "" = as the scenario has it
  std::string noise = "on";
  int frames = 300;
  int width = 640;
  std::optional<int> height;  // otherwise three quarters of the width
  std::optional<int> movers;  // otherwise as the scenario has it
  std::uint64_t seed = 1;
  std::uint64_t decor = 0;
  double depth_error = 0;
  bool alike = false;
};

std::string Joined(const std::vector<std::string>& names) { return fmt::format("{}", fmt::join(names, ", ")); }

// As a shell wants it.
std::string Quoted(const std::string& path) {
  if (path.find_first_of(" \t'\"$&()*;<>?[]`|~#\\") == std::string::npos) {
    return path;
  }
  std::string quoted = "'";
  for (const char c : path) {
    quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return quoted + "'";
}

SyntheticOptions OptionsFrom(const SynthArguments& arguments) {
  SyntheticOptions options;
  if (arguments.noise != "on" && arguments.noise != "off") {
    throw InputError("--noise: '" + arguments.noise + "' is neither on nor off");
  }
  if (arguments.movers && *arguments.movers < 0) {
    throw InputError(fmt::format("--movers: {} is out of range (0 to {})", *arguments.movers, kMaxSyntheticMovers));
  }
  options.scenario = ParseSyntheticScenario(arguments.scenario);
  if (!arguments.path.empty()) {
    options.path = ParseSyntheticPath(arguments.path);
  } else if (options.scenario == SyntheticScenario::kBuilding) {
    options.path = SyntheticPath::kRing;
  }
  options.alike = arguments.alike;
  options.decor = arguments.decor;
  options.depth_error = arguments.depth_error;
  options.camera = MakeSyntheticCamera(arguments.width, arguments.height.value_or(arguments.width * 3 / 4));
  options.frames = arguments.frames;
  options.seed = arguments.seed;
  options.noise = arguments.noise == "on";
  options.movers = arguments.movers.value_or(-1);
  Validate(options);
  return options;
}

// Shows how far the writing is.
class WritingProgress {
 public:
  explicit WritingProgress(int frames) : frames_(frames) {}

  void Update(int done) {
    const double now_s = clock_.Seconds();
    if (done == frames_ || line_.IsDue(now_s)) {
      line_.Show(now_s, fmt::format("{} of {} frames, {:.0f} frames/s, {} left", done, frames_, done / now_s,
                                    DurationText(now_s / done * (frames_ - done))));
    }
  }

 private:
  int frames_;
  ProgressLine line_{std::cerr, isatty(STDERR_FILENO) == 1};
  Stopwatch clock_;
};

void RunSynth(const SynthArguments& arguments) {
  const SyntheticOptions options = OptionsFrom(arguments);
  PrepareOutputFolder(arguments.out);
  std::cerr << fmt::format("building it (scenario {}, path {}, {} movers, seed {})\n", arguments.scenario,
                           NameOf(options.path), ResolveMovers(options), options.seed);
  const SyntheticWorld world(options);
  WritingProgress progress(options.frames);
  WriteSyntheticSequence(world, arguments.out, [&](int done) { progress.Update(done); });

  const std::string folder = (std::filesystem::path(arguments.out) / "").parent_path().string();
  // With people in it, the masks that lie in the folder stand in for a segmentation network.
  std::cout << fmt::format("{} frames at {} Hz with ground truth and masks: {}\n", options.frames,
                           kSyntheticFrameRateHz, folder)
            << fmt::format("camera: {}/camera.yaml\n", folder)
            << fmt::format("next:   rds run {} --camera {} --segmenter {} --out {}\n", Quoted(folder),
                           Quoted(folder + "/camera.yaml"), ResolveMovers(options) > 0 ? "stored" : "none",
                           Quoted(folder + "_run"))
            << std::flush;
}

}  // namespace

void AddSynthCommand(CLI::App& app) {
  auto arguments = std::make_shared<SynthArguments>();
  CLI::App* command =
      app.add_subcommand("synth", "Write a synthetic dynamic RGB-D sequence with exact ground truth and masks");
  command->add_option("--out", arguments->out, "Folder to write to; made if it is not there")
      ->type_name("DIR")
      ->required();
  command
      ->add_option("--scenario", arguments->scenario,
                   "Who is in the room: " + Joined(SyntheticScenarioNames()) + "; default walking")
      ->type_name("NAME");
  command
      ->add_option("--path", arguments->path,
                   "How the camera moves: " + Joined(SyntheticPathNames()) + "; default orbit, in a building ring")
      ->type_name("NAME");
  command->add_option("--frames", arguments->frames, "Number of frames, at 30 Hz; default 300")->type_name("N");
  command->add_option("--seed", arguments->seed, "Room, people, tremor of the hand and noise follow from it; default 1")
      ->type_name("S");
  command
      ->add_option("--noise", arguments->noise,
                   "on: color and depth of a structured-light sensor (depth in steps, none at edges and beyond 4.5 m); "
                   "off: exact; default on")
      ->type_name("on|off");
  command
      ->add_option("--movers", arguments->movers,
                   fmt::format("Number of people, 0 to {}; default: as the scenario has it", kMaxSyntheticMovers))
      ->type_name("N");
  command->add_flag("--alike", arguments->alike, "In a building: all rooms and doors look the same");
  command
      ->add_option("--decor", arguments->decor,
                   "In a building: another number, other pictures and furniture; default 0")
      ->type_name("S");
  command
      ->add_option("--depth-error", arguments->depth_error,
                   "The depth of each frame is off by a factor 1 + N(0, SHARE), beside the sensor's noise: a map that "
                   "drifts; 0 to 0.1; default 0")
      ->type_name("SHARE");
  command->add_option("--width", arguments->width, "Image width; default 640")->type_name("PIXELS");
  command->add_option("--height", arguments->height, "Image height; default: three quarters of the width")
      ->type_name("PIXELS");
  command->footer(kFooter);
  command->callback([arguments] { RunSynth(*arguments); });
}

}  // namespace rds
