// SPDX-License-Identifier: Apache-2.0
// End to end: the command segment.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "base/file.h"
#include "cli/command.h"
#include "io/image_io.h"
#include "synth/synthetic_sequence.h"
#include "testing/captured_output.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
namespace fs = std::filesystem;

// A sequence of twelve frames with people, and a folder for masks.
class SegmentCommandTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    sequence_ = folder_->path() / "sequence";
    SyntheticOptions options;
    options.camera = MakeSyntheticCamera(320, 240);
    options.scenario = SyntheticScenario::kWalking;
    options.frames = 12;
    WriteSyntheticSequence(SyntheticWorld(options), sequence_);
  }
  static void TearDownTestSuite() { folder_.reset(); }

  // What "rds ..." prints on standard output.
  static std::string Program(const std::vector<std::string>& words) {
    CLI::App program;
    AddSegmentCommand(program);
    AddRunCommand(program);
    // CLI11 wants them last to first.
    return OutputOf([&] { program.parse(std::vector<std::string>(words.rbegin(), words.rend())); });
  }
  [[nodiscard]] std::string Segment(std::vector<std::string> more = {}, const std::string& segmenter = "stored") const {
    std::vector<std::string> words = {"segment", sequence_.string(), "--out", out_.string(), "--segmenter", segmenter};
    words.insert(words.end(), more.begin(), more.end());
    return Program(words);
  }
  // The trajectory of a run with these masks.
  [[nodiscard]] std::string Run(const std::vector<std::string>& masks) const {
    std::vector<std::string> words = {"run",         sequence_.string(), "--out",     (own_.path() / "run").string(),
                                      "--segmenter", "stored",           "--lockstep"};
    words.insert(words.end(), masks.begin(), masks.end());
    (void)Program(words);
    return ReadFile(own_.path() / "run" / "trajectory.txt");
  }

  inline static std::unique_ptr<TemporaryFolder> folder_;
  inline static fs::path sequence_;
  const TemporaryFolder own_;
  const fs::path out_ = own_.path() / "masks";
};

TEST_F(SegmentCommandTest, MasksArePlayedBackAsTheyWere) {
  EXPECT_THAT(Segment(), HasSubstr("12 masks, 12 of them made now"));
  EXPECT_THAT(ReadFile(out_ / "mask.txt"), StartsWith("# rds segment: stored"));
  EXPECT_EQ(Run({"--masks", out_.string()}), Run({}));
  fs::remove(out_ / "mask.txt");
  EXPECT_THAT(InputErrorOf([&] { (void)Run({"--masks", out_.string()}); }), HasSubstr("no mask.txt in it"));
}

TEST_F(SegmentCommandTest, GoesOnWhereItWasStopped) {
  EXPECT_THAT(Segment({"--frames", ":5"}), HasSubstr("5 masks, 5 of them made now"));
  fs::remove(out_ / "mask" / "0.033333.png");
  EXPECT_THAT(Segment(), HasSubstr("12 masks, 8 of them made now"));
  EXPECT_EQ(ReadMask(out_ / "mask" / "0.033333.png").width, 320);
}

TEST_F(SegmentCommandTest, OverwritesNobodysMasks) {
  EXPECT_THAT(InputErrorOf([&] {
                (void)Program({"segment", sequence_.string(), "--out", sequence_.string(), "--segmenter", "stored"});
              }),
              HasSubstr("did not write"));
  EXPECT_THAT(ReadFile(sequence_ / "mask.txt"), Not(HasSubstr("rds segment")));
  EXPECT_THAT(InputErrorOf([&] { (void)Segment({}, "geometry"); }), HasSubstr("no masks"));
  EXPECT_THAT(InputErrorOf([&] {
                (void)Program({"run", sequence_.string(), "--out", out_.string(), "--masks", "x"});
              }),
              HasSubstr("--segmenter stored"));
}

}  // namespace
}  // namespace rds
