// SPDX-License-Identifier: Apache-2.0
// Suites: their files, their plan, and the report of their runs.
#include "cli/suite.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <opencv2/imgcodecs.hpp>

#include "base/file.h"
#include "cli/suite_report.h"
#include "cli/suite_results.h"
#include "cli/suite_runner.h"
#include "cli/suite_tables.h"
#include "eval/line_plot.h"
#include "io/trajectory_io.h"
#include "synth/synthetic_sequence.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;
namespace fs = std::filesystem;

constexpr const char* kSuite = R"(
title: Two rooms
repetitions: 3
published: published.yaml
sequences:
  - {name: fr3/w/xyz, path: sequence, frames: "2:8"}
configurations:
  - {name: "200 ms, 15 Hz", segmenter: stored, rate: 0.5, preset: paper, set: [semantic.stored.delay_ms=200]}
  - {name: exact, masks_by: fast, lockstep: true}
methods:
  - name: another system
    trajectories: {fr3/w/xyz: [a.txt, b.txt]}
pictures: [3]
)";

constexpr const char* kPublished = R"(
methods:
  - name: DS-SLAM
    source: "a paper, table 1"
    hardware: P4000
    track_ms: "> 65"
    ate_m: {fr3/w/xyz: [0.0247, 0.0161]}
    rpe_rotation_deg: {fr3/w/xyz: 0.8266}
    labeled_keyframes: {fr3/w/xyz: {15 Hz: 286}}
)";

class SuiteTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    SyntheticOptions options;
    options.camera = MakeSyntheticCamera(64, 48);
    options.frames = 10;
    WriteSyntheticSequence(SyntheticWorld(options), folder_->path() / "sequence");
    folder_->Write("published.yaml", kPublished);
    const std::string truth = ReadFile(folder_->path() / "sequence" / "groundtruth.txt");
    folder_->Write("a.txt", truth);
    folder_->Write("b.txt", truth);
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static Suite Read(const std::string& text) { return ReadSuite(folder_->Write("suite.yaml", text), ""); }
  static std::string ErrorOf(const std::string& text) {
    return InputErrorOf([&] { (void)Read(text); });
  }

  inline static std::unique_ptr<TemporaryFolder> folder_;
};

TEST_F(SuiteTest, ReadsWhatASuiteSays) {
  const Suite suite = Read(kSuite);
  EXPECT_EQ(suite.title, "Two rooms");
  EXPECT_EQ(suite.sequences[0].path, folder_->path() / "sequence");
  EXPECT_EQ(suite.configurations[0].rate, 0.5);
  EXPECT_EQ(suite.configurations[1].segmenter, "stored");
  EXPECT_EQ(suite.methods[0].trajectories.at("fr3/w/xyz").size(), 2U);
  EXPECT_EQ(suite.published[0].ate_m.at("fr3/w/xyz").std, 0.0161);
  EXPECT_EQ(suite.published[0].rpe_rotation_deg.at("fr3/w/xyz").std, std::nullopt);
  EXPECT_EQ(suite.published[0].labeled_keyframes.at("fr3/w/xyz").at("15 Hz"), 286);
  EXPECT_EQ(ReadSuite(folder_->path() / "suite.yaml", "/data").sequences[0].path, "/data/sequence");
}

TEST_F(SuiteTest, RefusesWhatIsNoSuite) {
  EXPECT_THAT(ErrorOf("{}"), HasSubstr("a suite has sequences"));
  EXPECT_THAT(ErrorOf("sequnces: []"), HasSubstr("'sequences'"));
  EXPECT_THAT(ErrorOf("sequences: [{name: x}]"), HasSubstr("'path' is missing"));
  EXPECT_THAT(ErrorOf("sequences: [x]"), HasSubstr("a mapping is wanted"));
  EXPECT_THAT(ErrorOf("sequences: 5"), HasSubstr("sequences must be a list"));
  EXPECT_THAT(ErrorOf("repetitions: many"), HasSubstr("repetitions must be a number"));
  EXPECT_THAT(ErrorOf("repetitions: 0"), HasSubstr("1 to 1000"));
  EXPECT_THAT(ErrorOf("configurations: [{name: a, rate: 0}]"), HasSubstr("rate"));
  EXPECT_THAT(ErrorOf("sequences: [{name: a/b, path: x}, {name: a b, path: y}]\nconfigurations: [{name: c}]"),
              HasSubstr("two sequences"));
}

