// SPDX-License-Identifier: Apache-2.0
// rds serve: segmentation for another machine.
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include "base/error.h"
#include "cli/command.h"
#include "cli/inference_service.h"
#include "cli/interrupt.h"
#include "cli/play_arguments.h"
#include "segmentation/segmenter_factory.h"

namespace rds {
namespace {

struct ServeArguments {
  OptionArguments options;
  std::string model;
  std::string host = "127.0.0.1";
  int port = 8000;
  int queue = 4;
};

// "deeplabv3_mnv2_361x481" of a path, as it can stand in an address.
std::string NameOfModel(const std::string& weights) {
  std::string name = std::filesystem::path(weights).stem().string();
  for (char& c : name) {
    c = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '_' ? c : '-';
  }
  return name;
}

// Until a signal ends it. Returns the exit code: a server is ended by signals, so 0.
int Serve(const ServeArguments& arguments) {
  Options options = ResolveOptions(arguments.options);
  if (!arguments.model.empty()) {
    options.segmenter.model = arguments.model;
  }
  const std::string weights = ResolveWeights(options.segmenter.model);
  const std::string name = NameOfModel(weights);
  InferenceService service(name, MakeSegmenter("openvino", options.segmenter, {}, {}), arguments.queue);
  HttpServerOptions server_options;
  server_options.address = arguments.host;
  server_options.port = static_cast<std::uint16_t>(arguments.port);
  server_options.threads = arguments.queue + 3;  // health is answered while others wait
  const InterruptGuard interrupt_guard;
  const HttpServer server(server_options, [&service](const HttpRequest& request) { return service.Answer(request); });
  const std::string host = arguments.host.find(':') == std::string::npos ? arguments.host : "[" + arguments.host + "]";
  std::cout << fmt::format("{} at http://{}:{}/v2/models/{}\n", weights, host, server.port(), name) << std::flush;
  while (!Interrupted()) {
    usleep(50'000);
  }
  service.Cancel();
  return 0;
}

}  // namespace

void AddServeCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "serve",
      "Run a segmentation network for other machines, by the Open Inference Protocol (KServe v2) over HTTP; a robot "
      "asks it with --segmenter remote --set semantic.remote.url=ADDRESS, the address that is printed. Ctrl-C ends "
      "it.");
  auto arguments = std::make_shared<ServeArguments>();
  command
      ->add_option("--model", arguments->model,
                   "Weights: a file, or fast or accurate for the published ones (see `rds fetch`)")
      ->type_name("WEIGHTS");
  command
      ->add_option("--host", arguments->host,
                   "Address to listen at; default 127.0.0.1, this machine only. 0.0.0.0: whoever can reach it, with "
                   "neither password nor encryption")
      ->type_name("ADDRESS");
  command->add_option("--port", arguments->port, "0 = any that is free; default 8000")
      ->type_name("N")
      ->check(CLI::Range(0, 65535));
  command->add_option("--queue", arguments->queue, "Requests that wait at most; default 4")
      ->type_name("N")
      ->check(CLI::Range(0, 64));
  AddOptionArguments(*command, arguments->options);
  command->callback([arguments] { EndCommand(Serve(*arguments)); });
}

}  // namespace rds
