// SPDX-License-Identifier: Apache-2.0
#include "base/strict_yaml.h"

#include <gmock/gmock.h>
#include <yaml-cpp/yaml.h>

#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::HasSubstr;

std::string ErrorOf(const std::string& text) {
  const TemporaryFolder folder;
  const auto path = folder.Write("f.yaml", text);
  return InputErrorOf([&] { (void)ReadStrictYaml(path); });
}

TEST(ReadStrictYaml, ReadsOneDocument) {
  const TemporaryFolder folder;
  const YAML::Node node = ReadStrictYaml(folder.Write("f.yaml", "%YAML:1.0\n---\na: 1\nb: [2, {c: 3}]\n---\n"));
  EXPECT_EQ(node["a"].as<int>(), 1);
  EXPECT_EQ(node["b"][1]["c"].as<int>(), 3);
  EXPECT_TRUE(ReadStrictYaml(folder.Write("f.yaml", "")).IsNull());
  EXPECT_EQ(ReadStrictYaml(folder.Write("f.yaml", "\xEF\xBB\xBFx: 5\r\n"))["x"].as<int>(), 5);
}

TEST(ReadStrictYaml, RefusesWhatHasNoEnd) {
  EXPECT_THAT(ErrorOf("a: &x\n  b: *x\n"), HasSubstr("f.yaml:2: an alias"));
  EXPECT_THAT(ErrorOf("a: &x {y: *x}\n"), HasSubstr("f.yaml:1: an alias"));
  EXPECT_THAT(ErrorOf(std::string(17, '[') + std::string(17, ']')), HasSubstr("nested deeper than 16"));
  EXPECT_NE(ErrorOf(std::string(100'000, '[')), "");
  EXPECT_NE(ErrorOf(std::string(100'000, '{')), "");
  std::string many = "a: [";
  for (int i = 0; i < 20'001; ++i) {
    many += "1,";
  }
  EXPECT_THAT(ErrorOf(many + "]\n"), HasSubstr("more than 20000 values"));
  EXPECT_THAT(ErrorOf(std::string(1'000'001, ' ')), HasSubstr("more than 1000000 bytes"));
}

TEST(ReadStrictYaml, RefusesWhatIsAmbiguous) {
  EXPECT_THAT(ErrorOf("a: 1\n---\nb: 2\n"), HasSubstr("a second document"));
  EXPECT_THAT(ErrorOf("a: 1\nb: {c: 2}\na: 3\n"), HasSubstr("f.yaml:3: 'a' stands there twice"));
  EXPECT_EQ(ErrorOf("a: {c: 1}\nb: {c: 2}\n"), "");
  EXPECT_THAT(ErrorOf("[a]: 1\n"), HasSubstr("f.yaml:1: the name before ':' must be a word"));
  EXPECT_THAT(ErrorOf("a: [1\n"), HasSubstr("not YAML"));
  EXPECT_THAT(InputErrorOf([] { (void)ReadStrictYaml("/none.yaml"); }), HasSubstr("/none.yaml: cannot be read"));
}

}  // namespace
}  // namespace rds
