#include "io/temporary_files.h"

#include <gmock/gmock.h>

#include <cerrno>
#include <memory>
#include <string>
#include <vector>

#include "testing/temporary_folder.h"

namespace rds {
namespace {

TEST(TemporaryPath, RemovesItsFileInTheEnd) {
  const TemporaryFolder folder;
  {
    const TemporaryPath path(folder.Write("a", "text"));
    const TemporaryPath never_made(folder.path() / "b");
    EXPECT_EQ(folder.Count(), 1);
  }
  EXPECT_EQ(folder.Count(), 0);
}

TEST(TemporaryPath, StaysWhereItIsMovedAndWhenItIsDisowned) {
  const TemporaryFolder folder;
  folder.Write("to", "before");
  {
    TemporaryPath moved(folder.Write("a", "text"));
    EXPECT_EQ(moved.MoveTo(folder.path() / "to"), 0);
    TemporaryPath disowned(folder.Write("b", ""));
    disowned.Disown();
    TemporaryPath refused(folder.Write("c", ""));
    EXPECT_EQ(refused.MoveTo("/nowhere/to"), ENOENT);
  }
  RemoveTemporaryFiles();
  EXPECT_EQ(folder.Read("to"), "text");
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "b"));
  EXPECT_EQ(folder.Count(), 2);
}

TEST(TemporaryPath, AllAreRemovedAtOnce) {
  const TemporaryFolder folder;
  std::vector<TemporaryPath> paths;
  for (int i = 0; i < 40; ++i) {
    paths.emplace_back(folder.Write(std::to_string(i), ""));  // moved when the vector grows
  }
  RemoveTemporaryFiles();
  EXPECT_EQ(folder.Count(), 0);
  folder.Write("0", "of somebody else");
  RemoveTemporaryFiles();
  EXPECT_EQ(folder.Count(), 1) << "each is removed once";
  paths.clear();
}

TEST(TemporaryPath, MoreThanTheTableHoldsAreRemovedByTheirDestructors) {
  const TemporaryFolder folder;
  {
    std::vector<std::unique_ptr<TemporaryPath>> paths;
    for (int i = 0; i < 200; ++i) {
      paths.push_back(std::make_unique<TemporaryPath>(folder.Write(std::to_string(i), "")));
    }
    EXPECT_EQ(folder.Count(), 200);
  }
  EXPECT_EQ(folder.Count(), 0);
}

}  // namespace
}  // namespace rds
