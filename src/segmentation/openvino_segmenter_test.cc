// SPDX-License-Identifier: Apache-2.0
#include "segmentation/openvino_segmenter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <thread>
#include <utility>

#include "base/error.h"
#include "base/time.h"
#include "segmentation/segmentation_model.h"
#include "segmentation/segmenter_factory.h"

namespace rds {
namespace {
namespace fs = std::filesystem;
using testing::HasSubstr;

// A network that needs no weights: its scores of three classes are the three channels of its input of 8 x 8. In
// OpenVINO's own format; tensor "scores" is followed by a change of sign.
constexpr const char* kChannelNetwork = R"(<?xml version="1.0"?>
<net name="channels" version="11"><layers>
<layer id="0" name="image" type="Parameter" version="opset1"><data shape="1,3,8,8" element_type="f32"/>
<output><port id="0" precision="FP32" names="image"><dim>1</dim><dim>3</dim><dim>8</dim><dim>8</dim></port></output></layer>
<layer id="1" name="relu" type="ReLU" version="opset1">
<input><port id="0" precision="FP32"><dim>1</dim><dim>3</dim><dim>8</dim><dim>8</dim></port></input>
<output><port id="1" precision="FP32" names="scores"><dim>1</dim><dim>3</dim><dim>8</dim><dim>8</dim></port></output></layer>
<layer id="2" name="negative" type="Negative" version="opset1">
<input><port id="0" precision="FP32"><dim>1</dim><dim>3</dim><dim>8</dim><dim>8</dim></port></input>
<output><port id="1" precision="FP32" names="end"><dim>1</dim><dim>3</dim><dim>8</dim><dim>8</dim></port></output></layer>
<layer id="3" name="result" type="Result" version="opset1">
<input><port id="0" precision="FP32"><dim>1</dim><dim>3</dim><dim>8</dim><dim>8</dim></port></input></layer>
</layers><edges>
<edge from-layer="0" from-port="0" to-layer="1" to-port="0"/>
<edge from-layer="1" from-port="1" to-layer="2" to-port="0"/>
<edge from-layer="2" from-port="1" to-layer="3" to-port="0"/>
</edges></net>)";

// An ONNX file whose network hands its three channels through a ReLU, at any height, width and batch.
const std::string kOpenSizeOnnx(
    "\x08\x08\x12\x00\x3A\x63\x0A\x15\x0A\x05\x69\x6D\x61\x67\x65\x12\x06\x73\x63\x6F\x72\x65\x73\x22\x04\x52\x65\x6C"
    "\x75\x12\x01\x67\x5A\x22\x0A\x05\x69\x6D\x61\x67\x65\x12\x19\x0A\x17\x08\x01\x12\x13\x0A\x03\x12\x01\x6E\x0A\x02"
    "\x08\x03\x0A\x03\x12\x01\x68\x0A\x03\x12\x01\x77\x62\x23\x0A\x06\x73\x63\x6F\x72\x65\x73\x12\x19\x0A\x17\x08\x01"
    "\x12\x13\x0A\x03\x12\x01\x6E\x0A\x02\x08\x03\x0A\x03\x12\x01\x68\x0A\x03\x12\x01\x77\x42\x04\x0A\x00\x10\x0D",
    111);

class OpenVinoSegmenterTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!HasOpenVino()) {
      GTEST_SKIP() << "this build has no OpenVINO runtime (scripts/install_openvino.sh)";
    }
    fs::create_directories(folder_);
    Write("channels.xml", kChannelNetwork);
    Write("channels.bin", "");
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return (folder_ / name).string();
  }
  // The channel network with a description that says `yaml` on top of what every case needs.
  [[nodiscard]] std::unique_ptr<Segmenter> Channels(const std::string& yaml,
                                                    const OpenVinoOptions& options = {}) const {
    Write("channels.xml.yaml", yaml);
    return MakeOpenVinoSegmenter(LoadSegmentationModel((folder_ / "channels.xml").string()), options);
  }
  static std::vector<Image8> Segment(Segmenter& segmenter, std::initializer_list<Image8> images) {
    std::vector<SegmentationInput> inputs;
    for (const Image8& image : images) {
      inputs.push_back({FrameId{0}, 0, std::make_shared<Image8>(image)});
    }
    return segmenter.Segment(inputs);
  }
  // Left half one color, right half another; BGR.
  static Image8 Halves(std::array<int, 3> left, std::array<int, 3> right, int width = 64, int height = 48) {
    Image8 image(width, height, 3);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        for (std::size_t c = 0; c < 3; ++c) {
          image.Row(y)[static_cast<std::size_t>(x) * 3 + c] =
              static_cast<std::uint8_t>(x < width / 2 ? left[c] : right[c]);
        }
      }
    }
    return image;
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
      ("rds_openvino_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
};

