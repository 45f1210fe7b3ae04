// SPDX-License-Identifier: Apache-2.0
#include "base/file.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::HasSubstr;

TEST(ReadFile, NamesFileAndReason) {
  const TemporaryFolder folder;
  EXPECT_THAT(InputErrorOf([&] { (void)ReadFile(folder.path() / "none"); }),
              HasSubstr("none: cannot be read: No such"));
  EXPECT_THAT(InputErrorOf([&] { (void)ReadFile(folder.path()); }), HasSubstr("cannot be read: Is a directory"));
  EXPECT_EQ(ReadFile(folder.Write("empty", "")), "");
  const std::string large(100'000, 'x');
  EXPECT_EQ(ReadFile(folder.Write("large", large)), large);
  EXPECT_THAT(ReadFile("/proc/self/stat"), HasSubstr("("));  // a file that does not know its size
}

TEST(ReadFile, RefusesWhatMayHaveNoEnd) {
  const TemporaryFolder folder;
  const auto pipe = folder.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THAT(InputErrorOf([&] { (void)ReadFile(pipe); }), HasSubstr("pipe: cannot be read: a pipe or a device"));
  EXPECT_THAT(InputErrorOf([] { (void)ReadFile("/dev/zero"); }), HasSubstr("a pipe or a device"));
  const auto file = folder.Write("file", "0123456789");
  EXPECT_EQ(ReadFile(file, 10), "0123456789");
  EXPECT_THAT(InputErrorOf([&] { (void)ReadFile(file, 9); }), HasSubstr("more than 9 bytes"));
}

}  // namespace
}  // namespace rds
