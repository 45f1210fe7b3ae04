// SPDX-License-Identifier: Apache-2.0
#include "io/download.h"

#include <curl/curl.h>
#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <system_error>

#include "base/error.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

// Where curl's bytes go: the end of a file, never beyond the size wanted.
struct Sink {
  int file = -1;
  std::int64_t done = 0;
  std::int64_t total = 0;
  const DownloadProgress* progress = nullptr;
  bool write_failed = false;
  bool too_long = false;
};

std::size_t Receive(char* data, std::size_t size, std::size_t count, void* user) {
  auto& sink = *static_cast<Sink*>(user);
  const auto bytes = static_cast<std::int64_t>(size * count);
  if (sink.done + bytes > sink.total) {
    sink.too_long = true;
    return 0;
  }
  for (std::int64_t written = 0; written < bytes;) {
    const ssize_t step = write(sink.file, data + written, static_cast<std::size_t>(bytes - written));
    if (step < 0 && errno != EINTR) {
      sink.write_failed = true;
      return 0;
    }
    written += std::max<ssize_t>(step, 0);
  }
  sink.done += bytes;
  if (*sink.progress) {
    (*sink.progress)(sink.done, sink.total);
  }
  return size * count;
}

struct Attempt {
  CURLcode code = CURLE_OK;
  long status = 0;
  std::string message;
};

void LimitToHttp(CURL* curl) {
#if LIBCURL_VERSION_NUM >= 0x075500
  curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https,file");
  curl_easy_setopt(curl, CURLOPT_REDIR_PROTOCOLS_STR, "http,https");
#else
  curl_easy_setopt(curl, CURLOPT_PROTOCOLS, CURLPROTO_HTTP | CURLPROTO_HTTPS | CURLPROTO_FILE);
  curl_easy_setopt(curl, CURLOPT_REDIR_PROTOCOLS, CURLPROTO_HTTP | CURLPROTO_HTTPS);
#endif
}

// A path of a user may have blanks; a URL has none.
std::string WithoutBlanks(const std::string& url) {
  std::string escaped;
  for (const char c : url) {
    escaped += c == ' ' ? std::string("%20") : std::string(1, c);
  }
  return escaped;
}

using CurlHandle = std::unique_ptr<CURL, decltype(&curl_easy_cleanup)>;

// A handle for one request; `message` takes what goes wrong.
CurlHandle Connect(const std::string& url, char* message) {
  static const CURLcode ready = curl_global_init(CURL_GLOBAL_DEFAULT);
  Check(ready == CURLE_OK, "curl cannot be set up");
  CurlHandle curl(curl_easy_init(), &curl_easy_cleanup);
  Check(curl != nullptr, "curl has no memory");
  curl_easy_setopt(curl.get(), CURLOPT_URL, WithoutBlanks(url).c_str());
  if (const char* const certificates = std::getenv("SSL_CERT_FILE"); certificates != nullptr && *certificates != '\0') {
    curl_easy_setopt(curl.get(), CURLOPT_CAINFO, certificates);  // NOLINT(concurrency-mt-unsafe)
  }
  LimitToHttp(curl.get());
  curl_easy_setopt(curl.get(), CURLOPT_FOLLOWLOCATION, 1L);
  curl_easy_setopt(curl.get(), CURLOPT_MAXREDIRS, 5L);
  curl_easy_setopt(curl.get(), CURLOPT_FAILONERROR, 1L);
  curl_easy_setopt(curl.get(), CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl.get(), CURLOPT_CONNECTTIMEOUT, 20L);
  curl_easy_setopt(curl.get(), CURLOPT_LOW_SPEED_LIMIT, 100L);  // bytes a second
  curl_easy_setopt(curl.get(), CURLOPT_LOW_SPEED_TIME, 30L);    // seconds
  curl_easy_setopt(curl.get(), CURLOPT_USERAGENT, "rds");
  curl_easy_setopt(curl.get(), CURLOPT_ERRORBUFFER, message);
  return curl;
}

// One request for the bytes from sink.done on.
Attempt Request(const std::string& url, Sink& sink) {
  std::array<char, CURL_ERROR_SIZE> message{};
  const CurlHandle curl = Connect(url, message.data());
  curl_easy_setopt(curl.get(), CURLOPT_RESUME_FROM_LARGE, static_cast<curl_off_t>(sink.done));
  curl_easy_setopt(curl.get(), CURLOPT_WRITEFUNCTION, &Receive);
  curl_easy_setopt(curl.get(), CURLOPT_WRITEDATA, &sink);
  Attempt attempt;
  attempt.code = curl_easy_perform(curl.get());
  curl_easy_getinfo(curl.get(), CURLINFO_RESPONSE_CODE, &attempt.status);
  attempt.message = message[0] != '\0' ? message.data() : curl_easy_strerror(attempt.code);
  return attempt;
}

