// SPDX-License-Identifier: Apache-2.0
#include "io/http_server.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/bind_executor.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <cctype>
#include <chrono>
#include <exception>
#include <memory>
#include <optional>
#include <utility>  // before Boost: its 1.74 forgets that it needs it
#include <vector>

#include "base/error.h"
#include "base/log.h"
#include "runtime/worker.h"

namespace rds {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using asio::ip::tcp;

constexpr std::size_t kRead_bytes = 65536;  // at once; by itself Beast begins with 512, and images take long

// What all connections share.
struct Shared {
  HttpServerOptions options;
  HttpServer::Handler handler;
  std::atomic<int> connections = 0;
};

std::string ToText(beast::string_view text) { return {text.data(), text.size()}; }

HttpRequest FromBeast(const http::request<http::string_body>& message) {
  HttpRequest request{ToText(message.method_string()), ToText(message.target()), {}, message.body()};
  for (const auto& field : message) {
    std::string name = ToText(field.name_string());
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    request.headers[name] = ToText(field.value());
  }
  return request;
}

// One connection. Lives as long as an operation of it is under way; its operations follow one another on its strand.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket socket, std::shared_ptr<Shared> shared)
      : stream_(std::move(socket)), shared_(std::move(shared)) {
    ++shared_->connections;
    buffer_.reserve(kRead_bytes);
    beast::error_code ignored;
    stream_.socket().set_option(tcp::no_delay(true), ignored);  // the end of an answer is not held back
  }
  ~Connection() { --shared_->connections; }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void Read() {
    parser_.emplace();
    parser_->body_limit(shared_->options.largest_request_bytes);
    parser_->header_limit(16384);
    ExpireLater();
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](beast::error_code error, std::size_t) { self->OnRead(error); });
  }

 private:
  void ExpireLater() {
    stream_.expires_after(std::chrono::milliseconds(static_cast<std::int64_t>(1e3 * shared_->options.timeout_s)));
  }

  void OnRead(beast::error_code error) {
    if (error == http::error::body_limit) {
      Write({.status = 413, .body = R"({"error":"the request is too large"})"}, false);
    } else if (error == http::error::end_of_stream) {
      Close();
    } else if (error && stream_.socket().is_open() &&
               error.category() == http::make_error_code(http::error::bad_method).category()) {
      Write({.status = 400, .body = R"({"error":"this is no HTTP"})"}, false);
    } else if (!error) {
      stream_.expires_never();  // the handler may take its time
      const http::request<http::string_body> message = parser_->release();
      Write(Handle(FromBeast(message)), message.keep_alive());
    }
  }

  [[nodiscard]] HttpReply Handle(const HttpRequest& request) const {
    try {
      return shared_->handler(request);
    } catch (const std::exception& error) {
      log::warn("{} {}: {}", request.method, request.target, error.what());
      return {.status = 500, .body = R"({"error":"the server failed; its log says why"})"};
    }
  }

  void Write(HttpReply reply, bool keep) {
    auto message = std::make_shared<http::response<http::string_body>>(static_cast<http::status>(reply.status), 11);
    message->set(http::field::server, "rds");
    message->set(http::field::content_type, reply.content_type);
    for (const auto& [name, value] : reply.headers) {
      message->set(name, value);
    }
    message->body() = std::move(reply.body);
    message->keep_alive(keep);
    message->prepare_payload();
    ExpireLater();
    http::async_write(stream_, *message, [self = shared_from_this(), message](beast::error_code error, std::size_t) {
      if (!error && message->keep_alive()) {
        self->Read();
      } else {
        self->Close();
      }
    });
  }

  void Close() {
    beast::error_code ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
  }

  beast::tcp_stream stream_;
  const std::shared_ptr<Shared> shared_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;
};

}  // namespace

class HttpServer::Impl {
 public:
  Impl(const HttpServerOptions& options, Handler handler)
      : shared_(std::make_shared<Shared>()), context_(options.threads), acceptor_(context_), pause_(context_) {
    shared_->options = options;
    shared_->handler = std::move(handler);
    Listen();
    Accept();
    for (int i = 0; i < options.threads; ++i) {
      workers_.push_back(std::make_unique<Worker>([this] { context_.run(); }));
    }
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  [[nodiscard]] std::uint16_t port() const { return acceptor_.local_endpoint().port(); }

 private:
  void Listen() {
    const HttpServerOptions& options = shared_->options;
    try {
      const tcp::endpoint endpoint(asio::ip::make_address(options.address), options.port);
      acceptor_.open(endpoint.protocol());
      acceptor_.set_option(asio::socket_base::reuse_address(true));
      acceptor_.bind(endpoint);
      acceptor_.listen();
    } catch (const boost::system::system_error& error) {
      throw InputError(
          fmt::format("{} port {}: cannot be served at: {}", options.address, options.port, error.code().message()));
    }
  }

  void Accept() {
    acceptor_.async_accept(asio::make_strand(context_), [this](beast::error_code error, tcp::socket socket) {
      if (error) {  // no more files may be opened, say: later perhaps
        pause_.expires_after(std::chrono::milliseconds(100));
        pause_.async_wait([this](beast::error_code) { Accept(); });
        return;
      }
      if (shared_->connections < shared_->options.most_connections) {
        beast::error_code ignored;
        socket.set_option(tcp::no_delay(true), ignored);
        std::make_shared<Connection>(std::move(socket), shared_)->Read();
      }
      Accept();
    });
  }

  const std::shared_ptr<Shared> shared_;
  asio::io_context context_;
  tcp::acceptor acceptor_;
  asio::steady_timer pause_;
  std::vector<std::unique_ptr<Worker>> workers_;
  // The last member, so that workers are stopped before they are joined, also where not all of them could be made.
  struct Stopper {
    ~Stopper() { context.stop(); }
    asio::io_context& context;
  } stopper_{context_};
};

HttpServer::HttpServer(const HttpServerOptions& options, Handler handler)
    : impl_(std::make_unique<Impl>(options, std::move(handler))) {}

HttpServer::~HttpServer() = default;

std::uint16_t HttpServer::port() const { return impl_->port(); }

}  // namespace rds
