// SPDX-License-Identifier: Apache-2.0
// End to end: the command synth.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/command.h"
#include "testing/captured_output.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::HasSubstr;

// What "rds synth ..." prints on standard output.
std::string Synth(std::vector<std::string> words) {
  words.insert(words.begin(), "synth");
  CLI::App program;
  AddSynthCommand(program);
  // CLI11 wants them last to first.
  return OutputOf([&] { program.parse(std::vector<std::string>(words.rbegin(), words.rend())); });
}

TEST(SynthCommand, WritesASequenceAndSaysWhatToDoNext) {
  const TemporaryFolder folder;
  const std::string out = (folder.path() / "a room").string();
  const std::string printed = Synth({"--out", out, "--frames", "3", "--width", "64", "--seed", "5"});
  EXPECT_THAT(printed, HasSubstr("camera: " + out + "/camera.yaml"));
  EXPECT_THAT(printed, HasSubstr("rds run '" + out + "' --camera '" + out + "/camera.yaml' --segmenter stored"));
  EXPECT_TRUE(std::filesystem::exists(out + "/rgb/0.066667.png"));
  EXPECT_TRUE(std::filesystem::exists(out + "/groundtruth.txt"));
}

TEST(SynthCommand, RefusesBadValues) {
  const TemporaryFolder folder;
  const std::string out = (folder.path() / "room").string();
  const auto error = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"--out", out});
    return InputErrorOf([&] { Synth(words); });
  };
  EXPECT_THAT(error({"--scenario", "party"}), HasSubstr("'party'; there are: static, walking"));
  EXPECT_THAT(error({"--path", "zigzag"}), HasSubstr("'zigzag'; there are: orbit"));
  EXPECT_THAT(error({"--noise", "some"}), HasSubstr("--noise"));
  EXPECT_THAT(error({"--frames", "0"}), HasSubstr("frames: 0"));
  EXPECT_THAT(error({"--movers", "-1"}), HasSubstr("--movers: -1"));
  EXPECT_THAT(error({"--movers", "13"}), HasSubstr("movers: 13"));
  EXPECT_THAT(error({"--width", "8"}), HasSubstr("8x6"));
  EXPECT_FALSE(std::filesystem::exists(out));  // nothing was begun
  EXPECT_THROW(Synth({"--out", out, "--frames", "many"}), CLI::ParseError);
  EXPECT_THROW(Synth({"--frames", "3"}), CLI::RequiredError);
}

TEST(SynthCommand, RefusesAFolderThatCannotBeWritten) {
  const TemporaryFolder folder;
  folder.Write("file", "");
  const std::string message = InputErrorOf([&] {
    Synth({"--out", (folder.path() / "file" / "room").string(), "--frames", "2"});
  });
  EXPECT_THAT(message, HasSubstr("file/room"));
}

}  // namespace
}  // namespace rds