TEST_F(SuiteTest, PlansMasksThenRepetitionsThenPictures) {
  const std::vector<SuiteJob> jobs = PlanSuite(Read(kSuite), "/out");
  ASSERT_EQ(jobs.size(), 1U + 4U + 2U);  // what is in lockstep repeats itself
  EXPECT_EQ(jobs[0].kind, JobKind::kMasks);
  EXPECT_THAT(jobs[0].arguments, IsSupersetOf({"segment", "--model", "fast", "2:8"}));
  std::vector<std::string> folders;
  std::ranges::transform(jobs.begin() + 1, jobs.begin() + 5, std::back_inserter(folders),
                         [](const SuiteJob& job) { return job.folder.string(); });
  EXPECT_THAT(folders, ElementsAre("/out/runs/fr3_w_xyz/200_ms_15_Hz/1", "/out/runs/fr3_w_xyz/exact/1",
                                   "/out/runs/fr3_w_xyz/200_ms_15_Hz/2", "/out/runs/fr3_w_xyz/200_ms_15_Hz/3"));
  EXPECT_THAT(jobs[1].arguments,
              IsSupersetOf({"run", "--preset", "paper", "--rate", "0.5", "semantic.stored.delay_ms=200", "2:8"}));
  EXPECT_NEAR(jobs[1].expected_s, 2 * 5 / 30.0, 1e-3);
  EXPECT_THAT(jobs[2].arguments, Contains("--lockstep"));
  EXPECT_THAT(jobs[2].arguments, Contains("/out/masks/fr3_w_xyz/fast"));
  EXPECT_EQ(jobs[5].kind, JobKind::kPicture);
  EXPECT_THAT(jobs[5].arguments, IsSupersetOf({"--still-frame", "3", "2:6"}));
}

TEST_F(SuiteTest, OtherSystemsAndPublishedFiguresAreRows) {
  const Suite suite = Read(kSuite);
  const TemporaryFolder out;
  const std::vector<MethodResults> results = ReadResults(suite, out.path());
  ASSERT_EQ(results.size(), 3U);
  EXPECT_EQ(results[2].sequences[0].frames.size(), 2U);
  EXPECT_LT(results[2].sequences[0].frames[0].ate_rmse_m, 1e-6);
  const std::vector<ReportTable> tables = ErrorTables(suite, results);
  const std::string ate = ToMarkdown(tables[0]);
  EXPECT_THAT(ate, HasSubstr("| method | fr3/w/xyz |\n|---|---|\n"));
  EXPECT_THAT(ate, HasSubstr("| another system | 0.0000 / 0.0000 (0.0000 - 0.0000) |"));
  EXPECT_THAT(ate, HasSubstr("| DS-SLAM (published: a paper, table 1) | 0.0247 / 0.0161 |"));
  EXPECT_THAT(ate, HasSubstr("| exact | - |"));  // not run
  EXPECT_THAT(ToCsv(tables[0]), HasSubstr("\"200 ms, 15 Hz\",-\n"));
  EXPECT_THAT(ToCsv(KeyframeTable(suite, results)),
              HasSubstr("\nfr3/w/xyz,\"DS-SLAM, 15 Hz (published: a paper, table 1)\",-,-,-,286,-\n"));
  const fs::path picture = PictureFile(out.path(), suite.sequences[0], suite.configurations[0], 3);
  fs::create_directories(picture.parent_path());
  cv::imwrite(picture.string(), cv::Mat(20, 30, CV_8UC3, cv::Scalar::all(90)));
  WriteSuiteReport(suite, results, {"one run is <missing>"}, out.path());
  const std::string html = ReadFile(out.path() / "report.html");
  EXPECT_THAT(html, HasSubstr("one run is &lt;missing&gt;"));
  EXPECT_THAT(html, HasSubstr("<svg"));  // the path of the other system
  EXPECT_THAT(html, HasSubstr("width=device-width"));
  EXPECT_THAT(html, Not(HasSubstr("src=\"http")));
  EXPECT_THAT(html, HasSubstr("src=\"data:image/jpeg;base64,/9j/"));  // how JPEG begins
  EXPECT_TRUE(fs::exists(out.path() / "figures" / "trajectory_fr3_w_xyz_another_system.svg"));
  EXPECT_THAT(ReadFile(out.path() / "errors.csv"), HasSubstr("fr3/w/xyz,another system,frames,2,"));
}

TEST_F(SuiteTest, ColumnsOfACsv) {
  const fs::path csv = folder_->Write("frames.csv", "frame,delay\n0,\n1,7\n");
  const std::vector<double> delays = ReadColumn(csv, "delay");
  ASSERT_EQ(delays.size(), 2U);
  EXPECT_TRUE(std::isnan(delays[0]));
  EXPECT_EQ(delays[1], 7);
  EXPECT_THAT(InputErrorOf([&] { (void)ReadColumn(csv, "speed"); }), HasSubstr("no column speed"));
}

TEST_F(SuiteTest, NamesOfFilesAreTame) {
  EXPECT_EQ(AsFileName("fr3/w/xyz"), "fr3_w_xyz");
  EXPECT_EQ(AsFileName("../.. <x>"), "x");
  EXPECT_EQ(AsFileName("..."), "unnamed");
}

}  // namespace
}  // namespace rds
