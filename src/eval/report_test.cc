// SPDX-License-Identifier: Apache-2.0
#include "eval/report.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace rds {
namespace {

using ::testing::HasSubstr;

Evaluation Some(const EvaluationOptions& options = {}) {
  Trajectory truth;
  for (int i = 0; i < 50; ++i) {
    truth.push_back({0.1 * i, {Eigen::Quaterniond::Identity(), {0.1 * i, 0.01 * i * i, 0}}});
  }
  Trajectory estimate = truth;
  estimate[10].world_from_camera.translation.z() = 0.5;
  return Evaluate(estimate, truth, options);
}

TEST(Report, JsonHoldsTheFigures) {
  const Evaluation evaluation = Some();
  const auto json = nlohmann::json::parse(ToJson(evaluation).dump());
  EXPECT_EQ(json.at("ate_m").at("rmse").get<double>(), evaluation.ate_m.rmse);
  EXPECT_EQ(json.at("ate_m").at("count"), 50);
  EXPECT_EQ(json.at("rpe").at("delta"), 1.0);
  EXPECT_EQ(json.at("rpe").at("delta_unit"), "s");
  EXPECT_EQ(json.at("rpe").at("translation_m").at("max").get<double>(), evaluation.rpe_translation_m.max);
  EXPECT_EQ(json.at("rpe").at("rotation_deg").at("count"), 40);
  EXPECT_EQ(json.at("matched_poses"), 50);
  EXPECT_EQ(json.at("alignment").at("scale"), 1.0);
}

TEST(Report, JsonHasNullForWhatIsUnknown) {
  EvaluationOptions options;
  options.delta = 1000;
  const auto json = nlohmann::json::parse(ToJson(Some(options)).dump());
  EXPECT_TRUE(json.at("rpe").at("translation_m").is_null());
  EXPECT_TRUE(json.at("rpe").at("rotation_deg").is_null());
  EXPECT_EQ(json.at("ate_m").at("count"), 50);
}

TEST(Report, TableReads) {
  const std::string table = FormatTable(Some());
  EXPECT_THAT(table, HasSubstr("50 of 50 poses matched with the ground truth's 50 (nearest in time), over 4.9 s"));
  EXPECT_THAT(table, HasSubstr("\nATE m "));
  EXPECT_THAT(table, HasSubstr("\nRPE 1 s, m "));
  EXPECT_THAT(table, HasSubstr("\nRPE 1 s, deg "));
  EvaluationOptions options;
  options.delta = 1000;
  EXPECT_THAT(FormatTable(Some(options)), HasSubstr("RPE 1000 s, m       no pairs"));
  options.delta = 3;
  options.delta_unit = DeltaUnit::kFrames;
  options.with_scale = options.interpolate = true;
  EXPECT_THAT(FormatTable(Some(options)), HasSubstr("RPE 3 frames, m"));
  EXPECT_THAT(FormatTable(Some(options)), HasSubstr("(interpolated), over 4.9 s; aligned by a similarity, scale 0.9"));
}

}  // namespace
}  // namespace rds
