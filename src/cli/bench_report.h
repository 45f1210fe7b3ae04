// SPDX-License-Identifier: Apache-2.0
// The figures of rds bench.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "cli/playback.h"
#include "cli/run_report.h"

namespace rds {

// Tracking time against the reference's (one time for each frame played), in milliseconds: both medians and their
// ratio; each part's share of the whole time; growth, the median of the last 250 frames over that of the first 250 (of
// halves, where there are fewer than 500); CPU time a frame without that of the reference.
[[nodiscard]] nlohmann::ordered_json BenchReport(const RunDescription& description, const PlaybackResult& playback,
                                                 const std::vector<double>& reference_ms, double reference_cpu_s);

}  // namespace rds
