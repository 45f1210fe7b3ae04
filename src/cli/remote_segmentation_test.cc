// SPDX-License-Identifier: Apache-2.0
// The back end "remote" against `rds serve`'s service and against servers of other kinds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "cli/inference_service.h"
#include "io/http_server.h"
#include "segmentation/http_connection.h"
#include "segmentation/inference_protocol.h"
#include "segmentation/mask.h"
#include "segmentation/remote_segmenter.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::HasSubstr;

// Dynamic where blue is strong, unsure where green is; counts what it is given.
class BlueSegmenter final : public Segmenter {
 public:
  [[nodiscard]] std::vector<Image8> Segment(std::span<const SegmentationInput> inputs) override {
    ++calls;
    std::vector<Image8> masks;
    for (const SegmentationInput& input : inputs) {
      Image8& mask = masks.emplace_back(input.image->width, input.image->height);
      for (std::size_t i = 0; i < mask.data.size(); ++i) {
        const std::uint8_t* const pixel = &input.image->data[3 * i];
        mask.data[i] = pixel[0] > 150 ? kDynamicPixel : pixel[1] > 150 ? kUnsurePixel : kStaticPixel;
      }
    }
    return masks;
  }
  void Cancel() override {}
  [[nodiscard]] std::string Name() const override { return "blue"; }

  static inline std::atomic<int> calls = 0;
};

// Left part blue, then green, the rest black.
SegmentationInput Picture(int width, int height, int blue_columns) {
  auto image = std::make_shared<Image8>(width, height, 3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width / 2; ++x) {
      image->At(x, y, x < blue_columns ? 0 : 1) = 255;
    }
  }
  return {FrameId{0}, 0, image};
}

// A server that runs the service at a port.
struct Server {
  explicit Server(std::uint16_t port = 0, const std::string& name = "blue")
      : service(name, std::make_unique<BlueSegmenter>(), 4) {
    HttpServerOptions options;
    options.port = port;
    options.largest_request_bytes = 200'000;
    http.emplace(options, [this](const HttpRequest& request) { return service.Answer(request); });
  }
  [[nodiscard]] std::string Address() const { return "http://127.0.0.1:" + std::to_string(http->port()); }
  [[nodiscard]] std::string Url() const { return Address() + "/v2/models/blue"; }

  InferenceService service;
  std::optional<HttpServer> http;
};

RemoteOptions OptionsFor(const std::string& url, double timeout_s = 5) {
  RemoteOptions options;
  options.url = url;
  options.timeout_s = timeout_s;
  return options;
}

std::unique_ptr<Segmenter> Remote(const RemoteOptions& options) { return MakeRemoteSegmenter(options, "person"); }

TEST(RemoteSegmentation, GivesTheMasksOfTheServersOwnSegmenter) {
  const Server server;
  const auto remote = Remote(OptionsFor(server.Url()));
  const std::vector<SegmentationInput> inputs = {Picture(64, 48, 10), Picture(64, 48, 20), Picture(32, 20, 5)};
  BlueSegmenter local;
  const std::vector<Image8> expected = local.Segment(inputs);
  BlueSegmenter::calls = 0;
  const std::vector<Image8> masks = remote->Segment(inputs);
  ASSERT_EQ(masks.size(), 3U);
  for (std::size_t i = 0; i < masks.size(); ++i) {
    EXPECT_EQ(masks[i].width, expected[i].width);
    EXPECT_EQ(masks[i].data, expected[i].data);
  }
  EXPECT_EQ(BlueSegmenter::calls, 2);  // two of one size go together
  RemoteOptions jpeg = OptionsFor(server.Url());
  jpeg.jpeg_quality = 95;
  const Image8 mask = Remote(jpeg)->Segment(std::span(inputs).first(1))[0];
  EXPECT_GT(mask.At(3, 20), kUnsurePixel);
  EXPECT_EQ(mask.At(50, 20), kStaticPixel);
  EXPECT_THAT(remote->Name(), HasSubstr("/v2/models/blue"));
}

// Whatever is built in for networks of that name, which may be of a fixed size, is the server's business.
TEST(RemoteSegmentation, OurOwnServerTakesImagesAsTheyAre) {
  const Server server(0, "deeplabv3_mnv2_pascal_quant");
  const auto remote = Remote(OptionsFor(server.Address() + "/v2/models/deeplabv3_mnv2_pascal_quant"));
  const std::vector<SegmentationInput> inputs = {Picture(64, 48, 10)};
  BlueSegmenter local;
  EXPECT_EQ(remote->Segment(inputs)[0].data, local.Segment(inputs)[0].data);
}

