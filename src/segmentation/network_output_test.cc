// SPDX-License-Identifier: Apache-2.0
#include "segmentation/network_output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "segmentation/mask.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr int kSide = 8;  // pixels of image and network

Image8 MaskOf(const SegmentationModel& model, const std::vector<OutputTensor>& outputs, std::size_t index = 0) {
  return MaskOfOutput(model, ThresholdsOf(model, 0, -1), outputs, index, kSide, kSide, kSide, kSide);
}

int DynamicPixels(const Image8& mask) { return static_cast<int>(std::ranges::count(mask.data, kDynamicPixel)); }

TEST(NetworkOutput, BinaryMasks) {
  SegmentationModel model;
  model.output = SegmentationModel::Output::kMask;
  OutputTensor output{{2, kSide, kSide, 1}, std::vector<float>(2 * kSide * kSide, 0)};
  std::fill_n(output.values.begin() + kSide * kSide, kSide, 255);  // the second image's first row
  EXPECT_EQ(DynamicPixels(MaskOf(model, {output}, 0)), 0);
  EXPECT_EQ(DynamicPixels(MaskOf(model, {output}, 1)), kSide);
  for (float& value : output.values) {
    value = value > 0 ? 0.1F : 0;  // a probability between unsure and dynamic
  }
  const Image8 mask = MaskOf(model, {output}, 1);
  EXPECT_THAT(std::vector(mask.data.begin(), mask.data.begin() + kSide), Each(kUnsurePixel));
}

// Two people, a cat, and a person that the network doubts.
std::vector<OutputTensor> Instances(int side) {
  std::vector<float> masks(4 * static_cast<std::size_t>(side * side), 1);
  return {{{4, 4}, {0, 0, 2, 4, 6, 6, 8, 8, 4, 0, 6, 2, 0, 6, 2, 8}},
          {{4}, {.9F, .6F, .9F, .3F}},
          {{4}, {1, 1, 2, 1}},
          {{4, 1, side, side}, std::move(masks)}};
}

TEST(NetworkOutput, InstancesOfDynamicClassesAboveTheScore) {
  SegmentationModel model;
  model.output = SegmentationModel::Output::kInstances;
  model.labels = {1};
  const Image8 people = MaskOf(model, Instances(4));  // masks of their boxes
  EXPECT_EQ(DynamicPixels(people), 2 * 4 + 2 * 2);
  EXPECT_EQ(people.At(0, 0), kDynamicPixel);
  EXPECT_EQ(people.At(7, 7), kDynamicPixel);
  EXPECT_EQ(people.At(5, 1), kStaticPixel);  // the cat
  model.labels = {1, 2};
  EXPECT_EQ(DynamicPixels(MaskOf(model, Instances(4))), 2 * 4 + 2 * 2 + 2 * 2);
  model.score = .2;
  EXPECT_EQ(DynamicPixels(MaskOf(model, Instances(4))), 2 * 4 + 2 * 2 + 2 * 2 + 2 * 2);
  model.box_order = SegmentationModel::BoxOrder::kYxyx;
  EXPECT_EQ(MaskOf(model, Instances(4)).At(3, 0), kDynamicPixel);
  EXPECT_EQ(DynamicPixels(MaskOf(model, Instances(kSide))), kSide * kSide);  // masks of the whole image
}

TEST(NetworkOutput, NoInstanceIsNoMask) {
  SegmentationModel model;
  model.output = SegmentationModel::Output::kInstances;
  EXPECT_EQ(DynamicPixels(MaskOf(model, {{{0, 4}, {}}, {{0}, {}}, {{0}, {}}, {{0, 4, 4}, {}}})), 0);
}

TEST(NetworkOutput, RefusesWhatTheDescriptionDoesNotSay) {
  SegmentationModel model;
  model.weights = "net.onnx";
  const auto error = [&](const std::vector<OutputTensor>& outputs) {
    return InputErrorOf([&] { (void)MaskOf(model, outputs); });
  };
  EXPECT_THAT(error({{{1, 8, 8}, std::vector<float>(64)}}), HasSubstr("three dimensions of logits"));
  EXPECT_THAT(error({{{1, 3, 8, 8}, std::vector<float>(192)}}), HasSubstr("more classes than labels"));
  EXPECT_THAT(error({{{1, 3, 8, 8}, std::vector<float>(5)}}), HasSubstr("the numbers of its shape"));
  EXPECT_THAT(error({}), HasSubstr("the tensors that the description names"));
  model.output = SegmentationModel::Output::kInstances;
  std::vector<OutputTensor> instances = Instances(4);
  instances[1] = {{3}, {1, 1, 1}};
  EXPECT_THAT(error(instances), HasSubstr("four corners"));
  model.output = SegmentationModel::Output::kMask;
  EXPECT_THAT(error({{{1, 2, 8, 8}, std::vector<float>(128)}}), HasSubstr("two dimensions of a mask"));
  EXPECT_THAT(OutputNames(model), ElementsAre(""));
}

}  // namespace
}  // namespace rds
