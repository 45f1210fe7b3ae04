// SPDX-License-Identifier: Apache-2.0
#include "cli/suite_results.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <system_error>

#include "base/error.h"
#include "base/file.h"
#include "cli/accuracy.h"
#include "cli/suite_runner.h"
#include "io/text_table.h"
#include "io/trajectory_io.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

RunErrors ErrorsOf(const Evaluation& evaluation, std::size_t frames) {
  return {.ate_rmse_m = evaluation.ate_m.rmse,
          .ate_std_m = evaluation.ate_m.std,
          .rpe_translation_rmse_m = evaluation.rpe_translation_m.rmse,
          .rpe_translation_std_m = evaluation.rpe_translation_m.std,
          .rpe_rotation_rmse_deg = evaluation.rpe_rotation_deg.rmse,
          .rpe_rotation_std_deg = evaluation.rpe_rotation_deg.std,
          .poses = evaluation.estimate_poses,
          .frames = frames};
}

// What a sequence is held against.
struct Truth {
  std::optional<Trajectory> trajectory;
  std::size_t frames = 0;
};

Truth TruthOf(const SuiteSequence& sequence) {
  const Dataset dataset = OpenSequence(sequence);
  return {dataset.ground_truth(), dataset.size()};
}

std::optional<Evaluation> EvaluationOf(const fs::path& file, const Truth& truth) {
  std::error_code error;
  if (!fs::is_regular_file(file, error) || fs::file_size(file, error) == 0) {
    return std::nullopt;
  }
  try {
    return Accuracy(ReadTrajectory(file), truth.trajectory);
  } catch (const InputError&) {  // no pose in it
    return std::nullopt;
  }
}

// Keeps the evaluation of the run with the median error (the lower of two).
void KeepMedian(std::vector<Evaluation> evaluations, SequenceResults& results) {
  if (!evaluations.empty()) {
    const auto middle = evaluations.begin() + (std::ssize(evaluations) - 1) / 2;
    std::ranges::nth_element(evaluations, middle, {}, [](const Evaluation& one) { return one.ate_m.rmse; });
    results.median = std::move(*middle);
  }
}

SequenceResults OwnResults(const Suite& suite, const fs::path& out, const SuiteSequence& sequence,
                           const SuiteConfiguration& configuration, const Truth& truth) {
  SequenceResults results;
  std::vector<Evaluation> evaluations;
  for (int i = 0; i < suite.repetitions; ++i) {
    const fs::path folder = RunFolder(out, sequence, configuration, i);
    std::error_code error;
    if (!fs::is_regular_file(folder / "done.txt", error)) {
      continue;
    }
    results.reports.push_back(nlohmann::json::parse(ReadFile(folder / "report.json")));
    results.folders.push_back(folder);
    if (auto evaluation = EvaluationOf(folder / "trajectory.txt", truth)) {
      results.frames.push_back(ErrorsOf(*evaluation, truth.frames));
      evaluations.push_back(std::move(*evaluation));
    }
    if (const auto keyframes = EvaluationOf(folder / "keyframes.txt", truth)) {
      results.keyframes.push_back(ErrorsOf(*keyframes, truth.frames));
    }
  }
  KeepMedian(std::move(evaluations), results);
  return results;
}

SequenceResults OthersResults(const SuiteMethod& method, const SuiteSequence& sequence, const Truth& truth) {
  SequenceResults results;
  const auto files = method.trajectories.find(sequence.name);
  if (files == method.trajectories.end()) {
    return results;
  }
  std::vector<Evaluation> evaluations;
  for (const fs::path& file : files->second) {
    if (auto evaluation = Accuracy(ReadTrajectory(file), truth.trajectory)) {
      results.frames.push_back(ErrorsOf(*evaluation, truth.frames));
      evaluations.push_back(std::move(*evaluation));
    }
  }
  KeepMedian(std::move(evaluations), results);
  return results;
}

}  // namespace

std::vector<MethodResults> ReadResults(const Suite& suite, const fs::path& out) {
  std::vector<Truth> truths;
  for (const SuiteSequence& sequence : suite.sequences) {
    truths.push_back(TruthOf(sequence));
  }
  std::vector<MethodResults> results;
  for (const SuiteConfiguration& configuration : suite.configurations) {
    MethodResults& method = results.emplace_back(MethodResults{configuration.name, true, {}});
    for (std::size_t i = 0; i < truths.size(); ++i) {
      method.sequences.push_back(OwnResults(suite, out, suite.sequences[i], configuration, truths[i]));
    }
  }
  for (const SuiteMethod& other : suite.methods) {
    MethodResults& method = results.emplace_back(MethodResults{other.name, false, {}});
    for (std::size_t i = 0; i < truths.size(); ++i) {
      method.sequences.push_back(OthersResults(other, suite.sequences[i], truths[i]));
    }
  }
  return results;
}

std::vector<double> ReadColumn(const fs::path& csv, const std::string& name) {
  std::istringstream lines(ReadFile(csv));
  const auto split = [](const std::string& line) {
    std::vector<std::string> fields;
    std::istringstream rest(line);
    for (std::string field; std::getline(rest, field, ',');) {
      fields.push_back(field);
    }
    return fields;
  };
  std::string line;
  std::getline(lines, line);
  const std::vector<std::string> headings = split(line);
  const auto column = static_cast<std::size_t>(std::ranges::find(headings, name) - headings.begin());
  if (column == headings.size()) {
    throw InputError(csv.string() + ": has no column " + name);
  }
  std::vector<double> values;
  while (std::getline(lines, line)) {
    const std::vector<std::string> fields = split(line);
    const auto number = column < fields.size() ? ParseNumber(fields[column]) : std::nullopt;
    values.push_back(number.value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  return values;
}

}  // namespace rds
