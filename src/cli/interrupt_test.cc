// SPDX-License-Identifier: Apache-2.0
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
  const auto interrupt_twice = [&folder] {
    const InterruptGuard guard;
    const TemporaryPath temporary(folder.path() / "video.mp4");
    raise(SIGTERM);
    raise(SIGINT);
  };
  EXPECT_EXIT(interrupt_twice(), ::testing::ExitedWithCode(128 + SIGINT), "");
  EXPECT_EQ(folder.Count(), 0);
}

TEST(Interrupt, NotesEverySignalThatAsksForTheEnd) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU, SIGXFSZ}) {
    const InterruptGuard guard;
    raise(signal);
    EXPECT_EQ(InterruptSignal(), signal);
    raise(SIGXFSZ);  // a limit tells again and again, and ends nothing
    EXPECT_EQ(InterruptSignal(), signal);
  }
}

TEST(Interrupt, WhatIsIgnoredStaysSo) {
  const auto before = std::signal(SIGHUP, SIG_IGN);  // as nohup does
  {
    const InterruptGuard guard;
    raise(SIGHUP);
    EXPECT_FALSE(Interrupted());
  }
  EXPECT_EQ(std::signal(SIGHUP, before), SIG_IGN);
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
