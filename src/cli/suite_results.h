// SPDX-License-Identifier: Apache-2.0
// The figures of a suite's runs, from their folders.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/suite.h"
#include "eval/evaluation.h"

namespace rds {

// Root of the mean square and standard deviation of the errors of one trajectory.
struct RunErrors {
  double ate_rmse_m = 0;
  double ate_std_m = 0;
  double rpe_translation_rmse_m = 0;  // over one second
  double rpe_translation_std_m = 0;
  double rpe_rotation_rmse_deg = 0;
  double rpe_rotation_std_deg = 0;
  std::size_t poses = 0;
  std::size_t frames = 0;  // of the sequence
};

// The runs of one method, or one configuration, on one sequence.
struct SequenceResults {
  std::vector<RunErrors> frames;               // of all poses, one for each run that has an error
  std::vector<RunErrors> keyframes;            // of the keyframes alone; none of other systems
  std::vector<nlohmann::json> reports;         // report.json; none of other systems
  std::vector<std::filesystem::path> folders;  // of the runs in `reports`
  // The run with the median error, for pictures.
  std::optional<Evaluation> median;
};

struct MethodResults {
  std::string name;
  bool is_own = true;
  std::vector<SequenceResults> sequences;  // as in Suite::sequences
};

// Configurations in their order, then methods. What was not run, failed or has no ground truth is left out. Other
// systems' files that cannot be read are an InputError.
[[nodiscard]] std::vector<MethodResults> ReadResults(const Suite& suite, const std::filesystem::path& out);

// A column of frames.csv; NaN where it is empty.
[[nodiscard]] std::vector<double> ReadColumn(const std::filesystem::path& csv, const std::string& name);

}  // namespace rds
