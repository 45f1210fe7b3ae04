#include "cli/interrupt.h"

#include <gtest/gtest.h>

#include "io/temporary_files.h"
#include "testing/temporary_folder.h"

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

TEST(InterruptDeathTest, SecondSignalLeavesNoFileUnderWay) {
  const TemporaryFolder folder;
  const auto file = folder.Write(".video.mp4", "half");
  const auto interrupt_twice = [&file] {
    const InterruptGuard guard;
    const TemporaryPath temporary(file);
    raise(SIGTERM);
    raise(SIGINT);
  };
  EXPECT_EXIT(interrupt_twice(), ::testing::ExitedWithCode(128 + SIGINT), "");
  EXPECT_EQ(folder.Count(), 0);
}

TEST(Interrupt, AReaderThatLeavesDoesNotEndTheProgram) {
  const InterruptGuard guard;
  raise(SIGPIPE);
  EXPECT_FALSE(Interrupted());
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