constexpr std::array<int, 3> kBlue = {250, 0, 0};
constexpr std::array<int, 3> kRed = {0, 0, 250};

TEST(OpenVinoTest, ABuildWithoutTheRuntimeNamesTheWaysOut) {
  if (HasOpenVino()) {
    GTEST_SKIP() << "this build has the OpenVINO runtime";
  }
  try {
    std::ignore = MakeOpenVinoSegmenter({}, {});
    FAIL() << "no exception";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("scripts/install_openvino.sh"));
    EXPECT_THAT(error.what(), HasSubstr("--segmenter none"));
  }
}

TEST_F(OpenVinoSegmenterTest, ColorsReachTheNetworkInItsOrder) {
  const std::string ends = "output: {tensor: scores, labels: [0], threshold: 0.5}\n";
  const auto rgb = Channels(ends);
  const Image8 mask = Segment(*rgb, {Halves(kRed, kBlue)}).at(0);
  ASSERT_EQ(mask.width, 64);
  ASSERT_EQ(mask.height, 48);
  EXPECT_EQ(mask.At(20, 20), 255);
  EXPECT_EQ(mask.At(44, 20), 0);
  const auto bgr = Channels(ends + "input: {color: BGR}\n");
  const Image8 other = Segment(*bgr, {Halves(kRed, kBlue)}).at(0);
  EXPECT_EQ(other.At(20, 20), 0);
  EXPECT_EQ(other.At(44, 20), 255);
}

TEST_F(OpenVinoSegmenterTest, EndsWhereTheDescriptionSays) {
  // At its own end the sign is turned, so the least red side is class 0.
  const Image8 mask = Segment(*Channels("output: {labels: [0], threshold: 0.4}"), {Halves(kRed, kBlue)}).at(0);
  EXPECT_EQ(mask.At(20, 20), 0);
  EXPECT_EQ(mask.At(44, 20), 255);
  EXPECT_THAT(ErrorOf([&] { std::ignore = Channels("output: {tensor: nowhere}"); }), HasSubstr("nowhere"));
}

TEST_F(OpenVinoSegmenterTest, MeanAndScaleAreApplied) {
  // Red 100 against blue 99: a difference of one is a probability of 1 / (1 + e), with scale 0.1 of 1 / (1 + e^10).
  const Image8 image = Halves({99, 0, 100}, {99, 0, 100});
  const std::string output = "output: {tensor: scores, labels: [2], threshold: 0.2}\n";
  EXPECT_EQ(Segment(*Channels(output), {image}).at(0).At(30, 30), 255);
  EXPECT_EQ(Segment(*Channels(output + "input: {scale: [0.1, 0.1, 0.1]}"), {image}).at(0).At(30, 30), 0);
  EXPECT_EQ(Segment(*Channels(output + "input: {mean: [5, 0, 0]}"), {image}).at(0).At(30, 30), 255);
  EXPECT_EQ(Segment(*Channels(output + "input: {mean: [0, 0, 5]}"), {image}).at(0).At(30, 30), 0);
}

TEST_F(OpenVinoSegmenterTest, ThresholdOfTheOptionsComesFirst) {
  const Image8 image = Halves({99, 0, 100}, {99, 0, 100});
  const std::string yaml = "output: {tensor: scores, labels: [2], threshold: 0.2}";
  OpenVinoOptions options;
  options.threshold = 0.3;
  EXPECT_EQ(Segment(*Channels(yaml, options), {image}).at(0).At(30, 30), kUnsurePixel);
  options.unsure = 0.3;
  EXPECT_EQ(Segment(*Channels(yaml, options), {image}).at(0).At(30, 30), kStaticPixel);
}

TEST_F(OpenVinoSegmenterTest, BatchesGiveWhatSinglesGive) {
  const std::string yaml = "output: {tensor: scores, labels: [0], threshold: 0.5}";
  const Image8 a = Halves(kRed, kBlue);
  const Image8 b = Halves(kBlue, kRed);
  const Image8 other_size = Halves(kRed, kBlue, 32, 24);
  const auto single = Channels(yaml);
  const std::vector<Image8> expected = Segment(*single, {a, b, other_size});
  OpenVinoOptions options;
  options.max_batch = 2;
  const auto batched = Channels(yaml, options);
  const std::vector<Image8> masks = Segment(*batched, {a, b, other_size});
  ASSERT_EQ(masks.size(), 3U);
  for (std::size_t i = 0; i < masks.size(); ++i) {
    EXPECT_EQ(masks[i].data, expected[i].data) << i;
  }
  EXPECT_NE(masks[0].data, masks[1].data);
  EXPECT_EQ(masks[2].width, 32);
}

