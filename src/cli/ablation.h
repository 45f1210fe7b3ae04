// SPDX-License-Identifier: Apache-2.0
// Ablation: the same sequence with parts of the system switched off, and the table that compares them.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rds {

// One row: a few options that differ from the base.
struct AblationVariant {
  std::string name;
  std::string meaning;                 // one sentence
  std::vector<std::string> overrides;  // "key=value", set over everything else
  bool segmenter = true;               // false: runs without any
};

// The useful combinations: the whole system first, then each part off, then no semantics at all.
[[nodiscard]] std::span<const AblationVariant> AblationVariants();

// What a variant came to.
struct AblationRow {
  std::string name;
  std::string meaning;
  std::size_t frames = 0;
  int tracked = 0;
  std::optional<double> ate_rmse_m;  // absent without ground truth, or with too few poses to align
  std::optional<double> rpe_rmse_m;  // over one second
  std::size_t keyframes = 0;
  std::size_t labeled = 0;                    // keyframes
  std::optional<double> delay_median_frames;  // absent without a label
  double tracking_median_ms = 0;
};

// Columns lined up for a terminal.
[[nodiscard]] std::string AblationText(const std::vector<AblationRow>& rows);
[[nodiscard]] std::string AblationMarkdown(const std::vector<AblationRow>& rows);
[[nodiscard]] nlohmann::ordered_json AblationJson(const std::vector<AblationRow>& rows);

}  // namespace rds
