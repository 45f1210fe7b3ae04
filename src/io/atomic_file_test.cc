// SPDX-License-Identifier: Apache-2.0
#include "io/atomic_file.h"

#include <gmock/gmock.h>

#include "testing/file_size_limit.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::HasSubstr;

TEST(WriteFileAtomically, WritesAndReplaces) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder.path() / "a.txt", "first");
  EXPECT_EQ(folder.Read("a.txt"), "first");
  WriteFileAtomically(folder.path() / "a.txt", std::string(100'000, 'x'));
  EXPECT_EQ(folder.Read("a.txt"), std::string(100'000, 'x'));
  EXPECT_EQ(folder.Count(), 1);
}

TEST(WriteFileAtomically, LeavesNothingBehindWhenTheDiskIsFull) {
  const TemporaryFolder folder;
  folder.Write("a.txt", "before");
  std::string error;
  {
    const FileSizeLimit limit(1000);
    error = InputErrorOf([&] { WriteFileAtomically(folder.path() / "a.txt", std::string(100'000, 'x')); });
  }
  EXPECT_THAT(error, HasSubstr("a.txt: cannot be written: File too large"));
  EXPECT_EQ(folder.Read("a.txt"), "before");
  EXPECT_EQ(folder.Count(), 1);
}

TEST(WriteFileAtomically, NamesTheReason) {
  EXPECT_THAT(InputErrorOf([] { WriteFileAtomically("/dev/full", "text"); }),
              HasSubstr("/dev/full: cannot be written: No space left on device; make room or choose another place"));
  EXPECT_THAT(InputErrorOf([] { WriteFileAtomically("/no/such/folder/a.txt", "text"); }),
              HasSubstr("/no/such/folder/a.txt: cannot be written: No such file or directory"));
  const TemporaryFolder folder;
  EXPECT_THAT(InputErrorOf([&] { WriteFileAtomically(folder.path(), "text"); }), HasSubstr("Is a directory"));
}

TEST(WriteFileAtomically, KeepsDevicesAndLinks) {
  WriteFileAtomically("/dev/null", "text");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
  const TemporaryFolder folder;
  folder.Write("target/a.txt", "before");
  std::filesystem::create_symlink(folder.path() / "target/a.txt", folder.path() / "link.txt");
  WriteFileAtomically(folder.path() / "link.txt", "after");
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path() / "link.txt"));
  EXPECT_EQ(folder.Read("target/a.txt"), "after");
}

TEST(WriteFilesAtomically, WritesAllOrNone) {
  const TemporaryFolder folder;
  const OutputFile good[] = {{folder.path() / "a.txt", "a"}, {folder.path() / "b.txt", "b"}};
  WriteFilesAtomically(good);
  EXPECT_EQ(folder.Read("a.txt") + folder.Read("b.txt"), "ab");
  const OutputFile bad[] = {{folder.path() / "a.txt", "A"}, {folder.path() / "none/b.txt", "B"}};
  EXPECT_THAT(InputErrorOf([&] { WriteFilesAtomically(bad); }), HasSubstr("none/b.txt: cannot be written"));
  EXPECT_EQ(folder.Read("a.txt"), "a");
  EXPECT_EQ(folder.Count(), 2);
}

TEST(CheckWritable, LeavesNoTraceAndNamesTheReason) {
  const TemporaryFolder folder;
  folder.Write("a.txt", "before");
  CheckWritable(folder.path() / "a.txt");
  CheckWritable(folder.path() / "b.txt");
  CheckWritable("/dev/null");
  EXPECT_EQ(folder.Read("a.txt"), "before");
  EXPECT_EQ(folder.Count(), 1);
  EXPECT_THAT(InputErrorOf([&] { CheckWritable(folder.path()); }), HasSubstr("Is a directory"));
  EXPECT_THAT(InputErrorOf([] { CheckWritable("/no/such/a.txt"); }), HasSubstr("/no/such/a.txt: cannot be written"));
}

TEST(PrepareOutputFolder, MakesIt) {
  const TemporaryFolder folder;
  PrepareOutputFolder(folder.path() / "a/b");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path() / "a/b"));
  PrepareOutputFolder(folder.path() / "a/b");
}

TEST(PrepareOutputFolder, SaysWhyItCannot) {
  const TemporaryFolder folder;
  const auto file = folder.Write("file", "");
  EXPECT_THAT(InputErrorOf([&] { PrepareOutputFolder(file); }), HasSubstr("file: output folder cannot be made"));
  EXPECT_THAT(InputErrorOf([&] { PrepareOutputFolder(file / "below"); }), HasSubstr("Not a directory"));
  EXPECT_THAT(InputErrorOf([] { PrepareOutputFolder("/proc"); }), HasSubstr("/proc: output folder cannot be written"));
  const FileSizeLimit limit(100);
  EXPECT_THAT(InputErrorOf([&] { PrepareOutputFolder(folder.path() / "full"); }), HasSubstr("File too large"));
}

}  // namespace
}  // namespace rds