TEST_F(OpenVinoSegmenterTest, GrayImagesAreTaken) {
  const auto segmenter = Channels("output: {tensor: scores, labels: [0, 1], threshold: 0.5}");
  const Image8 mask = Segment(*segmenter, {Image8(64, 48, 1, 90)}).at(0);
  EXPECT_EQ(mask.At(30, 30), 255);  // three equal classes, two of them dynamic
}

TEST_F(OpenVinoSegmenterTest, OutputsThatDoNotFitTheDescriptionAreNamed) {
  const Image8 image = Halves(kRed, kBlue);
  for (const char* yaml : {"output: {tensor: scores, kind: labels}", "output: {tensor: scores, labels: [3]}"}) {
    const auto segmenter = Channels(yaml);
    EXPECT_THAT(ErrorOf([&] { std::ignore = Segment(*segmenter, {image}); }), HasSubstr("channels.xml")) << yaml;
  }
  EXPECT_THAT(ErrorOf([&] { std::ignore = Channels("input: {layout: NHWC}"); }), HasSubstr("three channels"));
}

TEST_F(OpenVinoSegmenterTest, ANetworkOfOpenSizeTakesTheOneGiven) {
  const std::string path = Write("open.onnx", kOpenSizeOnnx);
  Write("open.onnx.yaml", "input: {size: [24, 32]}\noutput: {labels: [0], threshold: 0.5}\n");
  const auto segmenter = MakeOpenVinoSegmenter(LoadSegmentationModel(path), {});
  const Image8 mask = Segment(*segmenter, {Halves(kRed, kBlue), Halves(kBlue, kRed)}).at(0);
  EXPECT_EQ(mask.At(10, 20), 255);
  EXPECT_EQ(mask.At(54, 20), 0);
  Write("open.onnx.yaml", "output: {labels: [0]}\n");
  const std::string error = ErrorOf([&] { std::ignore = MakeOpenVinoSegmenter(LoadSegmentationModel(path), {}); });
  EXPECT_THAT(error, HasSubstr("the network leaves its input size open"));
  EXPECT_THAT(error, HasSubstr("give it under input.size of " + path + ".yaml"));
}

TEST_F(OpenVinoSegmenterTest, OutputThatIsNotFiniteIsAFailure) {
  const auto segmenter =
      Channels("input: {scale: [1.0e-40, 1.0e-40, 1.0e-40]}\noutput: {tensor: scores, labels: [0]}\n");
  EXPECT_THAT(ErrorOf([&] { std::ignore = Segment(*segmenter, {Halves(kRed, kBlue)}); }), HasSubstr("is not finite"));
}

TEST_F(OpenVinoSegmenterTest, ThoseThatAreCanceledAnswerNothing) {
  const auto segmenter = Channels("output: {tensor: scores, labels: [0]}");
  segmenter->Cancel();
  EXPECT_TRUE(Segment(*segmenter, {Halves(kRed, kBlue)}).at(0).empty());
}

TEST_F(OpenVinoSegmenterTest, RubbishIsRefusedWithTheWayOut) {
  for (const char* name : {"deeplabv3_mnv2_361x481.onnx", "deeplabv3_mnv2_pascal_quant.tflite"}) {
    const std::string path = Write(name, std::string(5000, 'r'));
    const std::string error = ErrorOf([&] { std::ignore = MakeOpenVinoSegmenter(LoadSegmentationModel(path), {}); });
    EXPECT_THAT(error, HasSubstr(path));
    EXPECT_THAT(error, HasSubstr("rds fetch weights"));
  }
}

