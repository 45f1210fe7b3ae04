// SPDX-License-Identifier: Apache-2.0
#include "base/suggest.h"

#include <gtest/gtest.h>

namespace rds {
namespace {

const std::vector<std::string> kCommands = {"run", "eval", "bench", "synth", "config", "ablate", "fetch"};

TEST(EditDistance, CountsEdits) {
  EXPECT_EQ(EditDistance("", ""), 0);
  EXPECT_EQ(EditDistance("run", "run"), 0);
  EXPECT_EQ(EditDistance("", "run"), 3);
  EXPECT_EQ(EditDistance("run", ""), 3);
  EXPECT_EQ(EditDistance("kitten", "sitting"), 3);
  EXPECT_EQ(EditDistance("bnech", "bench"), 1);  // swapped neighbors are one edit
  EXPECT_EQ(EditDistance("eval", "evla"), 1);
}

TEST(NearestWord, FindsWhatWasMeant) {
  EXPECT_EQ(NearestWord("rnu", kCommands), "run");
  EXPECT_EQ(NearestWord("evaluate", kCommands), "eval");
  EXPECT_EQ(NearestWord("BENCH", kCommands), "bench");
  EXPECT_EQ(NearestWord("snyth", kCommands), "synth");
  EXPECT_EQ(NearestWord("conf", kCommands), "config");
}

TEST(NearestWord, IsSilentWhereNothingIsNear) {
  EXPECT_FALSE(NearestWord("xylophone", kCommands));
  EXPECT_FALSE(NearestWord("", kCommands));
  EXPECT_FALSE(NearestWord("run", {}));
}

TEST(Suggestion, ReadsAsTheEndOfASentence) {
  EXPECT_EQ(Suggestion("evla", kCommands), " (did you mean 'eval'?)");
  EXPECT_EQ(Suggestion("xylophone", kCommands), "");
}

}  // namespace
}  // namespace rds
