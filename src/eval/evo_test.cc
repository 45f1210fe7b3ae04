// SPDX-License-Identifier: Apache-2.0
// The same figures as the evo package, to 1e-6: stored ones always; fresh ones where evo is installed for the Python
// that RDS_EVO_PYTHON names, or for python3.
#include <gmock/gmock.h>

#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "eval/evaluation.h"
#include "io/text_table.h"
#include "io/trajectory_io.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr double kTolerance = 1e-6;

void ExpectSame(const Statistics& ours, const json& theirs, const std::string& where) {
  SCOPED_TRACE(where);
  EXPECT_EQ(ours.count, theirs.at("count").get<std::size_t>());
  EXPECT_NEAR(ours.rmse, theirs.at("rmse").get<double>(), kTolerance);
  EXPECT_NEAR(ours.mean, theirs.at("mean").get<double>(), kTolerance);
  EXPECT_NEAR(ours.median, theirs.at("median").get<double>(), kTolerance);
  EXPECT_NEAR(ours.std, theirs.at("std").get<double>(), kTolerance);
  EXPECT_NEAR(ours.min, theirs.at("min").get<double>(), kTolerance);
  EXPECT_NEAR(ours.max, theirs.at("max").get<double>(), kTolerance);
}

// Compares all figures of the pairs of trajectories in a folder; returns how many statistics that were.
int CompareAll(const fs::path& folder, const json& figures) {
  int compared = 0;
  for (const auto& [name, kinds] : figures.items()) {
    const Trajectory estimate = ReadTrajectory(folder / (name + "_estimate.txt"));
    const Trajectory truth = ReadTrajectory(folder / (name + "_truth.txt"));
    for (const auto& [kind, theirs] : kinds.items()) {
      for (const json& rpe : theirs.at("rpe")) {
        EvaluationOptions options;
        options.with_scale = kind == "similarity";
        options.delta = rpe.at("delta").get<double>();
        options.delta_unit = rpe.at("delta_unit") == "s" ? DeltaUnit::kSeconds : DeltaUnit::kFrames;
        const Evaluation ours = Evaluate(estimate, truth, options);
        ExpectSame(ours.ate_m, theirs.at("ate_m"), name + ", " + kind + ", ATE");
        ExpectSame(ours.rpe_translation_m, rpe.at("translation_m"), name + ", " + kind + ", RPE, translation");
        ExpectSame(ours.rpe_rotation_deg, rpe.at("rotation_deg"), name + ", " + kind + ", RPE, rotation");
        compared += 3;
      }
    }
  }
  return compared;
}

std::string Quoted(const std::string& text) { return "'" + text + "'"; }

// Runs tests/evo_reference.py; true if it succeeds.
bool RunScript(const std::string& arguments) {
  const char* python = std::getenv("RDS_EVO_PYTHON");
  const fs::path script = fs::path(__FILE__).parent_path().parent_path().parent_path() / "tests" / "evo_reference.py";
  const std::string command =
      Quoted(python != nullptr ? python : "python3") + " " + Quoted(script.string()) + " " + arguments;
  return std::system(command.c_str()) == 0;
}

TEST(Evo, StoredFiguresAgree) {
  const fs::path folder = fs::path(__FILE__).parent_path() / "testdata";
  EXPECT_EQ(CompareAll(folder, json::parse(ReadFile(folder / "golden.json"))), 3 * 2 * 3 * 3);
}

TEST(Evo, FreshFiguresAgree) {
  if (!RunScript("available 2>/dev/null")) {
    GTEST_SKIP() << "evo is not installed: pip install -r tests/requirements.txt into a virtual environment and name "
                    "its Python in RDS_EVO_PYTHON";
  }
  const TemporaryFolder folder;
  const std::string path = Quoted(folder.path().string());
  ASSERT_TRUE(RunScript("generate " + path + " 2"));
  ASSERT_TRUE(RunScript("figures " + path + " >" + Quoted((folder.path() / "figures.json").string())));
  EXPECT_EQ(CompareAll(folder.path(), json::parse(folder.Read("figures.json"))), 3 * 2 * 3 * 3);
}

}  // namespace
}  // namespace rds