TEST(RemoteSegmentation, FindsAServerThatComesBack) {
  auto server = std::make_unique<Server>();
  const std::uint16_t port = server->http->port();
  const auto remote = Remote(OptionsFor(server->Url(), 1));
  const std::vector<SegmentationInput> inputs = {Picture(64, 48, 10)};
  EXPECT_EQ(remote->Segment(inputs).size(), 1U);
  server.reset();
  EXPECT_THROW((void)remote->Segment(inputs), HttpError);
  EXPECT_THROW((void)remote->Segment(inputs), HttpError);
  server = std::make_unique<Server>(port);
  EXPECT_EQ(remote->Segment(inputs)[0].At(3, 20), kDynamicPixel);
}

TEST(RemoteSegmentation, ADeadServerEndsNothing) {
  std::uint16_t port = 0;
  {
    const Server server;
    port = server.http->port();  // nobody listens there any more
  }
  const auto remote = Remote(OptionsFor("http://127.0.0.1:" + std::to_string(port) + "/v2/models/blue"));
  const std::vector<SegmentationInput> inputs = {Picture(64, 48, 10)};
  for (int i = 0; i < 3; ++i) {
    EXPECT_THROW((void)remote->Segment(inputs), HttpError);
  }
  std::thread canceler([&remote] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    remote->Cancel();
  });
  EXPECT_TRUE(remote->Segment(inputs)[0].empty());  // while it waits before it asks again
  canceler.join();
}

TEST(RemoteSegmentation, AServerThatNeverAnswersTimesOutAndIsCanceled) {
  std::atomic<bool> end = false;
  HttpServer server({}, [&end](const HttpRequest& request) {
    while (request.method == "POST" && !end) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return HttpReply{.body = R"({"platform":"rds","inputs":[{"name":"image","datatype":"UINT8","shape":[-1,-1,-1,3]}],
                               "outputs":[{"name":"mask","datatype":"UINT8","shape":[-1,-1,-1]}]})"};
  });
  const std::string url = "http://127.0.0.1:" + std::to_string(server.port()) + "/v2/models/slow";
  const std::vector<SegmentationInput> inputs = {Picture(64, 48, 10)};
  EXPECT_THROW((void)Remote(OptionsFor(url, 0.05))->Segment(inputs), HttpError);
  const auto remote = Remote(OptionsFor(url, 60));
  std::thread canceler([&remote] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    remote->Cancel();
  });
  EXPECT_TRUE(remote->Segment(inputs)[0].empty());
  canceler.join();
  end = true;
}

TEST(RemoteSegmentation, SaysWhatIsWrongWithAddressAndModel) {
  const Server server;
  const auto error = [](const std::string& url) { return InputErrorOf([&] { (void)Remote(OptionsFor(url)); }); };
  EXPECT_THAT(error(""), HasSubstr("http://HOST:PORT/v2/models/NAME"));
  EXPECT_THAT(error("ftp://x/v2/models/y"), HasSubstr("no address of a model"));
  EXPECT_THAT(error(server.Address() + "/v2/models/red"), HasSubstr("the model is at /v2/models/blue"));
  EXPECT_THAT(InputErrorOf([&] { (void)MakeRemoteSegmenter(OptionsFor(server.Url()), "cat"); }),
              HasSubstr("give it to `rds serve`"));
}

// A server of another make: an FP32 network of fixed size whose three channels are the scores of three classes.
HttpReply ChannelNetwork(const HttpRequest& request, const std::string& datatype) {
  if (request.method == "GET") {
    return {.body = R"({"name":"channels","platform":"onnxruntime_onnx","inputs":[{"name":"x","datatype":")" +
                    datatype +
                    R"(","shape":[1,3,8,8]}],"outputs":[{"name":"scores","datatype":"FP32","shape":[1,3,8,8]}]})"};
  }
  const std::size_t length = ParseLength(request.headers.at("inference-header-content-length"));
  InferenceMessage message = DecodeInference(request.body, length, "inputs");
  message.tensors[0].name = "scores";
  InferenceBody body = EncodeInference({}, "outputs", message.tensors);
  return {.headers = {{kInferenceHeader, std::to_string(body.json_length)}}, .body = std::move(body.bytes)};
}

