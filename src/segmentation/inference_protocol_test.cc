// SPDX-License-Identifier: Apache-2.0
#include "segmentation/inference_protocol.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string Bytes(std::initializer_list<int> values) { return {values.begin(), values.end()}; }

std::string ErrorOf(const std::string& body, std::optional<std::size_t> length = std::nullopt) {
  return InputErrorOf([&] { (void)DecodeInference(body, length, "inputs"); });
}

TEST(InferenceProtocol, ReadsWhatItWrites) {
  const std::vector<InferenceTensor> tensors = {{"a", "UINT8", {2, 3}, "abcdef"},
                                                {"b", "BYTES", {2}, AsBytesElement("x") + AsBytesElement("")},
                                                {"c", "INT32", {1}, Bytes({1, 2, 0, 0})}};
  const InferenceBody body = EncodeInference({{"id", "7"}}, "inputs", tensors);
  const InferenceMessage message = DecodeInference(body.bytes, body.json_length, "inputs");
  EXPECT_EQ(message.json["id"], "7");
  ASSERT_EQ(message.tensors.size(), 3U);
  EXPECT_EQ(message.tensors[0].data, "abcdef");
  EXPECT_THAT(message.tensors[0].shape, ElementsAre(2, 3));
  EXPECT_THAT(StringsOf(message.tensors[1]), ElementsAre("x", ""));
  EXPECT_THAT(FloatsOf(message.tensors[2]), ElementsAre(513));
}

TEST(InferenceProtocol, ReadsDataInJson) {
  const InferenceMessage message =
      DecodeInference(R"({"inputs":[{"name":"a","datatype":"FP32","shape":[2,2],"data":[[1,2],[3,4.5]]},)"
                      R"({"name":"b","datatype":"BOOL","shape":[2],"data":[true,false]},)"
                      R"({"name":"c","datatype":"BYTES","shape":[1],"data":["word"]}]})",
                      std::nullopt, "inputs");
  EXPECT_THAT(FloatsOf(message.tensors[0]), ElementsAre(1, 2, 3, 4.5));
  EXPECT_THAT(FloatsOf(message.tensors[1]), ElementsAre(1, 0));
  EXPECT_THAT(StringsOf(message.tensors[2]), ElementsAre("word"));
}

TEST(InferenceProtocol, RefusesWhatDoesNotFit) {
  EXPECT_THAT(ErrorOf("no json"), HasSubstr("inference protocol"));
  EXPECT_THAT(ErrorOf("{}"), HasSubstr("inputs"));
  EXPECT_THAT(ErrorOf("{}", 9), HasSubstr("shorter than its header says"));
  const auto tensor = [](const std::string& rest) { return R"({"inputs":[{"name":"a",)" + rest + "}]}"; };
  EXPECT_THAT(ErrorOf(tensor(R"("datatype":"FP16","shape":[1],"data":[1])")), HasSubstr("FP16 are not read"));
  EXPECT_THAT(ErrorOf(tensor(R"("datatype":"FP32","shape":[3],"data":[1,2])")), HasSubstr("not those of its shape"));
  EXPECT_THAT(ErrorOf(tensor(R"("datatype":"FP32","shape":[-1],"data":[1])")), HasSubstr("cannot be"));
  EXPECT_THAT(ErrorOf(tensor(R"("datatype":"UINT8","shape":[1000000,1000000,1000000],"data":[])")),
              HasSubstr("cannot be"));
  EXPECT_THAT(ErrorOf(tensor(R"("datatype":"FP32","shape":[1],"data":["x"])")), HasSubstr("list of numbers"));
  const std::string cut = tensor(R"("datatype":"UINT8","shape":[4],"parameters":{"binary_data_size":4})");
  EXPECT_THAT(ErrorOf(cut + "abc", cut.size()), HasSubstr("cut short"));
  const std::string strings = tensor(R"("datatype":"BYTES","shape":[1],"parameters":{"binary_data_size":5})");
  EXPECT_THAT(ErrorOf(strings + Bytes({9, 0, 0, 0, 'x'}), strings.size()), HasSubstr("cut short"));
  EXPECT_THAT(InputErrorOf([] { (void)ParseLength("12x"); }), HasSubstr("no length"));
}

}  // namespace
}  // namespace rds
