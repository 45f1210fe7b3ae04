// SPDX-License-Identifier: Apache-2.0
#include "cli/program.h"

#include <gmock/gmock.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <new>
#include <sstream>
#include <system_error>

#include "base/error.h"

namespace rds {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// A program with two commands: `run SEQUENCE --out DIR [--rate R]`, which does as the test says, and `eval`.
class ProgramTest : public ::testing::Test {
 protected:
  ProgramTest() : app_("A program.", "rds") {
    app_.set_version_flag("--version", "rds 1.2.3");
    app_.require_subcommand(0, 1);
    CLI::App* run = app_.add_subcommand("run", "Runs");
    run->add_option("sequence", sequence_)->required();
    run->add_option("--out", out_)->required();
    run->add_option("--rate", rate_);
    run->callback([this] {
      ++runs_;
      action_();
    });
    app_.add_subcommand("eval", "Evaluates");
  }

  int Run(std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "rds");
    return RunProgram(app_, static_cast<int>(arguments.size()), arguments.data(), stdout_, stderr_);
  }

  CLI::App app_;
  std::string sequence_;
  std::string out_;
  double rate_ = 1;
  int runs_ = 0;
  std::function<void()> action_ = [] {};
  std::ostringstream stdout_;
  std::ostringstream stderr_;
};

TEST_F(ProgramTest, Runs) {
  EXPECT_EQ(Run({"run", "kitchen", "--out", "d", "--rate", "0"}), 0);
  EXPECT_EQ(runs_, 1);
  EXPECT_EQ(sequence_ + out_, "kitchend");
  EXPECT_EQ(rate_, 0);
  EXPECT_EQ(stderr_.str(), "");
}

TEST_F(ProgramTest, HelpsWithoutArguments) {
  EXPECT_EQ(Run({}), 0);
  EXPECT_THAT(stdout_.str(), AllOf(HasSubstr("A program."), HasSubstr("Runs"), HasSubstr("Evaluates")));
}

TEST_F(ProgramTest, HelpsWithACommand) {
  EXPECT_EQ(Run({"run", "--help"}), 0);
  EXPECT_THAT(stdout_.str(), HasSubstr("--rate"));
  EXPECT_EQ(runs_, 0);
}

TEST_F(ProgramTest, PrintsItsVersion) {
  EXPECT_EQ(Run({"--version"}), 0);
  EXPECT_THAT(stdout_.str(), HasSubstr("rds 1.2.3"));
}

TEST_F(ProgramTest, SuggestsCommands) {
  EXPECT_EQ(Run({"rnu", "kitchen", "--out", "d"}), 1);
  EXPECT_EQ(stderr_.str(), "rds: error: unknown command 'rnu' (did you mean 'run'?); see `rds --help`\n");
}

TEST_F(ProgramTest, SuggestsOptions) {
  EXPECT_EQ(Run({"run", "kitchen", "--ot", "d"}), 1);
  EXPECT_EQ(stderr_.str(), "rds: error: unknown option '--ot' (did you mean '--out'?); see `rds run --help`\n");
}

TEST_F(ProgramTest, SuggestsOptionsWithValues) {
  EXPECT_EQ(Run({"run", "kitchen", "--out", "d", "--rat=2"}), 1);
  EXPECT_EQ(stderr_.str(), "rds: error: unknown option '--rat' (did you mean '--rate'?); see `rds run --help`\n");
}

TEST_F(ProgramTest, SuggestsItsOwnOptions) {
  EXPECT_EQ(Run({"--verison"}), 1);
  EXPECT_THAT(stderr_.str(), HasSubstr("unknown option '--verison' (did you mean '--version'?); see `rds --help`"));
}

TEST_F(ProgramTest, SuggestsItsOwnOptionsBeforeACommand) {
  EXPECT_EQ(Run({"--versino", "run", "kitchen", "--out", "d"}), 1);
  EXPECT_THAT(stderr_.str(), HasSubstr("unknown option '--versino' (did you mean '--version'?)"));
  EXPECT_EQ(runs_, 0);
}

TEST_F(ProgramTest, NamesWhatIsMissingAndWhatIsTooMuch) {
  EXPECT_EQ(Run({"run", "kitchen"}), 1);
  EXPECT_THAT(stderr_.str(), AllOf(HasSubstr("rds: error: --out is required"), HasSubstr("see `rds run --help`")));
  stderr_.str("");
  EXPECT_EQ(Run({"run", "kitchen", "salon", "--out", "d"}), 1);
  EXPECT_THAT(stderr_.str(), HasSubstr("unexpected argument 'salon'"));
  stderr_.str("");
  EXPECT_EQ(Run({"run", "kitchen", "--out", "d", "--rate", "fast"}), 1);
  EXPECT_THAT(stderr_.str(), AllOf(HasSubstr("--rate"), HasSubstr("fast")));
  EXPECT_EQ(runs_, 0);
}

TEST_F(ProgramTest, NamesAnOptionGivenTwice) {
  EXPECT_EQ(Run({"run", "kitchen", "--out", "d", "--rate", "1", "--rate=2"}), 1);
  EXPECT_EQ(stderr_.str(), "rds: error: --rate is given more than once; see `rds run --help`\n");
  EXPECT_EQ(runs_, 0);
}

TEST_F(ProgramTest, ReportsBadInput) {
  action_ = [] { throw InputError("a.txt:3: bad"); };
  EXPECT_EQ(Run({"run", "kitchen", "--out", "d"}), 1);
  EXPECT_EQ(stderr_.str(), "rds: error: a.txt:3: bad\n");
}

TEST_F(ProgramTest, ReportsBugs) {
  action_ = [] { Check(false, "never"); };
  EXPECT_EQ(Run({"run", "kitchen", "--out", "d"}), 2);
  EXPECT_THAT(stderr_.str(), AllOf(HasSubstr("rds: bug: "), HasSubstr("program_test.cc"), HasSubstr("never")));
}

TEST_F(ProgramTest, WantOfMemoryOrThreadsIsNoBug) {
  action_ = [] { throw std::bad_alloc(); };
  EXPECT_EQ(Run({"run", "kitchen", "--out", "d"}), 1);
  EXPECT_THAT(stderr_.str(), HasSubstr("rds: error: out of memory"));
  stderr_.str("");
  action_ = [] { throw std::system_error(EAGAIN, std::generic_category()); };
  EXPECT_EQ(Run({"run", "kitchen", "--out", "d"}), 1);
  EXPECT_THAT(stderr_.str(), HasSubstr("rds: error: no thread can be started"));
}

TEST_F(ProgramTest, LeavesWithTheCodeAskedFor) {
  action_ = [] { throw CLI::RuntimeError(130); };
  EXPECT_EQ(Run({"run", "kitchen", "--out", "d"}), 130);
  EXPECT_EQ(stderr_.str(), "");
}

TEST_F(ProgramTest, NoticesThatNothingCanBePrinted) {
  stdout_.setstate(std::ios::badbit);
  EXPECT_EQ(Run({}), 1);
  EXPECT_THAT(stderr_.str(), HasSubstr("standard output cannot be written"));
}

}  // namespace
}  // namespace rds
