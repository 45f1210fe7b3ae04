// SPDX-License-Identifier: Apache-2.0
// A network that gives instances, as Mask R-CNN does, run by OpenVINO.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <string>

#include "segmentation/mask.h"
#include "segmentation/openvino_segmenter.h"
#include "segmentation/segmenter_factory.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::HasSubstr;

// Three instances, whose masks are the channels of the input of 8 x 8: a sure one of class 1, one of class 2, a
// doubtful one of class 1. In OpenVINO's own format.
constexpr const char* kInstanceNetwork = R"(<?xml version="1.0"?>
<net name="instances" version="11"><layers>
<layer id="0" name="image" type="Parameter" version="opset1"><data shape="1,3,8,8" element_type="f32"/>
<output><port id="0" precision="FP32" names="image"><dim>1</dim><dim>3</dim><dim>8</dim><dim>8</dim></port></output></layer>
<layer id="1" name="relu" type="ReLU" version="opset1">
<input><port id="0" precision="FP32"><dim>1</dim><dim>3</dim><dim>8</dim><dim>8</dim></port></input>
<output><port id="1" precision="FP32" names="masks"><dim>1</dim><dim>3</dim><dim>8</dim><dim>8</dim></port></output></layer>
<layer id="2" name="boxes" type="Const" version="opset1"><data element_type="f32" shape="3,4" offset="0" size="48"/>
<output><port id="0" precision="FP32" names="boxes"><dim>3</dim><dim>4</dim></port></output></layer>
<layer id="3" name="scores" type="Const" version="opset1"><data element_type="f32" shape="3" offset="48" size="12"/>
<output><port id="0" precision="FP32" names="scores"><dim>3</dim></port></output></layer>
<layer id="4" name="classes" type="Const" version="opset1"><data element_type="i64" shape="3" offset="64" size="24"/>
<output><port id="0" precision="I64" names="labels"><dim>3</dim></port></output></layer>
<layer id="5" name="r0" type="Result" version="opset1"><input><port id="0" precision="FP32"><dim>3</dim><dim>4</dim></port></input></layer>
<layer id="6" name="r1" type="Result" version="opset1"><input><port id="0" precision="FP32"><dim>3</dim></port></input></layer>
<layer id="7" name="r2" type="Result" version="opset1"><input><port id="0" precision="I64"><dim>3</dim></port></input></layer>
<layer id="8" name="r3" type="Result" version="opset1">
<input><port id="0" precision="FP32"><dim>1</dim><dim>3</dim><dim>8</dim><dim>8</dim></port></input></layer>
</layers><edges>
<edge from-layer="0" from-port="0" to-layer="1" to-port="0"/>
<edge from-layer="2" from-port="0" to-layer="5" to-port="0"/>
<edge from-layer="3" from-port="0" to-layer="6" to-port="0"/>
<edge from-layer="4" from-port="0" to-layer="7" to-port="0"/>
<edge from-layer="1" from-port="1" to-layer="8" to-port="0"/>
</edges></net>)";

// The constants: boxes, which masks of the whole image do not need, scores and classes.
std::string Constants() {
  std::array<char, 88> bytes{};
  const std::array<float, 3> scores = {.9F, .9F, .2F};
  const std::array<std::int64_t, 3> classes = {1, 2, 1};
  std::memcpy(&bytes[48], scores.data(), sizeof(scores));
  std::memcpy(&bytes[64], classes.data(), sizeof(classes));
  return {bytes.begin(), bytes.end()};
}

class OpenVinoInstancesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!HasOpenVino()) {
      GTEST_SKIP() << "this build has no OpenVINO runtime (scripts/install_openvino.sh)";
    }
    folder_.Write("net.xml", kInstanceNetwork);
    folder_.Write("net.bin", Constants());
    folder_.Write("classes.txt", "background\nperson\ncat\n");
    folder_.Write("net.xml.yaml",
                  "input:\n  scale: [255, 255, 255]\noutput:\n  kind: instances\n  names: classes.txt\n");
  }

  // Of an image whose left third is red, middle third green and right third blue.
  [[nodiscard]] Image8 Mask(const std::string& classes) const {
    SegmenterOptions options;
    options.model = folder_.path() / "net.xml";
    options.dynamic_classes = classes;
    const auto image = std::make_shared<Image8>(48, 48, 3);
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 48; ++x) {
        image->At(x, y, 2 - x / 16) = 255;
      }
    }
    const SegmentationInput input{FrameId{0}, 0, image};
    return MakeSegmenter("openvino", options, {}, {})->Segment({&input, 1}).at(0);
  }

  TemporaryFolder folder_;
};

TEST_F(OpenVinoInstancesTest, TheUnionOfDynamicOnesIsTheMask) {
  const Image8 people = Mask("person");
  EXPECT_EQ(people.At(5, 24), kDynamicPixel);  // red: the sure person
  EXPECT_EQ(people.At(24, 24), kStaticPixel);  // green: the cat
  EXPECT_EQ(people.At(43, 24), kStaticPixel);  // blue: the doubtful one
  const Image8 all = Mask("person, cat");
  EXPECT_EQ(all.At(5, 24), kDynamicPixel);
  EXPECT_EQ(all.At(24, 24), kDynamicPixel);
  EXPECT_THAT(InputErrorOf([&] { (void)Mask("dog"); }), HasSubstr("know no 'dog'"));
}

}  // namespace
}  // namespace rds
