// SPDX-License-Identifier: Apache-2.0
#include "base/text.h"

#include <gtest/gtest.h>

namespace rds {
namespace {

TEST(Text, TrimmedHasNoBlanksAtItsEnds) {
  EXPECT_EQ(Trimmed(" \t a b\r\n"), "a b");
  EXPECT_EQ(Trimmed("a"), "a");
  EXPECT_EQ(Trimmed(" \n"), "");
  EXPECT_EQ(Trimmed(""), "");
}

TEST(Text, TheLastLineIsNotABlankOne) {
  EXPECT_EQ(LastLine("one\n two \n\n"), "two");
  EXPECT_EQ(LastLine("one"), "one");
  EXPECT_EQ(LastLine("\n"), "");
}

}  // namespace
}  // namespace rds
