// End to end: the commands run, bench, ablate and config.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "base/error.h"
#include "base/log.h"
#include "cli/command.h"
#include "io/dataset.h"
#include "io/options_yaml.h"
#include "io/text_table.h"
#include "io/trajectory_io.h"
#include "testing/synthetic_sequence.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

constexpr int kFrames = 40;

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
  for (const char* key : {"frames", "tracked", "lost", "keyframes", "map_points", "start_up_s", "tracking_ms",
                          "cpu_ms_per_frame", "local_ba_ms", "peak_memory_mb", "wall_s", "ate_m", "rpe", "semantics"}) {
    EXPECT_TRUE(report.contains(key)) << key;
  }
  EXPECT_EQ(report["frames"], kFrames);
  EXPECT_EQ(report["tracked"], kFrames);
  EXPECT_GT(report["semantics"]["keyframes_labelled"], 0);
  EXPECT_LT(report["ate_m"]["rmse"], 0.05);
  EXPECT_FALSE(report["rpe"]["translation_m"].is_null());
  const std::string frames = ReadFile(out_ / "frames.csv");
  EXPECT_EQ(std::count(frames.begin(), frames.end(), '\n'), kFrames + 1);
  EXPECT_THAT(ReadFile(out_ / "semantics.csv"), HasSubstr("labelled_frame"));
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
  ASSERT_EQ(Program(words), 0);
  EXPECT_TRUE(Report()["ate_m"].is_null());
  EXPECT_FALSE(fs::exists(out_ / "trajectory.svg"));
}

TEST_F(RunCommandTest, BadInputWritesNothing) {
  const fs::path copy = CopyOfSequence();
  const fs::path broken = Dataset::Open(copy).frames()[12].color_path;
  fs::resize_file(broken, fs::file_size(broken) / 2);
  std::vector<std::string> words = RunWords({"--video", (out_ / "run.mp4").string()});
  words[1] = copy.string();
  EXPECT_THAT(ErrorOf(words), HasSubstr(broken.filename().string()));
  EXPECT_TRUE(fs::is_empty(out_));
}

TEST_F(RunCommandTest, ErrorsComeBeforeTheWork) {
  EXPECT_THAT(ErrorOf(RunWords({"--set", "orb.featurs=5"})), HasSubstr("orb.features"));
  EXPECT_THAT(ErrorOf(RunWords({"--config", "/nowhere.yaml"})), HasSubstr("/nowhere.yaml"));
  EXPECT_THAT(ErrorOf(RunWords({"--frames", "9:5"})), HasSubstr("9:5"));
  EXPECT_THAT(ErrorOf(RunWords({"--rate", "-1"})), HasSubstr("--rate"));
  EXPECT_THAT(ErrorOf(RunWords({"--camera", "/nowhere.yaml"})), HasSubstr("/nowhere.yaml"));
  EXPECT_THAT(ErrorOf(RunWords({"--still-frame", "3"})), HasSubstr("--still"));
  EXPECT_THAT(ErrorOf(RunWords({"--still", (out_ / "a.png").string(), "--still-frame", "40"})), HasSubstr("40 frames"));
  EXPECT_THAT(ErrorOf({"run", "/nowhere", "--out", out_.string()}), HasSubstr("/nowhere"));
  EXPECT_THAT(ErrorOf({"run", sequence_.string(), "--out", "/proc/nowhere", "--segmenter", "none"}),
              HasSubstr("/proc/nowhere"));
  EXPECT_THAT(ErrorOf({"run", sequence_.string(), "--out", out_.string(), "--segmenter", "storred"}),
              HasSubstr("stored"));
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
  EXPECT_EQ(rows[1]["labelled"], 0);
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
