// SPDX-License-Identifier: Apache-2.0
#include "io/options_yaml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;

class OptionsYamlTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path Write(const std::string& text) const {
    return folder_.Write("options.yaml", text);
  }
  // What reading `text` complains about, or "".
  [[nodiscard]] std::string ErrorOf(const std::string& text) const {
    return InputErrorOf([&] {
      Options options;
      ApplyOptionsFile(Write(text), options);
    });
  }

  const TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_.path() / "options.yaml";
};

TEST_F(OptionsYamlTest, WordsMayBeGivenAsAList) {
  Options options;
  ApplyOptionsFile(Write("semantic:\n  dynamic_classes: [person, cat]\n"), options);
  EXPECT_EQ(options.segmenter.dynamic_classes, "person, cat");
  EXPECT_THAT(ErrorOf("semantic:\n  dynamic_classes: [[person]]\n"), HasSubstr("a list of words"));
}

// Options in which every number, flag and choice differs from its default where its range allows.
Options Unusual() {
  Options options;
  SetOption(options, "orb.features=1234");
  SetOption(options, "orb.scale_factor=1.2345678901234567");
  SetOption(options, "system.lockstep=true");
  return options;
}

TEST_F(OptionsYamlTest, RoundTripIsExact) {
  const Options before = Unusual();
  Options after;
  ApplyOptionsFile(Write(OptionsYaml(before)), after);
  EXPECT_EQ(OptionsYaml(after), OptionsYaml(before));
  EXPECT_EQ(after.orb.features, 1234);
  EXPECT_EQ(after.orb.scale_factor, before.orb.scale_factor);
  EXPECT_TRUE(after.system.lockstep);
}

TEST_F(OptionsYamlTest, DocumentedRoundTripIsExact) {
  Options after;
  ApplyOptionsFile(Write(DocumentedOptionsYaml(Unusual())), after);
  EXPECT_EQ(OptionsYaml(after), OptionsYaml(Unusual()));
}

TEST_F(OptionsYamlTest, DocumentsMeaningRangeAndDefault) {
  EXPECT_THAT(DocumentedOptionsYaml(Unusual()),
              HasSubstr("orb:\n  # keypoints in a frame\n  # 100 .. 10000; default 1000\n  features: 1234\n"));
}

TEST_F(OptionsYamlTest, NamesOnlyChangeWhatTheyName) {
  Options options = Unusual();
  ApplyOptionsFile(Write("orb:\n  levels: 6\n"), options);
  EXPECT_EQ(options.orb.levels, 6);
  EXPECT_EQ(options.orb.features, 1234);
}

TEST_F(OptionsYamlTest, EmptyFileAndEmptyGroupChangeNothing) {
  EXPECT_EQ(ErrorOf(""), "");
  EXPECT_EQ(ErrorOf("orb:\n"), "");
}

TEST_F(OptionsYamlTest, ErrorsNameFileAndLine) {
  const std::string here = file_.string();
  EXPECT_THAT(ErrorOf("orb:\n  levels: 6\n  featurs: 5\n"), AllOf(HasSubstr(here + ":3: "), HasSubstr("orb.features")));
  EXPECT_THAT(ErrorOf("orb:\n  features: many\n"), HasSubstr(here + ":2: option orb.features: 'many'"));
  EXPECT_THAT(ErrorOf("orb:\n  features: 5\n"), AllOf(HasSubstr(here + ":2: "), HasSubstr("100 .. 10000")));
  EXPECT_THAT(ErrorOf("orb:\n  features: [1, 2]\n"), AllOf(HasSubstr(here + ":2: "), HasSubstr("one value")));
  EXPECT_THAT(ErrorOf("orb:\n  features: 500\norb.features: 600\n"),
              AllOf(HasSubstr(here + ":3: "), HasSubstr("twice")));
  EXPECT_THAT(ErrorOf("orb: 5\n"), AllOf(HasSubstr(here + ":1: "), HasSubstr("group")));
  EXPECT_THAT(ErrorOf("orb:\n  features:\n"), HasSubstr(here + ":2: "));
  EXPECT_THAT(ErrorOf("- 1\n- 2\n"), HasSubstr(here + ":1: "));
  EXPECT_THAT(ErrorOf("orb: {features: 5\nlevels"), HasSubstr(here + ":"));
}

TEST_F(OptionsYamlTest, UnreadableFileIsNamed) {
  Options options;
  for (const std::filesystem::path& path : {std::filesystem::path("/nowhere/options.yaml"), file_.parent_path()}) {
    try {
      ApplyOptionsFile(path, options);
      ADD_FAILURE() << path;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(path.string()));
    }
  }
}

}  // namespace
}  // namespace rds
