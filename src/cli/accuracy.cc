// SPDX-License-Identifier: Apache-2.0
#include "cli/accuracy.h"

#include <spdlog/fmt/fmt.h>

#include "base/error.h"
#include "eval/report.h"

namespace rds {

std::optional<Evaluation> Accuracy(const Trajectory& estimate, const std::optional<Trajectory>& ground_truth) {
  if (!ground_truth) {
    return std::nullopt;
  }
  try {
    return Evaluate(estimate, *ground_truth);
  } catch (const InputError&) {  // too few poses match: nothing to say about accuracy, and no reason to fail
    return std::nullopt;
  }
}

nlohmann::ordered_json AccuracyJson(const std::optional<Evaluation>& evaluation) {
  nlohmann::ordered_json json = {{"ate_m", nullptr}, {"rpe", nullptr}};
  if (evaluation) {
    const nlohmann::ordered_json all = ToJson(*evaluation);
    json["ate_m"] = all["ate_m"];
    json["rpe"] = all["rpe"];
  }
  return json;
}

std::string AccuracyText(const std::optional<Evaluation>& evaluation, const Trajectory& estimate,
                         const std::optional<Trajectory>& ground_truth) {
  if (!ground_truth) {
    return "accuracy: unknown, the sequence has no groundtruth.txt that can be read\n";
  }
  if (!evaluation) {
    const auto span = [](const Trajectory& trajectory) {
      return trajectory.empty()
                 ? std::string("nothing")
                 : fmt::format("{:.3f} to {:.3f} s", trajectory.front().timestamp_s, trajectory.back().timestamp_s);
    };
    return fmt::format("accuracy: too few tracked frames match the ground truth in time; it covers {}, the run {}\n",
                       span(*ground_truth), span(estimate));
  }
  std::string text = fmt::format("ATE: {:.4f} m RMSE over {} poses", evaluation->ate_m.rmse, evaluation->ate_m.count);
  if (evaluation->rpe_translation_m.count > 0) {
    text += fmt::format("; RPE over 1 s: {:.4f} m, {:.3f} deg RMSE", evaluation->rpe_translation_m.rmse,
                        evaluation->rpe_rotation_deg.rmse);
  }
  return text + "\n";
}

}  // namespace rds
