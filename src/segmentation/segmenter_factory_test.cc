// SPDX-License-Identifier: Apache-2.0
#include "segmentation/segmenter_factory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <tuple>

#include "base/error.h"

namespace rds {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class SegmenterFactoryTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    setenv("RDS_CACHE", folder_.c_str(), 1);
    unsetenv("RDS_WEIGHTS");
  }
  void TearDown() override {
    fs::remove_all(folder_);
    unsetenv("RDS_CACHE");
    unsetenv("RDS_WEIGHTS");
  }

  std::string Make(const std::string& name) const {
    std::ofstream(folder_ / name) << "x";
    return (folder_ / name).string();
  }
  static std::string ErrorOf(const std::function<void()>& call) {
    try {
      call();
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  const fs::path folder_ =
      fs::temp_directory_path() /
      ("rds_factory_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
};

TEST_F(SegmenterFactoryTest, WithoutWeightsTheErrorNamesTheWaysOut) {
  for (const char* model : {"", "/nowhere/net.onnx"}) {
    const std::string error = ErrorOf([&] { std::ignore = ResolveWeights(model); });
    EXPECT_THAT(error, HasSubstr("rds fetch weights"));
    EXPECT_THAT(error, HasSubstr("--segmenter none"));
  }
  EXPECT_THAT(ErrorOf([] { std::ignore = ResolveWeights("fast"); }), HasSubstr("rds fetch weights fast"));
}

TEST_F(SegmenterFactoryTest, WeightsAreLookedForInOrder) {
  const std::string fast = Make("deeplabv3_mnv2_dm05_pascal_quant.tflite");
  EXPECT_EQ(ResolveWeights(""), fast);
  const std::string accurate = Make("deeplabv3_mnv2_pascal_quant.tflite");
  EXPECT_EQ(ResolveWeights(""), accurate);
  EXPECT_EQ(ResolveWeights("fast"), fast);
  const std::string own = Make("own.onnx");
  setenv("RDS_WEIGHTS", own.c_str(), 1);
  EXPECT_EQ(ResolveWeights(""), own);
  EXPECT_EQ(ResolveWeights("accurate"), accurate);
  setenv("RDS_WEIGHTS", "fast", 1);
  EXPECT_EQ(ResolveWeights(""), fast);
}

TEST_F(SegmenterFactoryTest, MakesBackEndsByName) {
  EXPECT_EQ(MakeSegmenter("none", {}, {}, {}), nullptr);
  const std::string mask = Make("mask.png");
  SegmenterOptions options;
  options.stored_delay_ms = 30;
  const auto stored = MakeSegmenter("stored", options, {{1, mask}}, {});
  ASSERT_NE(stored, nullptr);
  EXPECT_EQ(stored->Name(), "stored, 30 ms");
  EXPECT_THAT(ErrorOf([] { std::ignore = MakeSegmenter("stored", {}, {}, {}); }), HasSubstr("mask.txt"));
  EXPECT_THAT(ErrorOf([] { std::ignore = MakeSegmenter("opnvino", {}, {}, {}); }), HasSubstr("'openvino'"));
}

TEST_F(SegmenterFactoryTest, MissingRuntimeOrWeightsIsNeverSilent) {
  const std::string error = ErrorOf([] { std::ignore = MakeSegmenter("openvino", {}, {}, {}); });
  EXPECT_THAT(error, HasSubstr(HasOpenVino() ? "rds fetch weights" : "scripts/install_openvino.sh"));
  EXPECT_THAT(error, HasSubstr("--segmenter none"));
}

}  // namespace
}  // namespace rds
