// SPDX-License-Identifier: Apache-2.0
// A picture of an evaluation.
#pragma once

#include <string>

#include "eval/evaluation.h"

namespace rds {

// SVG: ground truth and aligned estimate projected on the two axes of the ground truth's world along which it extends
// most, to one scale, with ticks in meters; the estimate colored by its error. `title` stands above, before the ATE;
// "" for the ATE alone. The same input gives the same bytes.
std::string PlotTrajectories(const Evaluation& evaluation, const std::string& title = "");

}  // namespace rds
