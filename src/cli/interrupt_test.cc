#include "cli/interrupt.h"

#include <gtest/gtest.h>

namespace rds {
namespace {

TEST(Interrupt, FirstSignalIsNotedAndGuardsStartClean) {
  {
    const InterruptGuard guard;
    EXPECT_FALSE(Interrupted());
    raise(SIGINT);
    EXPECT_EQ(InterruptSignal(), SIGINT);
  }
  EXPECT_FALSE(Interrupted()) << "forgotten with its guard";
  const InterruptGuard guard;
  EXPECT_FALSE(Interrupted());
  raise(SIGTERM);
  EXPECT_EQ(InterruptSignal(), SIGTERM);
}

TEST(InterruptDeathTest, SecondSignalEndsTheProgram) {
  const auto interrupt_twice = [] {
    const InterruptGuard guard;
    raise(SIGINT);
    raise(SIGINT);
  };
  EXPECT_EXIT(interrupt_twice(), ::testing::ExitedWithCode(128 + SIGINT), "");
}

TEST(InterruptDeathTest, HandlersAreRestored) {
  const auto interrupt_after = [] {
    { const InterruptGuard guard; }
    raise(SIGINT);
  };
  EXPECT_EXIT(interrupt_after(), ::testing::KilledBySignal(SIGINT), "");
}

}  // namespace
}  // namespace rds
