// SPDX-License-Identifier: Apache-2.0
// rds eval: how far an estimated trajectory is from the ground truth.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "base/error.h"
#include "base/file.h"
#include "base/log.h"
#include "base/sha256.h"
#include "cli/command.h"
#include "cli/series_json.h"
#include "eval/evaluation.h"
#include "eval/plot.h"
#include "eval/report.h"
#include "io/atomic_file.h"
#include "io/trajectory_io.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter =
    "Poses are matched by time, the estimate is aligned to the ground truth (Umeyama), then measured:\n"
    "  ATE  absolute trajectory error: distance of the positions, meters\n"
    "  RPE  relative pose error: error of the motion over --delta, meters and degrees\n"
    "The figures are those of the evo package: ATE of `evo_ape tum GROUNDTRUTH ESTIMATE --align`, RPE with\n"
    "--delta-frames N of `evo_rpe tum GROUNDTRUTH ESTIMATE --delta N --delta_unit f --all_pairs`.\n"
    "\n"
    "Examples:\n"
    "  rds eval result sequence                                  trajectory.txt of a run, groundtruth.txt of a "
    "sequence\n"
    "  rds eval estimate.txt groundtruth.txt --json\n"
    "  rds eval estimate.txt groundtruth.txt --plot error.svg --scale\n";

struct EvalArguments {
  std::string estimate;
  std::string ground_truth;
  bool json = false;
  std::string plot;
  EvaluationOptions options;
  std::optional<double> delta_frames;
};

// In a folder, the file of that name.
fs::path FileIn(const fs::path& path, const char* name) {
  std::error_code ignored;
  return fs::is_directory(path, ignored) ? path / name : path;
}

// Name of the folder that holds the ground truth: the sequence's.
std::string TitleOf(const fs::path& ground_truth) {
  std::error_code ignored;
  return fs::weakly_canonical(ground_truth, ignored).parent_path().filename().string();
}

// In a folder of results: whether the trajectory is that of the run that report.json tells of.
void CheckSet(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::is_regular_file(folder / "report.json", ignored)) {
    return;
  }
  const nlohmann::json report = nlohmann::json::parse(ReadFile(folder / "report.json"), nullptr, false);
  const nlohmann::json::json_pointer digest("/files/trajectory.txt");
  if (report.is_object() && report.contains(digest) && report[digest] != Sha256(folder / "trajectory.txt")) {
    log::warn("{}: trajectory.txt is not of the run that report.json tells of", folder.string());
  }
}

void Eval(EvalArguments arguments) {
  if (arguments.delta_frames) {
    arguments.options.delta = *arguments.delta_frames;
    arguments.options.delta_unit = DeltaUnit::kFrames;
  }
  if (std::error_code ignored; fs::is_directory(arguments.estimate, ignored)) {
    CheckSet(arguments.estimate);
  }
  const fs::path ground_truth = FileIn(arguments.ground_truth, "groundtruth.txt");
  const Evaluation evaluation = Evaluate(ReadTrajectory(FileIn(arguments.estimate, "trajectory.txt")),
                                         ReadTrajectory(ground_truth), arguments.options);
  if (!arguments.plot.empty()) {
    WriteFileAtomically(arguments.plot, PlotTrajectories(evaluation, TitleOf(ground_truth)));
  }
  std::cout << (arguments.json ? ToJson(evaluation).dump(2, ' ', false, kReplaceBadUtf8) + "\n"
                               : FormatTable(evaluation));
}

}  // namespace

void AddEvalCommand(CLI::App& app) {
  auto arguments = std::make_shared<EvalArguments>();
  CLI::App* command = app.add_subcommand("eval", "Compare a trajectory with the ground truth: ATE, RPE, a picture");
  command->add_option("estimate", arguments->estimate, "Trajectory in TUM format, or a folder with trajectory.txt")
      ->type_name("ESTIMATE")
      ->required();
  command
      ->add_option("groundtruth", arguments->ground_truth,
                   "Ground truth in TUM format, or a folder with groundtruth.txt")
      ->type_name("GROUNDTRUTH")
      ->required();
  command->add_flag("--json", arguments->json, "Print JSON instead of a table");
  command->add_option("--plot", arguments->plot, "Draw both paths, seen from above, colored by the error")
      ->type_name("FILE.svg");
  command->add_flag("--scale", arguments->options.with_scale, "Let the alignment find the scale too");
  command->add_flag("--interpolate", arguments->options.interpolate,
                    "Interpolate the ground truth at the estimate's times instead of taking the nearest pose");
  command
      ->add_option("--max-difference", arguments->options.max_difference_s,
                   "Greatest difference in time of two poses that match; default 0.01")
      ->type_name("SECONDS");
  command->add_option("--delta", arguments->options.delta, "Time between the two poses of the RPE; default 1")
      ->type_name("SECONDS");
  command->add_option("--delta-frames", arguments->delta_frames, "The same in matched frames, instead of a time")
      ->type_name("N")
      ->excludes("--delta");
  command->footer(kFooter);
  command->callback([arguments] { Eval(*arguments); });
}

}  // namespace rds
