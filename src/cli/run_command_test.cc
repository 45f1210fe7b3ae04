// SPDX-License-Identifier: Apache-2.0
// End to end: the commands run, bench, ablate and config.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/details/null_mutex.h>
#include <spdlog/sinks/base_sink.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <utility>

#include "base/error.h"
#include "base/log.h"
#include "base/sha256.h"
#include "cli/command.h"
#include "io/dataset.h"
#include "io/options_yaml.h"
#include "io/text_table.h"
#include "io/trajectory_io.h"
#include "synth/synthetic_sequence.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

constexpr int kFrames = 40;

// Interrupts the program at the first message, which a run prints before the first frame.
class InterruptingSink final : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {
  void sink_it_(const spdlog::details::log_msg& /*message*/) override {
    if (!std::exchange(done_, true)) {
      raise(SIGINT);
    }
  }
  void flush_() override {}

  bool done_ = false;
};

// A short synthetic sequence with people, written once, and a folder for results.
class RunCommandTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (spdlog::get("rds") == nullptr) {
      log::SetUp(false);  // as main does: messages go to standard error, results to standard output
    }
    folder_ = std::make_unique<TemporaryFolder>();
    sequence_ = folder_->path() / "sequence";
    SyntheticOptions options;
    options.camera = MakeSyntheticCamera(320, 240);
    options.scenario = SyntheticScenario::kWalking;
    options.frames = kFrames;
    WriteSyntheticSequence(SyntheticWorld(options), sequence_);
  }
  static void TearDownTestSuite() { folder_.reset(); }
  // A copy of the sequence that may be broken.
  [[nodiscard]] fs::path CopyOfSequence() const {
    const fs::path copy = own_.path() / "copy";
    fs::copy(sequence_, copy, fs::copy_options::recursive);
    return copy;
  }

  // The exit code of "rds ...", and what it printed.
  static int Program(const std::vector<std::string>& words, std::string* printed = nullptr) {
    CLI::App program;
    AddRunCommand(program);
    AddBenchCommand(program);
    AddAblateCommand(program);
    AddConfigCommand(program);
    ::testing::internal::CaptureStdout();
    int exit_code = 0;
    try {
      program.parse(std::vector<std::string>(words.rbegin(), words.rend()));  // CLI11 wants them last to first
    } catch (const CLI::ParseError& error) {
      exit_code = error.get_exit_code();
    } catch (...) {
      ::testing::internal::GetCapturedStdout();
      throw;
    }
    const std::string text = ::testing::internal::GetCapturedStdout();
    if (printed != nullptr) {
      *printed = text;
    }
    return exit_code;
  }

  [[nodiscard]] std::vector<std::string> RunWords(std::vector<std::string> more = {}) const {
    std::vector<std::string> words = {"run",        sequence_.string(), "--out", out_.string(),
                                      "--lockstep", "--segmenter",      "stored"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  // What "rds ..." complains about, or "".
  static std::string ErrorOf(const std::vector<std::string>& words) {
    return InputErrorOf([&words] { (void)Program(words); });
  }

  [[nodiscard]] nlohmann::json Report() const { return nlohmann::json::parse(ReadFile(out_ / "report.json")); }

  inline static std::unique_ptr<TemporaryFolder> folder_;
  inline static fs::path sequence_;
  const TemporaryFolder own_;
  const fs::path out_ = own_.path() / "out";
};

TEST_F(RunCommandTest, WritesEveryOutput) {
  std::string printed;
  ASSERT_EQ(Program(RunWords(), &printed), 0);
  EXPECT_EQ(ReadTrajectory(out_ / "trajectory.txt").size(), static_cast<std::size_t>(kFrames));
  EXPECT_FALSE(ReadTrajectory(out_ / "keyframes.txt").empty());
  const nlohmann::json report = Report();
  for (const char* key :
       {"frames", "tracked", "lost", "found", "keyframes", "map_points", "start_up_s", "tracking_ms",
        "cpu_ms_per_frame", "local_ba_ms", "map_lock_ms", "peak_memory_mb", "wall_s", "ate_m", "rpe", "semantics"}) {
    EXPECT_TRUE(report.contains(key)) << key;
  }
  EXPECT_EQ(report["frames"], kFrames);
  EXPECT_EQ(report["tracked"], kFrames);
  EXPECT_GT(report["semantics"]["keyframes_labeled"], 0);
  EXPECT_LT(report["ate_m"]["rmse"], 0.05);
  EXPECT_FALSE(report["rpe"]["translation_m"].is_null());
  const std::string frames = ReadFile(out_ / "frames.csv");
  EXPECT_EQ(std::count(frames.begin(), frames.end(), '\n'), kFrames + 1);
  EXPECT_THAT(ReadFile(out_ / "semantics.csv"), HasSubstr("labeled_frame"));
  EXPECT_THAT(ReadFile(out_ / "trajectory.svg"), HasSubstr("<svg"));
  EXPECT_THAT(printed, HasSubstr("40 of 40 frames tracked"));
  EXPECT_THAT(printed, HasSubstr("ATE"));
  EXPECT_THAT(printed, HasSubstr(out_.string()));
  Options options;
  ApplyOptionsFile(out_ / "options.yaml", options);
  EXPECT_TRUE(options.system.lockstep);
}

TEST_F(RunCommandTest, LockstepGivesTheSameBytes) {
  ASSERT_EQ(Program(RunWords()), 0);
  const std::string trajectory = ReadFile(out_ / "trajectory.txt");
  const std::string keyframes = ReadFile(out_ / "keyframes.txt");
  ASSERT_EQ(Program(RunWords({"--video", (out_ / "run.mp4").string()})), 0);
  EXPECT_EQ(ReadFile(out_ / "trajectory.txt"), trajectory) << "a video must not change the result";
  EXPECT_EQ(ReadFile(out_ / "keyframes.txt"), keyframes);
  EXPECT_GT(fs::file_size(out_ / "run.mp4"), 1000U);
}

TEST_F(RunCommandTest, ThreadedRunsAreComplete) {
  ASSERT_EQ(Program({"run", sequence_.string(), "--out", out_.string(), "--segmenter", "stored", "--rate", "0", "--set",
                     "semantic.stored.delay_ms=20", "--still", (out_ / "still.png").string(), "--still-frame", "30"}),
            0);
  EXPECT_EQ(Report()["frames"], kFrames);
  EXPECT_EQ(Report()["tracked"], kFrames);
  EXPECT_EQ(cv::imread((out_ / "still.png").string()).rows, 240);
}

TEST_F(RunCommandTest, TakesAPartOfTheSequenceAndOptions) {
  ASSERT_EQ(Program(RunWords({"--frames", "5:15", "--set", "orb.features=600", "--set", "orb.levels=6"})), 0);
  EXPECT_EQ(Report()["frames"], 10);
  Options options;
  ApplyOptionsFile(out_ / "options.yaml", options);
  EXPECT_EQ(options.orb.features, 600);
  EXPECT_EQ(options.orb.levels, 6);
}

TEST_F(RunCommandTest, WithoutGroundTruthAccuracyIsNull) {
  const fs::path copy = CopyOfSequence();
  fs::remove(copy / "groundtruth.txt");
  std::vector<std::string> words = RunWords({"--frames", ":5"});
  words[1] = copy.string();
  own_.Write("out/trajectory.svg", "of a run before");
  ASSERT_EQ(Program(words), 0);
  EXPECT_TRUE(Report()["ate_m"].is_null());
  EXPECT_FALSE(fs::exists(out_ / "trajectory.svg"));
}

TEST_F(RunCommandTest, SaysWhyItNeverStarted) {
  std::string printed;
  ASSERT_EQ(Program(RunWords({"--frames", ":5", "--set", "tracking.min_start_points=10000"}), &printed), 3);
  EXPECT_EQ(Report()["tracked"], 0);
  EXPECT_EQ(Report()["not_started"], 5);
  EXPECT_THAT(printed, HasSubstr("0 of 5 frames tracked, 0 lost, 5 before the start"));
  EXPECT_THAT(printed, HasSubstr("10000 keypoints with depth"));
  EXPECT_THAT(printed, Not(HasSubstr("accuracy")));
}

TEST_F(RunCommandTest, InterruptedBeforeTheFirstFrameLeavesEarlierResultsAlone) {
  for (const char* name : {"out/trajectory.txt", "out/trajectory.svg", "out/run.mp4"}) {
    own_.Write(name, "before");
  }
  auto& sinks = spdlog::get("rds")->sinks();
  sinks.push_back(std::make_shared<InterruptingSink>());
  std::string printed;
  const int exit_code =
      Program(RunWords({"--video", (out_ / "run.mp4").string(), "--still", (out_ / "a.png").string()}), &printed);
  sinks.pop_back();
  EXPECT_EQ(exit_code, 130);
  EXPECT_EQ(printed, "");
  for (const char* name : {"out/trajectory.txt", "out/trajectory.svg", "out/run.mp4"}) {
    EXPECT_EQ(own_.Read(name), "before") << name;
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(out_), {}), 3);
}

