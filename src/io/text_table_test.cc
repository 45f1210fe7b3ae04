// SPDX-License-Identifier: Apache-2.0
#include "io/text_table.h"

#include <gmock/gmock.h>

#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(TextTable, SplitsAndLeavesOutComments) {
  const TemporaryFolder folder;
  const TextTable table = ReadTextTable(folder.Write("t.txt", "# comment\n1.5 a.png\r\n\n  2,b.png\t x\n#\n3 c"));
  ASSERT_EQ(table.rows.size(), 3U);
  EXPECT_THAT(table.rows[0].fields, ElementsAre("1.5", "a.png"));
  EXPECT_THAT(table.rows[1].fields, ElementsAre("2", "b.png", "x"));
  EXPECT_THAT(table.rows[2].fields, ElementsAre("3", "c"));
  EXPECT_EQ(table.rows[1].line, 4U);
  EXPECT_EQ(table.Where(table.rows[2]), (folder.path() / "t.txt:6").string());
}

TEST(TextTable, ReadsNumbers) {
  const TemporaryFolder folder;
  const TextTable table = ReadTextTable(folder.Write("t.txt", "1305031102.175304 -1e-3 +2\n"));
  EXPECT_EQ(table.Number(table.rows[0], 0, "a"), 1305031102.175304);
  EXPECT_EQ(table.Number(table.rows[0], 1, "a"), -1e-3);
  EXPECT_EQ(table.Number(table.rows[0], 2, "a"), 2);
}

TEST(TextTable, RefusesWhatIsNoFiniteNumber) {
  const TemporaryFolder folder;
  const TextTable table = ReadTextTable(folder.Write("t.txt", "1\nnan inf 1e999 1x x + 1,5\n"));
  for (std::size_t column = 0; column < 6; ++column) {
    const std::string error = InputErrorOf([&] { (void)table.Number(table.rows[1], column, "tx"); });
    EXPECT_THAT(error, HasSubstr("t.txt:2: tx is '" + table.rows[1].fields[column] + "', not a finite number"));
  }
}

}  // namespace
}  // namespace rds
