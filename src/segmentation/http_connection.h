// SPDX-License-Identifier: Apache-2.0
// Requests to one HTTP server, over a connection that is kept.
#pragma once

#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace rds {

// No answer: nobody listens, the connection broke, it took too long, or it was canceled. what() is for people.
class HttpError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct HttpResponse {
  long status = 0;
  std::map<std::string, std::string> headers;  // names in small letters
  std::string body;
};

using HttpHeaders = std::vector<std::pair<std::string, std::string>>;

// Used by one thread at a time; Cancel by any.
class HttpConnection {
 public:
  // A response longer than that is an error.
  static constexpr std::size_t kLargestResponse_bytes = std::size_t{256} << 20;

  explicit HttpConnection(double timeout_s);
  ~HttpConnection();
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;

  // Throw HttpError. Any status is an answer.
  [[nodiscard]] HttpResponse Get(const std::string& url);
  [[nodiscard]] HttpResponse Post(const std::string& url, const HttpHeaders& headers, const std::string& body);

  // Ends a request under way, and every later one, with HttpError.
  void Cancel();

 private:
  class Impl;
  const std::unique_ptr<Impl> impl_;
};

}  // namespace rds
