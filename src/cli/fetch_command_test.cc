// SPDX-License-Identifier: Apache-2.0
#include "cli/fetch_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "base/error.h"

namespace rds {
namespace {

using testing::HasSubstr;

// The command line as given; returns the error's text.
std::string Parse(const std::string& line) {
  CLI::App program;
  AddFetchCommand(program);
  try {
    program.parse(line);
  } catch (const InputError& error) {
    return error.what();
  } catch (const CLI::ParseError& error) {
    return error.what();
  }
  return "no error";
}

TEST(FetchCommandTest, UnknownNamesSuggestTheNearest) {
  EXPECT_THAT(Parse("fetch weigths"), HasSubstr("rds fetch weights"));
  EXPECT_THAT(Parse("fetch weights fats"), HasSubstr("'fast'"));
  EXPECT_THAT(Parse("fetch"), HasSubstr("WHAT"));
}

TEST(FetchCommandTest, NoNetworkNamesTheMirrorAndTheWayByHand) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "rds_fetch_command";
  setenv("RDS_CACHE", folder.c_str(), 1);
  const std::string error = Parse("fetch weights fast --url-base http://127.0.0.1:1/mirror");
  unsetenv("RDS_CACHE");
  std::filesystem::remove_all(folder);
  EXPECT_THAT(error, HasSubstr("http://127.0.0.1:1/mirror/deeplabv3_mnv2_dm05_pascal_quant.tflite"));
  EXPECT_THAT(error, HasSubstr((folder / "deeplabv3_mnv2_dm05_pascal_quant.tflite").string()));
  EXPECT_THAT(error, HasSubstr("by hand"));
}

}  // namespace
}  // namespace rds
