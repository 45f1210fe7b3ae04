// SPDX-License-Identifier: Apache-2.0
#include "segmentation/segmentation_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "base/error.h"

namespace rds {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class SegmentationModelTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  std::string Write(const std::string& name, const std::string& text) const {
    const std::string path = (folder_ / name).string();
    std::ofstream(path) << text;
    return path;
  }
  static std::string Error(const std::string& weights) {
    try {
      std::ignore = LoadSegmentationModel(weights);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  const fs::path folder_ = fs::temp_directory_path() /
                           ("rds_model_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
};

TEST_F(SegmentationModelTest, MissingOrEmptyWeightsNameTheFileAndTheWayOut) {
  const std::string missing = (folder_ / "none.onnx").string();
  EXPECT_THAT(Error(missing), HasSubstr(missing));
  EXPECT_THAT(Error(missing), HasSubstr("rds fetch weights"));
  const std::string empty = Write("deeplabv3_mnv2_361x481.onnx", "");
  EXPECT_THAT(Error(empty), HasSubstr(empty));
  EXPECT_THAT(Error(empty), HasSubstr("rds fetch weights"));
  EXPECT_THAT(Error(folder_.string()), HasSubstr("no such file"));
}

TEST_F(SegmentationModelTest, KnowsThePublishedFilesByName) {
  const SegmentationModel fast = LoadSegmentationModel(Write("deeplabv3_mnv2_dm05_pascal_quant.tflite", "x"));
  EXPECT_EQ(fast.input_order, ChannelOrder::kLast);
  EXPECT_EQ(fast.output_tensor, "ResizeBilinear_1");
  EXPECT_EQ(fast.labels, std::vector<int>{15});
  EXPECT_LT(fast.threshold, LoadSegmentationModel(Write("deeplabv3_mnv2_pascal_quant.tflite", "x")).threshold);
}

TEST_F(SegmentationModelTest, DynamicClassesAreChosenByName) {
  const auto chosen = [](SegmentationModel model, const std::string& names) {
    ChooseDynamicClasses(model, names);
    return model.labels;
  };
  const auto error = [&](const SegmentationModel& model, const std::string& names) {
    try {
      (void)chosen(model, names);
    } catch (const InputError& problem) {
      return std::string(problem.what());
    }
    return std::string("no error");
  };
  const SegmentationModel published = LoadSegmentationModel(Write("deeplabv3_mnv2_361x481.onnx", "x"));
  EXPECT_EQ(chosen(published, "person"), std::vector<int>{15});
  EXPECT_EQ(chosen(published, "person, cat,dog"), (std::vector<int>{15, 8, 12}));
  EXPECT_EQ(chosen(published, "[person, cat]"), (std::vector<int>{15, 8}));
  EXPECT_THAT(error(published, "persn"), HasSubstr("'person'"));
  EXPECT_THAT(error(published, " , "), HasSubstr("names of classes are wanted"));
  Write("mine.onnx.yaml", "output:\n  labels: [3]\n");
  const SegmentationModel nameless = LoadSegmentationModel(Write("mine.onnx", "x"));
  EXPECT_EQ(chosen(nameless, "person"), std::vector<int>{3});
  EXPECT_THAT(error(nameless, "cat"), HasSubstr("output.names of"));
  Write("names.txt", "nothing\n person \r\ncat\n\n");
  Write("mine.onnx.yaml", "output:\n  kind: instances\n  names: names.txt\ninstances:\n  score: 0.7\n");
  const SegmentationModel named = LoadSegmentationModel((folder_ / "mine.onnx").string());
  EXPECT_EQ(named.output, SegmentationModel::Output::kInstances);
  EXPECT_EQ(named.score, 0.7);
  EXPECT_EQ(chosen(named, "cat"), std::vector<int>{2});
}

TEST_F(SegmentationModelTest, UnknownWeightsWantADescription) {
  const std::string weights = Write("mine.onnx", "x");
  EXPECT_THAT(Error(weights), HasSubstr(weights + ".yaml"));
}

TEST_F(SegmentationModelTest, AnEmptyDescriptionLeavesAllDefaults) {
  const std::string weights = Write("mine.onnx", "x");
  for (const char* text : {"", "# all as usual\n", "{}\n", "input:\noutput:\n"}) {
    Write("mine.onnx.yaml", text);
    const SegmentationModel model = LoadSegmentationModel(weights);
    EXPECT_EQ(model.labels, SegmentationModel{}.labels) << text;
    EXPECT_EQ(model.input_order, SegmentationModel{}.input_order) << text;
  }
}

TEST_F(SegmentationModelTest, YamlIsReadAndWrittenBack) {
  SegmentationModel model;
  model.weights = Write("mine.onnx", "x");
  model.input_order = ChannelOrder::kLast;
  model.input_height = 240;
  model.input_width = 320;
  model.input_is_rgb = false;
  model.mean = {1, 2.5F, 3};
  model.scale = {4, 5, 6};
  model.output_tensor = "here";
  model.output = SegmentationModel::Output::kLabels;
  model.output_order = ChannelOrder::kLast;
  model.stride = {8, 16};
  model.offset = {4, 2};
  model.labels = {15, 12};
  model.threshold = 0.4;
  model.unsure = 0.1;
  model.ignore_rounding = true;
  Write("mine.onnx.yaml", ToYaml(model));
  const SegmentationModel read = LoadSegmentationModel(model.weights);
  EXPECT_EQ(ToYaml(read), ToYaml(model));
  EXPECT_EQ(read.labels, model.labels);
  EXPECT_EQ(read.stride, model.stride);
  EXPECT_EQ(read.mean, model.mean);
  EXPECT_FALSE(read.input_is_rgb);
}

TEST_F(SegmentationModelTest, YamlBesideKnownWeightsReplacesTheBuiltIn) {
  const std::string weights = Write("deeplabv3_mnv2_361x481.onnx", "x");
  Write("deeplabv3_mnv2_361x481.onnx.yaml", "output: {labels: [15, 8]}\n");
  const SegmentationModel model = LoadSegmentationModel(weights);
  EXPECT_EQ(model.labels, (std::vector<int>{15, 8}));
  EXPECT_EQ(model.stride[0], 0);
}

TEST_F(SegmentationModelTest, BadDescriptionsNameFileAndKey) {
  const std::string weights = Write("mine.onnx", "x");
  const std::pair<const char*, const char*> cases[] = {
      {"inptu: {}", "inptu"},
      {"output: {label: [1]}", "output.label"},
      {"output: {labels: []}", "output.labels"},
      {"output: {labels: [-1]}", "output.labels"},
      {"output: {threshold: 1.5}", "output.threshold"},
      {"output: {threshold: high}", "output.threshold"},
      {"output: {unsure: -0.1}", "output.unsure"},
      {"output: {threshold: 0.2, unsure: 0.3}", "output.unsure"},
      {"output: {kind: boxes}", "output.kind"},
      {"output: {stride: [-16, 16]}", "output.stride"},
      {"output: {offset: [.nan, 0]}", "output.offset"},
      {"input: {size: [361]}", "input.size"},
      {"input: {size: [0, 481]}", "input.size"},
      {"input: {scale: [1, 0, 1]}", "input.scale"},
      {"input: {layout: CHWN}", "input.layout"},
      {"input: [1]", "input"},
      {"? {a: b}\n: 3", "the name before ':' must be a word"},
      {"ignore_rounding: perhaps", "ignore_rounding"},
      {"input: {", "YAML"},
  };
  for (const auto& [text, key] : cases) {
    Write("mine.onnx.yaml", text);
    EXPECT_THAT(Error(weights), HasSubstr("mine.onnx.yaml")) << text;
    EXPECT_THAT(Error(weights), HasSubstr(key)) << text;
  }
}

TEST(SegmentationModelGridTest, DefaultStridePutsCornersOnCorners) {
  const ScoreGrid grid = SegmentationModel{}.Grid(481, 641, 61, 81);
  EXPECT_DOUBLE_EQ(grid.stride_x, 8);
  EXPECT_DOUBLE_EQ(grid.stride_y, 8);
  SegmentationModel given;
  given.stride = {16, 16};
  given.offset = {8, 0};
  EXPECT_DOUBLE_EQ(given.Grid(361, 481, 23, 31).stride_y, 16);
  EXPECT_DOUBLE_EQ(given.Grid(361, 481, 23, 31).offset_y, 8);
}

}  // namespace
}  // namespace rds