TEST_F(RunCommandTest, OneDamagedPictureIsLeftOut) {
  const fs::path copy = CopyOfSequence();
  const fs::path broken = Dataset::Open(copy).frames()[12].color_path;
  fs::resize_file(broken, fs::file_size(broken) / 2);
  std::vector<std::string> words = RunWords();
  words[1] = copy.string();
  std::string printed;
  EXPECT_EQ(Program(words, &printed), 0);
  EXPECT_THAT(printed, HasSubstr("39 of 39 frames tracked"));
  EXPECT_THAT(printed, HasSubstr("left out: 1 frames that cannot be read"));
  EXPECT_EQ(Report()["left_out"], 1);
  EXPECT_THAT(Report()["first_left_out_because"].get<std::string>(), HasSubstr(broken.filename().string()));
}

TEST_F(RunCommandTest, WhenReadingEndsForGoodWhatWasTrackedIsWritten) {
  const fs::path copy = CopyOfSequence();
  const Dataset dataset = Dataset::Open(copy);
  for (std::size_t i = 25; i < dataset.size(); ++i) {
    fs::remove(dataset.frames()[i].depth_path);
    std::ofstream(dataset.frames()[i].depth_path) << "";
  }
  std::vector<std::string> words = RunWords({"--video", (out_ / "run.mp4").string()});
  words[1] = copy.string();
  EXPECT_THAT(ErrorOf(words), HasSubstr("reading ended for good at frame 25"));
  EXPECT_EQ(ReadTrajectory(out_ / "trajectory.txt").size(), 25U);
  EXPECT_THAT(Report()["error"].get<std::string>(), HasSubstr("for good"));
  EXPECT_TRUE(fs::exists(out_ / "run.mp4"));
}

