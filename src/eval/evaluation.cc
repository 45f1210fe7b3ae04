// SPDX-License-Identifier: Apache-2.0
#include "eval/evaluation.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "base/error.h"

namespace rds {
namespace {

void CheckOptions(const EvaluationOptions& options) {
  if (!(options.delta > 0) || !std::isfinite(options.delta)) {
    throw InputError(fmt::format("the delta of the relative pose error is {}; more than 0 is wanted", options.delta));
  }
  if (options.delta_unit == DeltaUnit::kFrames && options.delta != std::floor(options.delta)) {
    throw InputError(
        fmt::format("the delta of the relative pose error is {} frames; a whole number is wanted", options.delta));
  }
  if (!(options.max_difference_s >= 0) || !(options.max_gap_s >= 0)) {
    throw InputError("the greatest difference of times must be 0 or more seconds");
  }
}

void CheckMatches(const Trajectory& estimate, const Trajectory& ground_truth, const Evaluation& evaluation) {
  if (evaluation.matches.size() >= 3) {
    return;
  }
  const auto span = [](const Trajectory& trajectory) {
    return trajectory.empty()
               ? std::string("no time at all")
               : fmt::format("{:.3f} to {:.3f} s", trajectory.front().timestamp_s, trajectory.back().timestamp_s);
  };
  throw InputError(fmt::format(
      "only {} of the estimate's {} poses match the ground truth's in time, 3 are needed; the estimate covers {}, the "
      "ground truth {} (a greater difference of times may be allowed, or the ground truth interpolated)",
      evaluation.matches.size(), estimate.size(), span(estimate), span(ground_truth)));
}

Trajectory Between(const Trajectory& trajectory, double begin_s, double end_s) {
  Trajectory part;
  std::copy_if(trajectory.begin(), trajectory.end(), std::back_inserter(part),
               [&](const StampedPose& pose) { return pose.timestamp_s >= begin_s && pose.timestamp_s <= end_s; });
  return part;
}

// Aligns the matches' estimates and fills in what describes the absolute error.
void AlignAndMeasure(Evaluation& evaluation) {
  std::vector<Eigen::Vector3d> estimated;
  std::vector<Eigen::Vector3d> truth;
  for (const MatchedPose& match : evaluation.matches) {
    estimated.push_back(match.estimate.translation);
    truth.push_back(match.ground_truth.translation);
  }
  const Alignment alignment = Align(estimated, truth, evaluation.options.with_scale);
  evaluation.ground_truth_from_estimate = alignment;
  for (MatchedPose& match : evaluation.matches) {
    match.estimate.translation = alignment.Apply(match.estimate.translation);
    match.estimate.rotation = (alignment.target_from_source.rotation * match.estimate.rotation).normalized();
    evaluation.position_error_m.push_back((match.estimate.translation - match.ground_truth.translation).norm());
  }
  evaluation.ate_m = Summarize(evaluation.position_error_m);
}

using IndexPairs = std::vector<std::pair<std::size_t, std::size_t>>;

IndexPairs PairsByFrames(std::size_t count, double delta) {
  IndexPairs pairs;
  if (delta >= static_cast<double>(count)) {
    return pairs;
  }
  const auto step = static_cast<std::size_t>(delta);
  for (std::size_t i = 0; i + step < count; ++i) {
    pairs.emplace_back(i, i + step);
  }
  return pairs;
}

double MedianInterval(const std::vector<MatchedPose>& matches) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < matches.size(); ++i) {
    intervals.push_back(matches[i].timestamp_s - matches[i - 1].timestamp_s);
  }
  return Percentile(intervals, 50);
}

IndexPairs PairsBySeconds(const std::vector<MatchedPose>& matches, double delta_s) {
  const double tolerance_s = 0.75 * MedianInterval(matches);
  IndexPairs pairs;
  std::size_t j = 0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const auto off_s = [&](std::size_t k) {
      return std::abs(matches[k].timestamp_s - matches[i].timestamp_s - delta_s);
    };
    j = std::max(j, i + 1);
    while (j + 1 < matches.size() && off_s(j + 1) < off_s(j)) {
      ++j;
    }
    if (j < matches.size() && off_s(j) < tolerance_s) {
      pairs.emplace_back(i, j);
    }
  }
  return pairs;
}

void MeasureRelative(Evaluation& evaluation) {
  const EvaluationOptions& options = evaluation.options;
  const IndexPairs pairs = options.delta_unit == DeltaUnit::kFrames
                               ? PairsByFrames(evaluation.matches.size(), options.delta)
                               : PairsBySeconds(evaluation.matches, options.delta);
  std::vector<double> translation_m;
  std::vector<double> rotation_deg;
  for (const auto& [i, j] : pairs) {
    const MatchedPose& first = evaluation.matches[i];
    const MatchedPose& second = evaluation.matches[j];
    const Rigid3 true_motion = first.ground_truth.Inverse() * second.ground_truth;
    const Rigid3 estimated_motion = first.estimate.Inverse() * second.estimate;
    const Rigid3 error = true_motion.Inverse() * estimated_motion;
    translation_m.push_back(error.translation.norm());
    rotation_deg.push_back(AngleOf(error.rotation) * 180 / std::numbers::pi);
  }
  evaluation.rpe_translation_m = Summarize(translation_m);
  evaluation.rpe_rotation_deg = Summarize(rotation_deg);
}

}  // namespace

Evaluation Evaluate(const Trajectory& estimate, const Trajectory& ground_truth, const EvaluationOptions& options) {
  CheckOptions(options);
  Evaluation evaluation;
  evaluation.options = options;
  evaluation.estimate_poses = estimate.size();
  evaluation.ground_truth_poses = ground_truth.size();
  evaluation.matches = options.interpolate ? MatchInterpolated(estimate, ground_truth, options.max_gap_s)
                                           : MatchNearest(estimate, ground_truth, options.max_difference_s);
  CheckMatches(estimate, ground_truth, evaluation);
  evaluation.ground_truth = Between(ground_truth, evaluation.matches.front().timestamp_s - options.max_difference_s,
                                    evaluation.matches.back().timestamp_s + options.max_difference_s);
  AlignAndMeasure(evaluation);
  MeasureRelative(evaluation);
  return evaluation;
}

}  // namespace rds
