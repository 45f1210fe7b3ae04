// SPDX-License-Identifier: Apache-2.0
// The accuracy of a run against the ground truth of its sequence.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "eval/evaluation.h"
#include "geometry/trajectory.h"

namespace rds {

// Nothing without ground truth, or where fewer than three poses match it in time.
[[nodiscard]] std::optional<Evaluation> Accuracy(const Trajectory& estimate,
                                                 const std::optional<Trajectory>& ground_truth);

// {"ate_m": {...}, "rpe": {...}}; both null without an evaluation.
[[nodiscard]] nlohmann::ordered_json AccuracyJson(const std::optional<Evaluation>& evaluation);

// A line for the user, ending in a line break; says why where there is no evaluation.
[[nodiscard]] std::string AccuracyText(const std::optional<Evaluation>& evaluation, const Trajectory& estimate,
                                       const std::optional<Trajectory>& ground_truth);

}  // namespace rds