TEST_F(RunCommandTest, ASetOfResultsIsOfOneRunOrSaysSo) {
  ASSERT_EQ(Program(RunWords({"--frames", ":10"})), 0);
  const nlohmann::json report = Report();
  const std::string id = report["run_id"];
  EXPECT_EQ(id.size(), 16U);
  for (const auto& [name, digest] : report["files"].items()) {
    EXPECT_EQ(Sha256(out_ / name), digest) << name;
  }
  EXPECT_EQ(report["files"].size(), 6U);
  for (const char* name : {"options.yaml", "frames.csv", "trajectory.svg"}) {
    EXPECT_THAT(ReadFile(out_ / name), HasSubstr(id)) << name;
  }
  EXPECT_EQ(report["camera"]["fx"], 262.5);
  EXPECT_EQ(report["input"]["folder"], sequence_.string());
  ASSERT_EQ(Program(RunWords({"--frames", ":10"})), 0);
  EXPECT_NE(Report()["run_id"], id);
}

TEST_F(RunCommandTest, NamesMayBeAnyBytes) {
  const fs::path copy = own_.path() /
                        "k\xFC"
                        "che";  // Latin-1
  fs::copy(sequence_, copy, fs::copy_options::recursive);
  std::vector<std::string> words = RunWords({"--frames", ":5"});
  words[1] = copy.string();
  ASSERT_EQ(Program(words), 0);
  EXPECT_EQ(Report()["sequence"],
            "k\xEF\xBF\xBD"
            "che");
}

TEST_F(RunCommandTest, ADepthScaleThatCannotBeIsRefusedWithTheLikelyOne) {
  const fs::path copy = CopyOfSequence();
  const std::string camera = ReadFile(copy / "camera.yaml");
  const std::string right = "depth_scale: 5000";
  std::vector<std::string> words = RunWords();
  words[1] = copy.string();
  const auto with_scale = [&](const std::string& scale) {
    std::string text = camera;
    std::ofstream(copy / "camera.yaml") << text.replace(text.find(right), right.size(), "depth_scale: " + scale);
    return ErrorOf(words);
  };
  EXPECT_THAT(with_scale("200"), HasSubstr("likely right is depth_scale: 5000"));
  EXPECT_THAT(with_scale("1.0"), HasSubstr("units in a meter"));
  EXPECT_THAT(with_scale("0.0002"), HasSubstr("depth_scale: 5000"));
}

