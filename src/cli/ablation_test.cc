// SPDX-License-Identifier: Apache-2.0
#include "cli/ablation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "io/options_yaml.h"
#include "system/options.h"

namespace rds {
namespace {

using ::testing::HasSubstr;

const std::vector<AblationRow>& Rows() {
  static const std::vector<AblationRow> rows = {
      {"whole", "all on", 100, 99, 0.04712, 0.02, 30, 28, 9.5, 7.25},
      {"none", "all off", 100, 60, std::nullopt, std::nullopt, 20, 0, std::nullopt, 7},
  };
  return rows;
}

TEST(Ablation, VariantsCanBeSet) {
  std::set<std::string> names;
  for (const AblationVariant& variant : AblationVariants()) {
    EXPECT_TRUE(names.insert(variant.name).second) << variant.name;
    EXPECT_FALSE(variant.meaning.empty());
    Options options;
    for (const std::string& assignment : variant.overrides) {
      EXPECT_NO_THROW(SetOption(options, assignment)) << assignment;
    }
    EXPECT_NO_THROW(ValidateOptions(options)) << variant.name;
  }
  EXPECT_TRUE(AblationVariants().front().overrides.empty()) << "the first is the base";
}

TEST(Ablation, EveryOverrideDiffersFromTheDefault) {
  for (const AblationVariant& variant : AblationVariants()) {
    for (const std::string& assignment : variant.overrides) {
      Options changed;
      SetOption(changed, assignment);
      EXPECT_NE(OptionsYaml(changed), OptionsYaml(Options{})) << assignment;
    }
  }
}

TEST(Ablation, TextLinesUp) {
  const std::string text = AblationText(Rows());
  EXPECT_THAT(text, HasSubstr("\nwhole     99/100        0.0471 "));
  const std::size_t width = text.find('\n');
  for (std::size_t at = 0; at < text.size(); at += width + 1) {
    EXPECT_EQ(text.find('\n', at), at + width);
  }
}

TEST(Ablation, MarkdownHasHeadingRuleAndRows) {
  const std::string text = AblationMarkdown(Rows());
  EXPECT_THAT(text, HasSubstr("| variant | tracked |"));
  EXPECT_THAT(text, HasSubstr("\n|---|---:|---:|---:|---:|---:|---:|---:|\n"));
  EXPECT_THAT(text, HasSubstr("\n| none | 60/100 | - | - | 20 | 0 | - | 7.00 |\n"));
  EXPECT_THAT(text, HasSubstr("\n- whole: all on.\n"));
}

TEST(Ablation, JsonKeepsWhatIsMissing) {
  const nlohmann::ordered_json json = AblationJson(Rows());
  ASSERT_EQ(json.size(), 2U);
  EXPECT_DOUBLE_EQ(json[0]["ate_rmse_m"], 0.04712);
  EXPECT_TRUE(json[1]["ate_rmse_m"].is_null());
}

}  // namespace
}  // namespace rds
