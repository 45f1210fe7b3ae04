// SPDX-License-Identifier: Apache-2.0
#include "segmentation/http_connection.h"

#include <curl/curl.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>

#include "base/error.h"
#include "base/text.h"

namespace rds {
namespace {

std::string SmallLetters(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// What arrives.
struct Answer {
  HttpResponse response;
  bool too_long = false;
};

std::size_t TakeBody(char* data, std::size_t size, std::size_t count, void* user) {
  auto& answer = *static_cast<Answer*>(user);
  if (answer.response.body.size() + size * count > HttpConnection::kLargestResponse_bytes) {
    answer.too_long = true;
    return 0;
  }
  answer.response.body.append(data, size * count);
  return size * count;
}

std::size_t TakeHeader(char* data, std::size_t size, std::size_t count, void* user) {
  const std::string line(data, size * count);
  auto& headers = static_cast<Answer*>(user)->response.headers;
  if (line.starts_with("HTTP/")) {
    headers.clear();  // of the answer before: "100 Continue"
  }
  if (const std::size_t colon = line.find(':'); colon != std::string::npos && headers.size() < 100) {
    headers[SmallLetters(line.substr(0, colon))] = Trimmed(std::string_view(line).substr(colon + 1));
  }
  return size * count;
}

int StopIfCanceled(void* user, curl_off_t /*to_load*/, curl_off_t /*loaded*/, curl_off_t /*to_send*/,
                   curl_off_t /*sent*/) {
  return static_cast<const std::atomic<bool>*>(user)->load() ? 1 : 0;
}

}  // namespace

class HttpConnection::Impl {
 public:
  explicit Impl(double timeout_s) : timeout_s_(timeout_s), curl_(Make(), &curl_easy_cleanup) {
    Check(curl_ != nullptr, "curl has no memory");
  }

  HttpResponse Request(const std::string& url, const HttpHeaders& headers, const std::string* body) {
    CURL* const curl = curl_.get();
    curl_easy_reset(curl);  // options only: the connection stays
    Answer answer;
    std::array<char, CURL_ERROR_SIZE> message{};
    std::unique_ptr<curl_slist, decltype(&curl_slist_free_all)> list(nullptr, &curl_slist_free_all);
    const auto add = [&list](const std::string& line) {
      curl_slist* const longer = curl_slist_append(list.get(), line.c_str());
      Check(longer != nullptr, "curl has no memory");
      (void)list.release();
      list.reset(longer);
    };
    for (const auto& [name, value] : headers) {
      add(fmt::format("{}: {}", name, value));
    }
    add("Expect:");  // no question before a large body: it costs a round trip
    curl_easy_setopt(curl, CURLOPT_URL, url.c_str());
#if LIBCURL_VERSION_NUM >= 0x075500
    curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
#else
    curl_easy_setopt(curl, CURLOPT_PROTOCOLS, CURLPROTO_HTTP | CURLPROTO_HTTPS);
#endif
    curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(curl, CURLOPT_USERAGENT, "rds");
    curl_easy_setopt(curl, CURLOPT_TIMEOUT_MS, static_cast<long>(1e3 * timeout_s_));
    curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT_MS, static_cast<long>(1e3 * std::min(timeout_s_, 2.0)));
    curl_easy_setopt(curl, CURLOPT_TCP_NODELAY, 1L);
    curl_easy_setopt(curl, CURLOPT_HTTPHEADER, list.get());
    curl_easy_setopt(curl, CURLOPT_ERRORBUFFER, message.data());
    curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, &TakeBody);
    curl_easy_setopt(curl, CURLOPT_WRITEDATA, &answer);
    curl_easy_setopt(curl, CURLOPT_HEADERFUNCTION, &TakeHeader);
    curl_easy_setopt(curl, CURLOPT_HEADERDATA, &answer);
    curl_easy_setopt(curl, CURLOPT_NOPROGRESS, 0L);
    curl_easy_setopt(curl, CURLOPT_XFERINFOFUNCTION, &StopIfCanceled);
    curl_easy_setopt(curl, CURLOPT_XFERINFODATA, &canceled_);
    if (body != nullptr) {
      curl_easy_setopt(curl, CURLOPT_POSTFIELDS, body->data());
      curl_easy_setopt(curl, CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(body->size()));
    }
    const CURLcode code = canceled_ ? CURLE_ABORTED_BY_CALLBACK : curl_easy_perform(curl);
    if (code == CURLE_ABORTED_BY_CALLBACK) {
      throw HttpError(url + ": canceled");
    }
    if (answer.too_long) {
      throw HttpError(fmt::format("{}: the answer is longer than {} MB", url, kLargestResponse_bytes >> 20));
    }
    if (code != CURLE_OK) {
      throw HttpError(fmt::format("{}: {}", url, message[0] != '\0' ? message.data() : curl_easy_strerror(code)));
    }
    curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &answer.response.status);
    return std::move(answer.response);
  }

  void Cancel() { canceled_ = true; }

 private:
  static CURL* Make() {
    static const CURLcode ready = curl_global_init(CURL_GLOBAL_DEFAULT);
    Check(ready == CURLE_OK, "curl cannot be set up");
    return curl_easy_init();
  }

  const double timeout_s_;
  const std::unique_ptr<CURL, decltype(&curl_easy_cleanup)> curl_;
  std::atomic<bool> canceled_ = false;
};

HttpConnection::HttpConnection(double timeout_s) : impl_(std::make_unique<Impl>(timeout_s)) {}

HttpConnection::~HttpConnection() = default;

HttpResponse HttpConnection::Get(const std::string& url) { return impl_->Request(url, {}, nullptr); }

HttpResponse HttpConnection::Post(const std::string& url, const HttpHeaders& headers, const std::string& body) {
  return impl_->Request(url, headers, &body);
}

void HttpConnection::Cancel() { impl_->Cancel(); }

}  // namespace rds
