// SPDX-License-Identifier: Apache-2.0
#include "segmentation/weights.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "base/error.h"

namespace rds {
namespace {

// Sets an environment variable (null = unset) until the end of the scope.
class ScopedVariable {
 public:
  ScopedVariable(const char* name, const char* value) : name_(name) {
    const char* const old = std::getenv(name);
    had_ = old != nullptr;
    old_ = had_ ? old : "";
    Set(value);
  }
  ~ScopedVariable() { Set(had_ ? old_.c_str() : nullptr); }

 private:
  void Set(const char* value) {
    if (value != nullptr) {
      setenv(name_, value, 1);
    } else {
      unsetenv(name_);
    }
  }
  const char* name_;
  bool had_ = false;
  std::string old_;
};

TEST(WeightsTest, PublishedOnesAreFoundByNameAndFile) {
  ASSERT_NE(FindPublishedWeights("fast"), nullptr);
  EXPECT_STREQ(FindPublishedWeights("fast")->file, "deeplabv3_mnv2_dm05_pascal_quant.tflite");
  EXPECT_EQ(FindPublishedWeights("deeplabv3_mnv2_pascal_quant.tflite"), FindPublishedWeights("accurate"));
  EXPECT_EQ(FindPublishedWeights("slow"), nullptr);
  for (const PublishedWeights& weights : AllPublishedWeights()) {
    EXPECT_EQ(std::string(weights.sha256).size(), 64U);
  }
}

TEST(WeightsTest, UrlNamesTheWholeCommitUnlessAMirrorIsGiven) {
  const ScopedVariable unset("RDS_WEIGHTS_URL", nullptr);
  EXPECT_EQ(WeightsUrl().find_last_of('/') + 41, WeightsUrl().size());
  const ScopedVariable mirror("RDS_WEIGHTS_URL", "http://127.0.0.1:1/x");
  EXPECT_EQ(WeightsUrl(), "http://127.0.0.1:1/x");
}

TEST(WeightsTest, CacheFolderFollowsTheEnvironment) {
  const ScopedVariable home("HOME", "/h");
  const ScopedVariable xdg("XDG_CACHE_HOME", "/x");
  const ScopedVariable own("RDS_CACHE", "/c");
  EXPECT_EQ(CacheFolder(), "/c");
  const ScopedVariable no_own("RDS_CACHE", "");
  EXPECT_EQ(CacheFolder(), "/x/rds");
  const ScopedVariable no_xdg("XDG_CACHE_HOME", nullptr);
  EXPECT_EQ(CacheFolder(), "/h/.cache/rds");
  const ScopedVariable no_home("HOME", nullptr);
  EXPECT_THROW(std::ignore = CacheFolder(), InputError);
}

}  // namespace
}  // namespace rds
