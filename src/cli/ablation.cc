// SPDX-License-Identifier: Apache-2.0
#include "cli/ablation.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>

namespace rds {
namespace {

using Cells = std::vector<std::string>;

const Cells kHeadings = {"variant",   "tracked", "ATE RMSE [m]",   "RPE 1 s [m]",
                         "keyframes", "labeled", "delay [frames]", "tracking [ms]"};

std::string Optional(const std::optional<double>& value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : "-";
}

Cells CellsOf(const AblationRow& row) {
  return {row.name,
          fmt::format("{}/{}", row.tracked, row.frames),
          Optional(row.ate_rmse_m, 4),
          Optional(row.rpe_rmse_m, 4),
          fmt::format("{}", row.keyframes),
          fmt::format("{}", row.labeled),
          Optional(row.delay_median_frames, 1),
          fmt::format("{:.2f}", row.tracking_median_ms)};
}

nlohmann::ordered_json Nullable(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

}  // namespace

std::span<const AblationVariant> AblationVariants() {
  static const std::array variants = {
      AblationVariant{"whole", "everything as by default", {}},
      AblationVariant{"paper's unknowns",
                      "unknown points as Algorithm 2 has them: only while fewer than tau static ones are there",
                      {"tracking.unknown=paper"}},
      AblationVariant{"no propagation",
                      "labels are not propagated, neither from frame to frame nor through free space",
                      {"propagation.enabled=false"}},
      AblationVariant{"no free space",
                      "free space is not checked: neither static surfaces nor newly occupied places are labeled by it",
                      {"semantic.free_space=false"}},
      AblationVariant{"no motion",
                      "two views are not compared: what moves has to have a name, or to move in",
                      {"semantic.motion=false"}},
      AblationVariant{
          "one start", "the frames before the first label are not tracked again", {"semantic.start_frames=0"}},
      AblationVariant{"no observation weight",
                      "points weigh the same however few observations they have",
                      {"tracking.min_observations=1"}},
      AblationVariant{
          "no edges", "keypoints where the depth jumps are trusted as much as others", {"orb.depth_edges=false"}},
      AblationVariant{"no motion prior",
                      "a pose stands on its matches alone: its velocity does not hold it",
                      {"tracking.acceleration_m_s2=0"}},
      AblationVariant{
          "no association", "tracking does not look at moving probabilities", {"tracking.use_semantics=false"}},
      AblationVariant{
          "no optimization", "no semantic-based optimization of keyframes", {"semantic.optimization=false"}},
      AblationVariant{"no weights",
                      "local bundle adjustment without the weights 1 - p, dynamic points included",
                      {"mapping.ba_weighted=false"}},
      AblationVariant{"labeled bundle",
                      "only labeled keyframes take part in local bundle adjustment, as the paper has it",
                      {"mapping.ba_labeled_only=true"}},
      AblationVariant{"no places", "places are not recognized: no loop, no merge", {"loop.enabled=false"}},
      AblationVariant{"no full bundle", "no full bundle adjustment after a loop", {"loop.bundle=false"}},
      AblationVariant{"sequential", "keyframes are labeled in their order", {"semantic.selection=sequential"}},
      AblationVariant{"newest", "only the newest keyframes are labeled", {"semantic.selection=newest"}},
      AblationVariant{"busy",
                      "a keyframe every three frames, more than masks can follow",
                      {"keyframe.max_frames=3", "keyframe.min_frames=0"}},
      AblationVariant{"busy, sequential",
                      "so many keyframes, labeled in their order",
                      {"keyframe.max_frames=3", "keyframe.min_frames=0", "semantic.selection=sequential"}},
      AblationVariant{"no semantics", "no segmentation at all", {}, false},
  };
  return variants;
}

std::string AblationText(const std::vector<AblationRow>& rows) {
  std::vector<Cells> lines = {kHeadings};
  std::transform(rows.begin(), rows.end(), std::back_inserter(lines), CellsOf);
  std::vector<std::size_t> widths(kHeadings.size(), 0);
  for (const Cells& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) {
      widths[i] = std::max(widths[i], line[i].size());
    }
  }
  std::string text;
  for (const Cells& line : lines) {
    text += fmt::format("{:<{}}", line[0], widths[0]);
    for (std::size_t i = 1; i < line.size(); ++i) {
      text += fmt::format("  {:>{}}", line[i], widths[i]);
    }
    text += '\n';
  }
  return text;
}

std::string AblationMarkdown(const std::vector<AblationRow>& rows) {
  const auto row_text = [](const Cells& cells) { return fmt::format("| {} |\n", fmt::join(cells, " | ")); };
  std::string text = row_text(kHeadings);
  text += "|---|";
  for (std::size_t i = 1; i < kHeadings.size(); ++i) {
    text += "---:|";
  }
  text += '\n';
  for (const AblationRow& row : rows) {
    text += row_text(CellsOf(row));
  }
  text += '\n';
  for (const AblationRow& row : rows) {
    text += fmt::format("- {}: {}.\n", row.name, row.meaning);
  }
  return text;
}

nlohmann::ordered_json AblationJson(const std::vector<AblationRow>& rows) {
  auto json = nlohmann::ordered_json::array();
  for (const AblationRow& row : rows) {
    json.push_back({{"variant", row.name},
                    {"meaning", row.meaning},
                    {"frames", row.frames},
                    {"tracked", row.tracked},
                    {"ate_rmse_m", Nullable(row.ate_rmse_m)},
                    {"rpe_rmse_m", Nullable(row.rpe_rmse_m)},
                    {"keyframes", row.keyframes},
                    {"labeled", row.labeled},
                    {"delay_median_frames", Nullable(row.delay_median_frames)},
                    {"tracking_median_ms", row.tracking_median_ms}});
  }
  return json;
}

}  // namespace rds