// Under any name, with a description and without: the file is at fault, not what is said about it.
TEST_F(OpenVinoSegmenterTest, DamagedFilesAreCalledThat) {
  const std::string half(kChannelNetwork, std::string(kChannelNetwork).size() / 2);
  for (const auto& [name, bytes] : {std::pair<std::string, std::string>{"own.onnx", std::string(5000, 'r')},
                                    {"own.tflite", std::string(5000, 'r')},
                                    {"own.tflite", std::string("\x1c\0\0\0TFL3", 8) + std::string(5000, 'r')},
                                    {"own.xml", half}}) {
    const std::string path = Write(name, bytes);
    fs::remove(path + ".yaml");
    SegmenterOptions options;
    options.model = path;
    EXPECT_THAT(ErrorOf([&] { std::ignore = MakeSegmenter("openvino", options, {}, {}); }),
                testing::AllOf(HasSubstr(path), HasSubstr("damaged, cut short, or not a model")));
    Write(name + ".yaml", "output: {labels: [0]}");
    EXPECT_THAT(ErrorOf([&] { std::ignore = MakeSegmenter("openvino", options, {}, {}); }),
                testing::AllOf(HasSubstr(path), HasSubstr("damaged, cut short, or not a model")));
  }
  SegmenterOptions options;
  options.model = Write("own.pt", "x");
  EXPECT_THAT(ErrorOf([&] { std::ignore = MakeSegmenter("openvino", options, {}, {}); }), HasSubstr(".onnx, .tflite"));
  options.model = (folder_ / "channels.xml").string();  // whole, but nobody says what it wants
  EXPECT_THAT(ErrorOf([&] { std::ignore = MakeSegmenter("openvino", options, {}, {}); }),
              HasSubstr("channels.xml.yaml"));
}

// ---- with the weights and pictures that $RDS_SHARED names ----

class OpenVinoWeightsTest : public OpenVinoSegmenterTest {
 protected:
  void SetUp() override {
    OpenVinoSegmenterTest::SetUp();
    if (IsSkipped()) {
      return;
    }
    const char* const given = std::getenv("RDS_SHARED");
    if (given == nullptr || !fs::is_directory(fs::path(given) / "models")) {
      GTEST_SKIP() << "no weights: RDS_SHARED does not name a folder that has models/";
    }
    shared_ = given;
  }
  [[nodiscard]] std::string Model(const std::string& name) const { return (shared_ / "models" / name).string(); }
  // A real frame with people in it, and one without.
  [[nodiscard]] Image8 People() const { return Load(shared_ / "data/stills/tum_1341846434.710184.png"); }
  [[nodiscard]] Image8 NoPeople() const { return Load(shared_ / "data/redkitchen/frame-000000.color.jpg"); }

  static Image8 Load(const fs::path& path) {
    const cv::Mat image = cv::imread(path.string());
    Check(!image.empty(), "picture is not there");
    return Image8::Copy(image.data, image.cols, image.rows, 3, image.step);
  }
  static double Share(const Image8& mask) {
    return 1.0 - static_cast<double>(std::count(mask.data.begin(), mask.data.end(), 0)) /
                     static_cast<double>(mask.data.size());
  }
  static double IntersectionOverUnion(const Image8& a, const Image8& b) {
    double both = 0;
    double either = 0;
    for (std::size_t i = 0; i < a.data.size(); ++i) {
      both += a.data[i] != 0 && b.data[i] != 0;
      either += a.data[i] != 0 || b.data[i] != 0;
    }
    return both / either;
  }

  fs::path shared_;
};

TEST_F(OpenVinoWeightsTest, EveryFileFindsPeopleAndNobodyElse) {
  const std::string accurate = Model("deeplabv3_mnv2_os8_481x641.onnx");
  const Image8 reference = Segment(*MakeOpenVinoSegmenter(LoadSegmentationModel(accurate), {}), {People()}).at(0);
  EXPECT_GT(Share(reference), 0.05);
  EXPECT_LT(Share(reference), 0.6);
  for (const char* name : {"deeplabv3_mnv2_361x481.onnx", "deeplabv3_mnv2_dm05_361x481.onnx",
                           "deeplabv3_mnv2_pascal_quant.tflite", "deeplabv3_mnv2_dm05_pascal_quant.tflite"}) {
    const auto segmenter = MakeOpenVinoSegmenter(LoadSegmentationModel(Model(name)), {});
    EXPECT_EQ(segmenter->Name(), std::string("openvino, ") + name);
    const std::vector<Image8> masks = Segment(*segmenter, {People(), NoPeople()});
    EXPECT_GT(IntersectionOverUnion(masks[0], reference), 0.6) << name;
    EXPECT_LT(Share(masks[1]), 0.02) << name;
    EXPECT_EQ(Segment(*segmenter, {People()}).at(0).data, masks[0].data) << name << ": not the same twice";
  }
}

