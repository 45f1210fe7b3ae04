// SPDX-License-Identifier: Apache-2.0
// A small HTTP server.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>

namespace rds {

struct HttpRequest {
  std::string method;                          // "GET"
  std::string target;                          // "/v2/models/NAME"
  std::map<std::string, std::string> headers;  // names in small letters
  std::string body;
};

struct HttpReply {
  unsigned status = 200;
  std::string content_type = "application/json";
  std::map<std::string, std::string> headers{};
  std::string body{};
};

struct HttpServerOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  // 0 = any that is free
  std::size_t largest_request_bytes = std::size_t{64} << 20;
  int most_connections = 64;  // more are closed at once
  int threads = 4;            // that run the handler: this many requests at a time
  double timeout_s = 30;      // for a request to arrive or an answer to leave; then the connection is closed
};

// Serves from the constructor on, until it is destroyed, on threads of its own; `handler` is called by several of them
// at once, and what it throws is answered with status 500. Connections are kept as HTTP/1.1 has it.
class HttpServer {
 public:
  using Handler = std::function<HttpReply(const HttpRequest& request)>;

  // InputError if the address is none or cannot be had (the port is taken).
  HttpServer(const HttpServerOptions& options, Handler handler);
  // Requests that the handler has are waited for; connections are closed.
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  [[nodiscard]] std::uint16_t port() const;

 private:
  class Impl;
  const std::unique_ptr<Impl> impl_;
};

}  // namespace rds
