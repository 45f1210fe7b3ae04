// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/command.h"
#include "cli/program.h"
#include "io/trajectory_io.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class EvalCommandTest : public ::testing::Test {
 protected:
  EvalCommandTest() {
    Trajectory truth;
    for (int i = 0; i < 100; ++i) {
      truth.push_back({i / 30.0, {Eigen::Quaterniond::Identity(), {std::sin(0.1 * i), std::cos(0.1 * i), 0.01 * i}}});
    }
    Trajectory estimate = truth;
    for (StampedPose& pose : estimate) {
      pose.world_from_camera.translation *= 0.5;
    }
    std::filesystem::create_directories(folder_.path() / "sequence");
    std::filesystem::create_directories(folder_.path() / "result");
    WriteTrajectory(folder_.path() / "sequence/groundtruth.txt", truth);
    WriteTrajectory(folder_.path() / "result/trajectory.txt", estimate);
  }

  // Exit code of `rds eval result sequence OPTIONS`; output to stdout_ and stderr_.
  int Eval(std::vector<std::string> options = {}) {
    std::vector<std::string> words = {"rds", "eval", (folder_.path() / "result").string(),
                                      (folder_.path() / "sequence/groundtruth.txt").string()};
    words.insert(words.end(), options.begin(), options.end());
    std::vector<const char*> arguments;
    for (const std::string& word : words) {
      arguments.push_back(word.c_str());
    }
    CLI::App app("", "rds");
    AddEvalCommand(app);
    std::ostringstream out;
    std::ostringstream error;
    ::testing::internal::CaptureStdout();
    const int code = RunProgram(app, static_cast<int>(arguments.size()), arguments.data(), out, error);
    std::cout.flush();
    stdout_ = ::testing::internal::GetCapturedStdout() + out.str();
    stderr_ = error.str();
    return code;
  }

  TemporaryFolder folder_;
  std::string stdout_;
  std::string stderr_;
};

TEST_F(EvalCommandTest, PrintsATable) {
  EXPECT_EQ(Eval(), 0);
  EXPECT_THAT(stdout_, AllOf(HasSubstr("100 of 100 poses matched"), HasSubstr("ATE m"), HasSubstr("RPE 1 s, deg")));
}

TEST_F(EvalCommandTest, PrintsJson) {
  EXPECT_EQ(Eval({"--json"}), 0);
  const auto json = nlohmann::json::parse(stdout_);
  EXPECT_GT(json.at("ate_m").at("rmse").get<double>(), 0.3);
  EXPECT_EQ(json.at("rpe").at("translation_m").at("count"), 70);
}

TEST_F(EvalCommandTest, TakesOptions) {
  EXPECT_EQ(Eval({"--json", "--scale", "--interpolate", "--max-difference", "0.02", "--delta-frames", "10"}), 0);
  const auto json = nlohmann::json::parse(stdout_);
  EXPECT_LT(json.at("ate_m").at("rmse").get<double>(), 1e-6);
  EXPECT_NEAR(json.at("alignment").at("scale").get<double>(), 2, 1e-6);
  EXPECT_EQ(json.at("rpe").at("delta_unit"), "frames");
  EXPECT_EQ(json.at("rpe").at("translation_m").at("count"), 90);
  EXPECT_EQ(json.at("association"), "interpolated");
}

TEST_F(EvalCommandTest, Draws) {
  EXPECT_EQ(Eval({"--plot", (folder_.path() / "a.svg").string()}), 0);
  EXPECT_THAT(folder_.Read("a.svg"), HasSubstr(">sequence: ATE "));
}

TEST_F(EvalCommandTest, NamesWhatIsWrong) {
  EXPECT_EQ(Eval({"--plot", "/none/a.svg"}), 1);
  EXPECT_THAT(stderr_, HasSubstr("rds: error: /none/a.svg: cannot be written: No such file or directory"));
  EXPECT_EQ(stdout_, "");
  EXPECT_EQ(Eval({"--jsn"}), 1);
  EXPECT_THAT(stderr_, HasSubstr("unknown option '--jsn' (did you mean '--json'?); see `rds eval --help`"));
  EXPECT_EQ(Eval({"--delta", "0"}), 1);
  EXPECT_THAT(stderr_, HasSubstr("the delta of the relative pose error is 0"));
  EXPECT_EQ(Eval({"--delta", "2", "--delta-frames", "2"}), 1);
  EXPECT_THAT(stderr_, HasSubstr("--delta excludes --delta-frames"));
  folder_.Write("result/trajectory.txt", "1 2 3\n");
  EXPECT_EQ(Eval(), 1);
  EXPECT_THAT(stderr_, HasSubstr("trajectory.txt:1: 3 columns"));
  std::filesystem::remove(folder_.path() / "result/trajectory.txt");
  EXPECT_EQ(Eval(), 1);
  EXPECT_THAT(stderr_, HasSubstr("trajectory.txt: cannot be read: No such file"));
}

}  // namespace
}  // namespace rds