// The published graph as it is (513 x 513, rounding, arg-max at its end) against what is made of it.
TEST_F(OpenVinoWeightsTest, TheShortenedGraphSeesWhatThePublishedOneSees) {
  const std::string original = Model("deeplabv3_mnv2_pascal_quant.tflite");
  SegmentationModel whole = LoadSegmentationModel(original);
  whole.input_height = whole.input_width = 0;
  whole.ignore_rounding = false;
  whole.output_tensor = "";
  whole.output = SegmentationModel::Output::kLabels;
  whole.stride = {0, 0};
  SegmentationModel shortened = LoadSegmentationModel(original);
  shortened.threshold = shortened.unsure = 0.5;  // about where a class wins the arg-max
  const Image8 a = Segment(*MakeOpenVinoSegmenter(whole, {}), {People()}).at(0);
  const Image8 b = Segment(*MakeOpenVinoSegmenter(shortened, {}), {People()}).at(0);
  EXPECT_GT(IntersectionOverUnion(a, b), 0.85);
}

TEST_F(OpenVinoWeightsTest, AFileCutShortIsRefused) {
  for (const char* name : {"deeplabv3_mnv2_pascal_quant.tflite", "deeplabv3_mnv2_dm05_361x481.onnx"}) {
    fs::copy_file(Model(name), folder_ / name);
    fs::permissions(folder_ / name, fs::perms::owner_all);
    fs::resize_file(folder_ / name, fs::file_size(folder_ / name) / 2);
    const std::string path = (folder_ / name).string();
    const std::string error = ErrorOf([&] { std::ignore = MakeOpenVinoSegmenter(LoadSegmentationModel(path), {}); });
    EXPECT_THAT(error, HasSubstr(path));
    EXPECT_THAT(error, HasSubstr("rds fetch weights"));
  }
}

TEST_F(OpenVinoWeightsTest, APublishedFileWithOneByteWrongIsRefused) {
  const char* const name = "deeplabv3_mnv2_dm05_pascal_quant.tflite";
  const fs::path file = folder_ / name;
  fs::copy_file(Model(name), file);
  fs::permissions(file, fs::perms::owner_all);
  EXPECT_NO_THROW(std::ignore = MakeOpenVinoSegmenter(LoadSegmentationModel(file.string()), {}));
  std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
  stream.seekg(100'000);
  const char right = static_cast<char>(stream.get());
  stream.seekp(100'000);
  stream.put(static_cast<char>(right ^ 1));
  stream.close();
  EXPECT_THAT(ErrorOf([&] { std::ignore = MakeOpenVinoSegmenter(LoadSegmentationModel(file.string()), {}); }),
              testing::AllOf(HasSubstr(file.string()), HasSubstr("damaged"), HasSubstr("rds fetch weights fast")));
}

// Wherever it is cut and whatever it is called.
TEST_F(OpenVinoWeightsTest, AFileOfAnotherNameCutShortIsRefused) {
  for (const char* name : {"deeplabv3_mnv2_dm05_pascal_quant.tflite", "deeplabv3_mnv2_dm05_361x481.onnx"}) {
    SegmenterOptions options;
    options.model = (folder_ / ("own" + fs::path(name).extension().string())).string();
    for (const double part : {0.001, 0.1, 0.5, 0.9, 0.9999}) {
      fs::copy_file(Model(name), options.model, fs::copy_options::overwrite_existing);
      fs::permissions(options.model, fs::perms::owner_all);
      const auto bytes = static_cast<double>(fs::file_size(options.model));
      fs::resize_file(options.model, static_cast<std::uintmax_t>(part * bytes));
      EXPECT_THAT(ErrorOf([&] { std::ignore = MakeSegmenter("openvino", options, {}, {}); }),
                  testing::AllOf(HasSubstr(options.model), HasSubstr("damaged, cut short, or not a model")))
          << part;
    }
  }
}

TEST_F(OpenVinoWeightsTest, CancelInterruptsARunUnderWay) {
  SegmentationModel model = LoadSegmentationModel(Model("deeplabv3_mnv2_os8_481x641.onnx"));
  const auto segmenter = MakeOpenVinoSegmenter(model, {});
  const Image8 people = People();
  Stopwatch watch;
  std::ignore = Segment(*segmenter, {people});  // compiled now
  std::vector<SegmentationInput> many(200, {FrameId{0}, 0, std::make_shared<Image8>(people)});
  std::thread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    segmenter->Cancel();
  });
  watch.Restart();
  const std::vector<Image8> masks = segmenter->Segment(many);
  EXPECT_LT(watch.Seconds(), 4);  // all of them take more than ten
  canceller.join();
  EXPECT_EQ(masks.size(), many.size());
  EXPECT_TRUE(masks.back().empty());
}

}  // namespace
}  // namespace rds
