// SPDX-License-Identifier: Apache-2.0
#include "eval/report.h"

#include <spdlog/fmt/fmt.h>

#include <nlohmann/json.hpp>

namespace rds {
namespace {

std::string DeltaText(const EvaluationOptions& options) {
  return fmt::format("{} {}", options.delta,
                     options.delta_unit == DeltaUnit::kSeconds ? "s" : (options.delta == 1 ? "frame" : "frames"));
}

std::string Row(const std::string& name, const Statistics& s) {
  if (s.count == 0) {
    return fmt::format("{:<18}  no pairs of poses that far apart\n", name);
  }
  return fmt::format("{:<18}{:>10.5f}{:>10.5f}{:>10.5f}{:>10.5f}{:>10.5f}{:>10.5f}{:>8}\n", name, s.rmse, s.mean,
                     s.median, s.std, s.min, s.max, s.count);
}

}  // namespace

nlohmann::ordered_json ToJson(const Statistics& s) {
  if (s.count == 0) {
    return nullptr;
  }
  return {{"count", s.count}, {"rmse", s.rmse}, {"mean", s.mean}, {"median", s.median},
          {"std", s.std},     {"min", s.min},   {"max", s.max}};
}

nlohmann::ordered_json ToJson(const Evaluation& evaluation) {
  const EvaluationOptions& options = evaluation.options;
  const Rigid3& rigid = evaluation.ground_truth_from_estimate.target_from_source;
  const Eigen::Quaterniond& q = rigid.rotation;
  const Eigen::Vector3d& t = rigid.translation;
  nlohmann::ordered_json json;
  json["ate_m"] = ToJson(evaluation.ate_m);
  json["rpe"] = {{"delta", options.delta},
                 {"delta_unit", options.delta_unit == DeltaUnit::kSeconds ? "s" : "frames"},
                 {"translation_m", ToJson(evaluation.rpe_translation_m)},
                 {"rotation_deg", ToJson(evaluation.rpe_rotation_deg)}};
  json["matched_poses"] = evaluation.matches.size();
  json["estimate_poses"] = evaluation.estimate_poses;
  json["ground_truth_poses"] = evaluation.ground_truth_poses;
  json["association"] = options.interpolate ? "interpolated" : "nearest";
  json["alignment"] = {{"scale", evaluation.ground_truth_from_estimate.scale},
                       {"rotation_xyzw", {q.x(), q.y(), q.z(), q.w()}},
                       {"translation_m", {t.x(), t.y(), t.z()}}};
  return json;
}

std::string FormatTable(const Evaluation& evaluation) {
  const EvaluationOptions& options = evaluation.options;
  const double span_s = evaluation.matches.back().timestamp_s - evaluation.matches.front().timestamp_s;
  std::string text = fmt::format(
      "{} of {} poses matched with the ground truth's {} ({}), over {:.1f} s; aligned by {}\n\n",
      evaluation.matches.size(), evaluation.estimate_poses, evaluation.ground_truth_poses,
      options.interpolate ? "interpolated" : "nearest in time", span_s,
      options.with_scale ? fmt::format("a similarity, scale {:.6f}", evaluation.ground_truth_from_estimate.scale)
                         : std::string("a rigid transform"));
  text += fmt::format("{:<18}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}{:>8}\n", "", "rmse", "mean", "median", "std", "min",
                      "max", "count");
  text += Row("ATE m", evaluation.ate_m);
  text += Row("RPE " + DeltaText(options) + ", m", evaluation.rpe_translation_m);
  text += Row("RPE " + DeltaText(options) + ", deg", evaluation.rpe_rotation_deg);
  return text;
}

}  // namespace rds
