// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "base/error.h"
#include "system/option_binding.h"
#include "system/presets.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string ErrorOfSet(const std::string& key, const std::string& value) {
  return InputErrorOf([&] {
    Options options;
    SetOption(options, key, value);
  });
}

TEST(Options, DefaultsAreValid) { EXPECT_NO_THROW(ValidateOptions(Options{})); }

TEST(Options, EveryEntryIsExplained) {
  Options options;
  const OptionTable table = BindOptions(options);
  for (const OptionEntry& entry : table.entries()) {
    EXPECT_FALSE(entry.meaning.empty()) << entry.key;
    EXPECT_FALSE(entry.range.empty()) << entry.key;
    EXPECT_THAT(entry.key, HasSubstr("."));
  }
}

// Else a group would be printed twice, which YAML forbids.
TEST(Options, KeysOfAGroupStandTogether) {
  Options options;
  std::set<std::string> closed;
  std::set<std::string> open;
  const OptionTable table = BindOptions(options);
  for (const OptionEntry& entry : table.entries()) {
    std::set<std::string> groups;
    for (std::size_t dot = entry.key.find('.'); dot != std::string::npos; dot = entry.key.find('.', dot + 1)) {
      groups.insert(entry.key.substr(0, dot));
      EXPECT_FALSE(closed.contains(entry.key.substr(0, dot))) << entry.key;
    }
    std::set_difference(open.begin(), open.end(), groups.begin(), groups.end(), std::inserter(closed, closed.end()));
    open = groups;
  }
}

// What a preset sets must be in the options that are written beside a result.
TEST(Options, APresetIsAMatterOfOptions) {
  for (const std::string& name : PresetNames()) {
    Options preset;
    ApplyPreset(preset, name);
    EXPECT_NO_THROW(ValidateOptions(preset));
    Options rebuilt;
    int changed = 0;
    Options defaults;
    const OptionTable of_preset = BindOptions(preset);
    const OptionTable of_defaults = BindOptions(defaults);
    for (std::size_t i = 0; i < of_preset.entries().size(); ++i) {
      const OptionEntry& entry = of_preset.entries()[i];
      changed += entry.get() != of_defaults.entries()[i].get() ? 1 : 0;
      SetOption(rebuilt, entry.key, entry.get());
    }
    EXPECT_GT(changed, 5);
    EXPECT_EQ(rebuilt.mapping.bundle.labeled_only, preset.mapping.bundle.labeled_only);
  }
  Options options;
  EXPECT_THAT(InputErrorOf([&] { ApplyPreset(options, "orb"); }), HasSubstr("paper"));
}

TEST(Options, SetsEachType) {
  Options options;
  SetOption(options, "orb.features", "1500");
  SetOption(options, "orb.scale_factor", "1.25");
  SetOption(options, "system.lockstep=true");
  EXPECT_EQ(options.orb.features, 1500);
  EXPECT_EQ(options.orb.scale_factor, 1.25);
  EXPECT_TRUE(options.system.lockstep);
}

TEST(Options, UnknownKeySuggestsTheNearest) {
  EXPECT_THAT(ErrorOfSet("orb.featurs", "5"), AllOf(HasSubstr("orb.featurs"), HasSubstr("'orb.features'")));
  EXPECT_THAT(ErrorOfSet("nothing_like_it_at_all", "5"), HasSubstr("unknown option"));
}

TEST(Options, WrongTypeNamesKeyValueAndRange) {
  for (const char* value : {"many", "", "12x", "1e3", "1.5", " 500"}) {
    EXPECT_THAT(ErrorOfSet("orb.features", value),
                AllOf(HasSubstr("orb.features"), HasSubstr("'" + std::string(value) + "'"), HasSubstr("100 .. 10000")));
  }
  EXPECT_THAT(ErrorOfSet("system.lockstep", "1"), HasSubstr("true or false"));
}

TEST(Options, OutOfRangeNamesKeyValueAndRange) {
  for (const char* value : {"99", "10001", "-3"}) {
    EXPECT_THAT(ErrorOfSet("orb.features", value),
                AllOf(HasSubstr("orb.features"), HasSubstr(value), HasSubstr("100 .. 10000")));
  }
  EXPECT_THAT(ErrorOfSet("orb.features", "99999999999"), HasSubstr("orb.features"));
  EXPECT_THAT(ErrorOfSet("orb.scale_factor", "nan"), HasSubstr("range"));
  EXPECT_EQ(ErrorOfSet("orb.features", "100"), "");
  EXPECT_EQ(ErrorOfSet("orb.features", "10000"), "");
}

TEST(Options, FailedSetLeavesTheValue) {
  Options options;
  EXPECT_THROW(SetOption(options, "orb.features", "1"), InputError);
  EXPECT_EQ(options.orb.features, Options{}.orb.features);
}

TEST(Options, AssignmentNeedsAKey) {
  Options options;
  EXPECT_THAT(InputErrorOf([&] { SetOption(options, "orb.features"); }), HasSubstr("key=value"));
  EXPECT_THAT(InputErrorOf([&] { SetOption(options, "=5"); }), HasSubstr("key=value"));
}

TEST(Options, ValidateFindsWhatCodeSet) {
  Options options;
  options.orb.levels = 0;
  EXPECT_THAT(InputErrorOf([&] { ValidateOptions(options); }), HasSubstr("orb.levels"));
  options = {};
  options.orb.min_fast_threshold = options.orb.fast_threshold + 1;
  EXPECT_THAT(InputErrorOf([&] { ValidateOptions(options); }), HasSubstr("orb.min_fast_threshold"));
}

TEST(OptionTable, ChoiceTakesNamesOnly) {
  enum class Color { kRed, kGreen, kBlue } color = Color::kGreen;
  OptionTable table;
  table.Choice("a.color", color, {{"red", Color::kRed}, {"green", Color::kGreen}, {"blue", Color::kBlue}}, "hue");
  const OptionEntry& entry = table.Find("a.color");
  EXPECT_EQ(entry.get(), "green");
  EXPECT_EQ(entry.range, "red, green or blue");
  entry.set("blue");
  EXPECT_EQ(color, Color::kBlue);
  EXPECT_THAT(InputErrorOf([&] { entry.set("pink"); }), AllOf(HasSubstr("a.color"), HasSubstr("red, green or blue")));
}

TEST(OptionTable, SameKeyTwiceIsABug) {
  bool value = false;
  OptionTable table;
  table.Flag("a.b", value, "x");
  EXPECT_THROW(table.Flag("a.b", value, "x"), InvariantError);
}

TEST(OptionTable, NumbersReadBackExactly) {
  double value = 0.1 + 0.2;
  const double before = value;
  OptionTable table;
  table.Real("a.b", value, 0, 1, "x");
  table.Find("a.b").set(table.Find("a.b").get());
  EXPECT_EQ(value, before);
}

}  // namespace
}  // namespace rds