// Opens the beginning of an earlier try, or a new file. What lies there under that name and is no plain file of our own
// is not written to: a link may lead anywhere.
int OpenPart(const fs::path& file) {
  const int opened = open(file.c_str(), O_WRONLY | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0644);
  if (opened < 0) {
    throw InputError(fmt::format("{}: cannot be written: {}", file.string(),
                                 errno == ELOOP ? "it is a link; remove it" : std::strerror(errno)));
  }
  struct stat status {};
  if (fstat(opened, &status) != 0 || !S_ISREG(status.st_mode) || status.st_uid != geteuid() || status.st_nlink != 1) {
    close(opened);
    throw InputError(file.string() + ": cannot be written: there is something that is no file of ours; remove it");
  }
  return opened;
}

// Bytes of the file that can be built on; a file that is too long is no beginning of the right one.
std::int64_t UsableBytes(const fs::path& file, std::int64_t bytes) {
  std::error_code error;
  const auto size = fs::file_size(file, error);
  return error || size > static_cast<std::uintmax_t>(bytes) ? 0 : static_cast<std::int64_t>(size);
}

Attempt RequestInto(const fs::path& file, const std::string& url, std::int64_t from, Sink& sink) {
  sink.file = OpenPart(file);
  if (ftruncate(sink.file, from) != 0 || lseek(sink.file, from, SEEK_SET) != from) {
    sink.write_failed = true;
  }
  sink.done = from;
  Attempt attempt = Request(url, sink);
  sink.write_failed |= close(sink.file) != 0;
  if (sink.done == 0) {
    std::error_code error;
    fs::remove(file, error);  // nothing came; leave nothing
  }
  return attempt;
}

}  // namespace

DownloadResult Download(const std::string& url, const fs::path& file, std::int64_t bytes,
                        const DownloadProgress& progress) {
  Sink sink;
  sink.total = bytes;
  sink.progress = &progress;
  const std::int64_t there = UsableBytes(file, bytes);
  if (there == bytes) {
    return {.complete = true};
  }
  Attempt attempt = RequestInto(file, url, there, sink);
  // The server sends whole files only, or says that its file ends before ours.
  if (there > 0 && (attempt.code == CURLE_RANGE_ERROR || attempt.status == 416)) {
    attempt = RequestInto(file, url, 0, sink);
  }
  if (sink.write_failed) {
    throw InputError(fmt::format("{}: cannot be written; is the disk full?", file.string()));
  }
  if (sink.too_long) {
    std::error_code error;
    fs::remove(file, error);
    return {.problem = fmt::format("{}: longer than the {} bytes that were published", url, bytes)};
  }
  if (attempt.code == CURLE_OK && sink.done == bytes) {
    return {.complete = true};
  }
  if (attempt.code == CURLE_OK) {  // all that the server has, and not ours: a captive portal's page is no beginning
    std::error_code error;
    fs::remove(file, error);
    return {.problem = fmt::format("{}: {} bytes, but {} were published; is there a login page before the internet?",
                                   url, sink.done, bytes)};
  }
  const bool refused = attempt.code == CURLE_HTTP_RETURNED_ERROR || attempt.code == CURLE_COULDNT_RESOLVE_HOST ||
                       attempt.code == CURLE_UNSUPPORTED_PROTOCOL || attempt.code == CURLE_URL_MALFORMAT;
  return {.worth_retrying = !refused,
          .problem = fmt::format("{}: {}{}", url, attempt.message,
                                 sink.done > 0 ? fmt::format(" ({} of {} bytes are there; run the command again to go "
                                                             "on)",
                                                             sink.done, bytes)
                                               : "")};
}

std::int64_t RemoteSize(const std::string& url) {
  std::array<char, CURL_ERROR_SIZE> message{};
  const CurlHandle curl = Connect(url, message.data());
  curl_easy_setopt(curl.get(), CURLOPT_NOBODY, 1L);
  const CURLcode code = curl_easy_perform(curl.get());
  if (code != CURLE_OK) {
    throw InputError(fmt::format("{}: {}", url, message[0] != '\0' ? message.data() : curl_easy_strerror(code)));
  }
  curl_off_t bytes = -1;
  curl_easy_getinfo(curl.get(), CURLINFO_CONTENT_LENGTH_DOWNLOAD_T, &bytes);
  if (bytes <= 0) {
    throw InputError(url + ": the server does not say how large the file is");
  }
  return bytes;
}

}  // namespace rds