TEST_F(RunCommandTest, BadInputWritesNothing) {
  const fs::path copy = CopyOfSequence();
  const fs::path broken = Dataset::Open(copy).frames()[12].color_path;
  fs::resize_file(broken, fs::file_size(broken) / 2);
  std::vector<std::string> words = RunWords({"--strict", "--video", (out_ / "run.mp4").string()});
  words[1] = copy.string();
  EXPECT_THAT(ErrorOf(words), HasSubstr(broken.filename().string()));
  EXPECT_TRUE(fs::is_empty(out_));
}

TEST_F(RunCommandTest, ErrorsComeBeforeTheWork) {
  EXPECT_THAT(ErrorOf(RunWords({"--set", "orb.featurs=5"})), HasSubstr("orb.features"));
  EXPECT_THAT(ErrorOf(RunWords({"--config", "/nowhere.yaml"})), HasSubstr("/nowhere.yaml"));
  EXPECT_THAT(ErrorOf(RunWords({"--preset", "papers"})), HasSubstr("did you mean 'paper'"));
  EXPECT_THAT(ErrorOf(RunWords({"--frames", "9:5"})), HasSubstr("9:5"));
  for (const char* rate : {"-1", "0.001", "1001", "nan"}) {
    EXPECT_THAT(ErrorOf(RunWords({"--rate", rate})), HasSubstr("--rate")) << rate;
  }
  EXPECT_THAT(ErrorOf(RunWords({"--camera", "/nowhere.yaml"})), HasSubstr("/nowhere.yaml"));
  EXPECT_THAT(ErrorOf(RunWords({"--still-frame", "3"})), HasSubstr("--still"));
  EXPECT_THAT(ErrorOf(RunWords({"--still", (out_ / "a.png").string(), "--still-frame", "40"})), HasSubstr("40 frames"));
  EXPECT_THAT(ErrorOf({"run", "/nowhere", "--out", out_.string()}), HasSubstr("/nowhere"));
  EXPECT_THAT(ErrorOf({"run", sequence_.string(), "--out", "/proc/nowhere", "--segmenter", "none"}),
              HasSubstr("/proc/nowhere"));
  EXPECT_THAT(ErrorOf({"run", sequence_.string(), "--out", out_.string(), "--segmenter", "storred"}),
              HasSubstr("stored"));
  EXPECT_THAT(ErrorOf({"run", sequence_.string(), "--out", out_.string(), "--segmenter", "geometry", "--set",
                       "semantic.motion=false"}),
              HasSubstr("semantic.motion"));
}

TEST_F(RunCommandTest, BenchPrintsTheRatio) {
  std::string printed;
  ASSERT_EQ(Program({"bench", sequence_.string(), "--rate", "0"}, &printed), 0);
  const nlohmann::json report = nlohmann::json::parse(printed);
  EXPECT_EQ(report["frames"], kFrames);
  EXPECT_GT(report["ratio"], 0);
  EXPECT_GT(report["shares"]["extraction"], 0);
  EXPECT_EQ(report["segmenter"], "none");
}

TEST_F(RunCommandTest, AblateComparesVariants) {
  std::string printed;
  ASSERT_EQ(
      Program({"ablate", sequence_.string(), "--frames", ":15", "--only", "no semantics", "--only", "whole", "--json"},
              &printed),
      0);
  const nlohmann::json rows = nlohmann::json::parse(printed);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0]["variant"], "whole");
  EXPECT_EQ(rows[1]["labeled"], 0);
  EXPECT_THAT(ErrorOf({"ablate", sequence_.string(), "--only", "hole"}), HasSubstr("whole"));
}

TEST_F(RunCommandTest, ConfigPrintsWhatConfigReads) {
  std::string printed;
  ASSERT_EQ(Program({"config", "--set", "orb.features=777"}, &printed), 0);
  const fs::path file = own_.Write("options.yaml", printed);
  Options options;
  ApplyOptionsFile(file, options);
  EXPECT_EQ(options.orb.features, 777);
}

}  // namespace
}  // namespace rds
