// SPDX-License-Identifier: Apache-2.0
#include "base/version.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace rds {
namespace {

TEST(Version, IsTheBuildsOwn) {
  const auto root = std::filesystem::path(__FILE__).parent_path().parent_path().parent_path();
  std::ifstream file(root / "CMakeLists.txt");
  const std::string text(std::istreambuf_iterator<char>(file), {});
  std::string expected = "project(rds VERSION ";
  expected += kVersion;
  expected += " ";
  EXPECT_THAT(text, ::testing::HasSubstr(expected));
}

}  // namespace
}  // namespace rds