TEST(RemoteSegmentation, RunsANetworkThatADescriptionTellsOf) {
  const HttpServer server({}, [](const HttpRequest& request) { return ChannelNetwork(request, "FP32"); });
  const std::string url = "http://127.0.0.1:" + std::to_string(server.port()) + "/v2/models/channels";
  const TemporaryFolder folder;
  RemoteOptions options = OptionsFor(url);
  EXPECT_THAT(InputErrorOf([&] { (void)Remote(options); }), HasSubstr("semantic.remote.description"));
  folder.Write("channels.yaml", "input:\n  scale: [10, 10, 10]\noutput:\n  labels: [2]\n");  // RGB: the last is blue
  options.description = folder.path() / "channels.yaml";
  const Image8 mask = Remote(options)->Segment(std::vector{Picture(64, 48, 16)})[0];
  EXPECT_EQ(mask.width, 64);
  EXPECT_EQ(mask.At(4, 24), kDynamicPixel);
  EXPECT_EQ(mask.At(24, 24), kStaticPixel);
  const HttpServer halves({}, [](const HttpRequest& request) { return ChannelNetwork(request, "FP16"); });
  options.url = "http://127.0.0.1:" + std::to_string(halves.port()) + "/v2/models/channels";
  EXPECT_THAT(InputErrorOf([&] { (void)Remote(options); }), HasSubstr("BYTES, UINT8 or FP32 images are sent"));
}

TEST(RemoteSegmentation, TheServiceRefusesWhatItCannotTake) {
  const Server server;
  HttpConnection connection(5);
  EXPECT_THAT(connection.Get(server.Address() + "/v2").body, HasSubstr("binary_tensor_data"));
  EXPECT_EQ(connection.Get(server.Address() + "/v2/health/ready").status, 200);
  EXPECT_EQ(connection.Get(server.Url() + "/ready").status, 200);
  EXPECT_EQ(connection.Get(server.Address() + "/etc/passwd").status, 404);
  const std::string infer = server.Url() + "/infer";
  EXPECT_EQ(connection.Get(infer).status, 405);
  EXPECT_EQ(connection.Post(server.Url(), {}, "x").status, 405);
  EXPECT_EQ(connection.Post(infer, {}, "x").status, 400);
  EXPECT_EQ(connection.Post(infer, {{kInferenceHeader, "99"}}, "{}").status, 400);
  EXPECT_EQ(connection.Post(infer, {}, std::string(300'000, 'x')).status, 413);
  const auto refused = [&](const InferenceTensor& tensor) {
    const InferenceBody body = EncodeInference({}, "inputs", {tensor});
    const HttpResponse response =
        connection.Post(infer, {{kInferenceHeader, std::to_string(body.json_length)}}, body.bytes);
    EXPECT_EQ(response.status, 400) << response.body;
    return response.body;
  };
  EXPECT_THAT(refused({"image", "UINT8", {9, 1, 1, 3}, std::string(27, 0)}), HasSubstr("at most 8 images"));
  EXPECT_THAT(refused({"image", "UINT8", {1, 1, 3}, "abc"}), HasSubstr("[n, height, width, 3]"));
  EXPECT_THAT(refused({"image", "UINT8", {0, 1, 1, 3}, ""}), HasSubstr("one at least"));
  EXPECT_THAT(refused({"image", "BYTES", {1}, AsBytesElement("GIF89a")}), HasSubstr("image"));
  EXPECT_THAT(refused({"image", "FP32", {1}, "abcd"}), HasSubstr("UINT8 or BYTES"));
  EXPECT_THAT(refused({"picture", "UINT8", {1, 1, 1, 3}, "abc"}), HasSubstr("called 'image'"));
}

TEST(RemoteSegmentation, AServerHasItsPortAlone) {
  const Server server;
  HttpServerOptions options;
  options.port = server.http->port();
  const auto handler = [](const HttpRequest&) { return HttpReply{}; };
  EXPECT_THAT(InputErrorOf([&] { HttpServer(options, handler); }), HasSubstr("cannot be served"));
  options.address = "nowhere";
  EXPECT_THAT(InputErrorOf([&] { HttpServer(options, handler); }), HasSubstr("nowhere"));
}

TEST(RemoteSegmentation, AHandlerThatThrowsIsAnsweredFor) {
  const HttpServer server({}, [](const HttpRequest&) -> HttpReply { throw std::runtime_error("secret"); });
  HttpConnection connection(5);
  const HttpResponse response = connection.Get("http://127.0.0.1:" + std::to_string(server.port()) + "/");
  EXPECT_EQ(response.status, 500);
  EXPECT_THAT(response.body, ::testing::Not(HasSubstr("secret")));
}

}  // namespace
}  // namespace rds
