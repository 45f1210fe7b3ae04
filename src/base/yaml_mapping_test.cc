// SPDX-License-Identifier: Apache-2.0
#include "base/yaml_mapping.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "testing/temporary_folder.h"

namespace rds {
namespace {
using testing::EndsWith;
using testing::HasSubstr;

YamlMapping Of(const std::string& text, const std::string& name = "") {
  return {"a.yaml", YAML::Load(text), {"size", "names", "word"}, name};
}

TEST(YamlMapping, ReadsWhatIsThereAndLeavesTheRest) {
  const YamlMapping map = Of("size: 3\nnames: [a, b]");
  int size = 0;
  map.Read("size", size);
  EXPECT_EQ(size, 3);
  std::string word = "default";
  map.Read("word", word);
  EXPECT_EQ(word, "default");
  EXPECT_EQ(map.List("names").size(), 2U);
  EXPECT_TRUE(map.List("word").empty());
}

TEST(YamlMapping, NothingSaidHasNoKeys) {
  for (const YAML::Node& nothing : {YAML::Node(), YAML::Node(YAML::NodeType::Undefined), YAML::Load("~")}) {
    const YamlMapping map("a.yaml", nothing, {"size"});
    int size = 5;
    map.Read("size", size);
    EXPECT_EQ(size, 5);
    EXPECT_TRUE(map.List("size").empty());
    EXPECT_THAT(InputErrorOf([&] { (void)map.Need("size"); }), EndsWith("'size' is missing"));
  }
}

TEST(YamlMapping, ErrorsNameFileLineAndKey) {
  EXPECT_THAT(InputErrorOf([] { Of("size: 1\nnmes: 2", "input"); }),
              testing::AllOf(HasSubstr("a.yaml:2: unknown key 'input.nmes'"), HasSubstr("'names'")));
  EXPECT_THAT(InputErrorOf([] { Of("[1]"); }), HasSubstr("a.yaml:1: a mapping is wanted"));
  EXPECT_THAT(InputErrorOf([] { Of("[1]: 2"); }), HasSubstr("unknown key ''"));
  int size = 0;
  EXPECT_EQ(InputErrorOf([&] { Of("word: a\nsize: b", "input").Read("size", size, "a number"); }),
            "a.yaml:2: input.size must be a number");
  EXPECT_THAT(InputErrorOf([&] { Of("size: b").Read("size", size); }), EndsWith("size must be a number"));
  EXPECT_THAT(InputErrorOf([] { (void)Of("names: 5").List("names"); }), HasSubstr("names must be a list"));
  EXPECT_THAT(InputErrorOf([] { (void)Of("size: 5").Need("word"); }), HasSubstr("'word' is missing"));
}

}  // namespace
}  // namespace rds
