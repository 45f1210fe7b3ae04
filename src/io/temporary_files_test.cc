// SPDX-License-Identifier: Apache-2.0
#include "io/temporary_files.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <memory>
#include <string>
#include <vector>

#include "testing/temporary_folder.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

TEST(TemporaryPath, RemovesItsFileInTheEnd) {
  const TemporaryFolder folder;
  {
    const TemporaryPath path(folder.path() / "a.mp4");
    EXPECT_EQ(folder.Count(), 1);
    EXPECT_EQ(path.path().extension(), ".mp4");
    EXPECT_EQ(path.path().parent_path(), folder.path());
  }
  EXPECT_EQ(folder.Count(), 0);
}

TEST(TemporaryPath, StaysWhereItIsMoved) {
  const TemporaryFolder folder;
  folder.Write("to", "before");
  {
    TemporaryPath moved(folder.path() / "to");
    ASSERT_EQ(write(moved.file(), "text", 4), 4);
    EXPECT_EQ(folder.Read("to"), "before");
    EXPECT_EQ(moved.MoveTo(folder.path() / "to"), 0);
    TemporaryPath refused(folder.path() / "c");
    EXPECT_EQ(refused.MoveTo("/nowhere/to"), ENOENT);
  }
  RemoveTemporaryFiles();
  EXPECT_EQ(folder.Read("to"), "text");
  EXPECT_EQ(folder.Count(), 1);
}

TEST(TemporaryPath, TwoOfOneTargetDiffer) {
  const TemporaryFolder folder;
  const TemporaryPath one(folder.path() / "a");
  const TemporaryPath other(folder.path() / "a");
  EXPECT_NE(one.path(), other.path());
}

TEST(TemporaryPath, NamesTheTargetWhereItCannotBeMade) {
  EXPECT_THAT(InputErrorOf([] { const TemporaryPath path("/nowhere/a"); }),
              ::testing::HasSubstr("/nowhere/a: cannot be written: No such file"));
}

TEST(TemporaryPath, AllAreRemovedAtOnce) {
  const TemporaryFolder folder;
  std::vector<TemporaryPath> paths;
  for (int i = 0; i < 40; ++i) {
    paths.emplace_back(folder.path() / std::to_string(i));  // moved when the vector grows
  }
  const fs::path first = paths.front().path();
  RemoveTemporaryFiles();
  EXPECT_EQ(folder.Count(), 0);
  folder.Write(first.filename().string(), "of somebody else");
  RemoveTemporaryFiles();
  EXPECT_EQ(folder.Count(), 1) << "each is removed once";
  paths.clear();
}

TEST(TemporaryPath, MoreThanTheTableHoldsAreRemovedByTheirDestructors) {
  const TemporaryFolder folder;
  {
    std::vector<std::unique_ptr<TemporaryPath>> paths;
    for (int i = 0; i < 200; ++i) {
      paths.push_back(std::make_unique<TemporaryPath>(folder.path() / std::to_string(i)));
    }
    EXPECT_EQ(folder.Count(), 200);
  }
  EXPECT_EQ(folder.Count(), 0);
}

TEST(RemoveAbandonedFiles, TakesThoseOfKilledProcessesOnly) {
  const TemporaryFolder folder;
  const pid_t child = fork();
  if (child == 0) {
    const TemporaryPath path(folder.path() / "of_the_dead");
    raise(SIGKILL);
  }
  ASSERT_GT(child, 0);
  waitpid(child, nullptr, 0);
  EXPECT_EQ(folder.Count(), 1);
  const TemporaryPath alive(folder.path() / "alive");
  folder.Write("mine.txt", "");
  folder.Write(".rds-hidden.tmp", "not of that form");
  const fs::path locked = folder.Write(".rds-" + std::to_string(child) + "-0123456789abcdef.tmp", "of another machine");
  const int file = open(locked.c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_EQ(flock(file, LOCK_EX), 0);
  RemoveAbandonedFiles(folder.path());
  EXPECT_EQ(folder.Count(), 4);
  close(file);
  RemoveAbandonedFiles(folder.path());
  EXPECT_EQ(folder.Count(), 3);
  RemoveAbandonedFiles("/nowhere");
}

}  // namespace
}  // namespace rds
