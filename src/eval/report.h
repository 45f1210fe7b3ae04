// SPDX-License-Identifier: Apache-2.0
// Evaluations for people and for programs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "eval/evaluation.h"

namespace rds {

// {count, rmse, mean, median, std, min, max}; null for an empty series.
nlohmann::ordered_json ToJson(const Statistics& statistics);

// {ate_m: {rmse, ...}, rpe: {delta, delta_unit, translation_m: {...}, rotation_deg: {...}}, matched_poses,
// estimate_poses, ground_truth_poses, alignment: {scale, rotation_xyzw, translation_m}}
nlohmann::ordered_json ToJson(const Evaluation& evaluation);

// A table of several lines, ending in a line break.
std::string FormatTable(const Evaluation& evaluation);

}  // namespace rds
