// SPDX-License-Identifier: Apache-2.0
#include "io/weights_fetch.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <iterator>
#include <mutex>
#include <thread>

#include "base/error.h"
#include "base/random.h"
#include "base/sha256.h"
#include "testing/file_size_limit.h"

namespace rds {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

// An HTTP server on 127.0.0.1 that serves one file and misbehaves as told; one connection at a time, on its own thread.
class LocalServer {
 public:
  struct Behavior {
    std::string body;
    bool ranges = true;               // answers Range with 206
    int status = 200;                 // other than 200: refuses with it
    std::vector<std::size_t> cuts{};  // the n-th answer ends after so many bytes of the body sent; later ones are whole
  };

  explicit LocalServer(Behavior behavior) : behavior_(std::move(behavior)) {
    listener_ = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    Check(bind(listener_, reinterpret_cast<sockaddr*>(&address), size) == 0, "no port");
    Check(getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) == 0, "no port");
    Check(listen(listener_, 8) == 0, "no port");
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { Serve(); });
  }
  ~LocalServer() {
    stopping_ = true;
    shutdown(listener_, SHUT_RDWR);
    thread_.join();
    close(listener_);
  }

  [[nodiscard]] std::string Url() const { return "http://127.0.0.1:" + std::to_string(port_) + "/files"; }
  // First byte asked for in each request so far, -1 = no Range.
  [[nodiscard]] std::vector<long> starts() const {
    const std::lock_guard lock(mutex_);
    return starts_;
  }

 private:
  void Serve() {
    for (;;) {
      const int connection = accept(listener_, nullptr, nullptr);
      if (connection < 0 || stopping_) {
        return;
      }
      Answer(connection);
      close(connection);
    }
  }

  void Answer(int connection) {
    std::string request;
    char block[1024];
    while (request.find("\r\n\r\n") == std::string::npos) {
      const ssize_t count = recv(connection, block, sizeof(block), 0);
      if (count <= 0) {
        return;
      }
      request.append(block, static_cast<std::size_t>(count));
    }
    const std::size_t range = request.find("Range: bytes=");
    const long start = range == std::string::npos ? -1 : std::stol(request.substr(range + 13));
    std::size_t number = 0;  // of this request
    {
      const std::lock_guard lock(mutex_);
      number = starts_.size();
      starts_.push_back(start);
    }
    Send(connection, Head(start));
    if (behavior_.status == 200 && !(behavior_.ranges && start >= Size())) {
      std::string rest = behavior_.body.substr(behavior_.ranges && start > 0 ? static_cast<std::size_t>(start) : 0);
      if (number < behavior_.cuts.size()) {
        rest.resize(std::min(rest.size(), behavior_.cuts[number]));
      }
      Send(connection, rest);
    }
  }

  [[nodiscard]] long Size() const { return static_cast<long>(behavior_.body.size()); }

  [[nodiscard]] std::string Head(long start) const {
    if (behavior_.status != 200) {
      return "HTTP/1.1 " + std::to_string(behavior_.status) + " No\r\nContent-Length: 0\r\nConnection: close\r\n\r\n";
    }
    if (behavior_.ranges && start >= Size()) {
      return "HTTP/1.1 416 Range Not Satisfiable\r\nContent-Length: 0\r\nConnection: close\r\n\r\n";
    }
    const bool partial = behavior_.ranges && start >= 0;
    std::string head = partial ? "HTTP/1.1 206 Partial Content\r\n" : "HTTP/1.1 200 OK\r\n";
    if (partial) {
      head += "Content-Range: bytes " + std::to_string(start) + "-" + std::to_string(Size() - 1) + "/" +
              std::to_string(Size()) + "\r\n";
    }
    return head + "Content-Length: " + std::to_string(partial ? Size() - start : Size()) +
           "\r\nConnection: close\r\n\r\n";
  }

  static void Send(int connection, const std::string& text) {
    std::size_t sent = 0;
    while (sent < text.size()) {
      const ssize_t count = send(connection, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
      if (count <= 0) {
        return;
      }
      sent += static_cast<std::size_t>(count);
    }
  }

  const Behavior behavior_;
  int listener_ = -1;
  int port_ = 0;
  std::atomic<bool> stopping_ = false;
  mutable std::mutex mutex_;
  std::vector<long> starts_;  // under mutex_
  std::thread thread_;
};

class WeightsFetchTest : public testing::Test {
 protected:
  void SetUp() override {
    Random random(7);
    for (int i = 0; i < 300'000; ++i) {
      body_ += static_cast<char>(random.Bits());
    }
    fs::create_directories(folder_);
    Write(folder_ / "reference", body_);
    digest_ = Sha256(folder_ / "reference");
    weights_ = {"test", "net.tflite", static_cast<std::int64_t>(body_.size()), digest_.c_str(), ""};
  }
  void TearDown() override { fs::remove_all(folder_); }

  static void Write(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }
  static std::string Read(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  }
  std::string Error(const std::string& url) const {
    try {
      FetchWeights(weights_, cache_, url, {});
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  const fs::path folder_ = fs::temp_directory_path() /
                           ("rds_fetch_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
  const fs::path cache_ = folder_ / "made" / "on the way";
  const fs::path file_ = cache_ / "net.tflite";
  const fs::path part_ = cache_ / "net.tflite.part";
  std::string body_;
  std::string digest_;
  PublishedWeights weights_{};
};

TEST_F(WeightsFetchTest, FetchesOnceWithProgress) {
  const LocalServer server({.body = body_});
  std::vector<std::int64_t> seen;
  const auto progress = [&](std::int64_t done, std::int64_t total) {
    EXPECT_EQ(total, weights_.bytes);
    seen.push_back(done);
  };
  EXPECT_EQ(FetchWeights(weights_, cache_, server.Url(), progress), file_);
  EXPECT_EQ(Read(file_), body_);
  EXPECT_FALSE(fs::exists(part_));
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_EQ(seen.back(), weights_.bytes);
  EXPECT_EQ(FetchWeights(weights_, cache_, server.Url(), {}), file_);
  EXPECT_THAT(server.starts(), ElementsAre(-1));  // the second time nothing was asked for
}

TEST_F(WeightsFetchTest, GoesOnAfterACutConnection) {
  const LocalServer server({.body = body_, .cuts = {100'000, 50'000}});
  FetchWeights(weights_, cache_, server.Url(), {});
  EXPECT_EQ(Read(file_), body_);
  EXPECT_THAT(server.starts(), ElementsAre(-1, 100'000, 150'000));
}

TEST_F(WeightsFetchTest, ALaterRunGoesOnFromWhatIsThere) {
  {
    const LocalServer server({.body = body_, .cuts = {1000, 1000, 1000, 1000}});
    EXPECT_THAT(Error(server.Url()), HasSubstr("3000 of 300000 bytes"));
  }
  EXPECT_FALSE(fs::exists(file_));
  EXPECT_EQ(Read(part_), body_.substr(0, 3000));
  const LocalServer server({.body = body_});
  FetchWeights(weights_, cache_, server.Url(), {});
  EXPECT_EQ(Read(file_), body_);
  EXPECT_THAT(server.starts(), ElementsAre(3000));
}

TEST_F(WeightsFetchTest, StartsOverWhereTheServerCannotGoOn) {
  fs::create_directories(cache_);
  Write(part_, body_.substr(0, 3000));
  const LocalServer server({.body = body_, .ranges = false});
  FetchWeights(weights_, cache_, server.Url(), {});
  EXPECT_EQ(Read(file_), body_);
  EXPECT_THAT(server.starts(), ElementsAre(3000, -1));
}

TEST_F(WeightsFetchTest, RefusesAndRemovesAWrongDigest) {
  std::string other = body_;
  other[5] = static_cast<char>(other[5] ^ 1);
  const LocalServer server({.body = other});
  const std::string error = Error(server.Url());
  EXPECT_THAT(error, HasSubstr(server.Url() + "/net.tflite"));
  EXPECT_THAT(error, HasSubstr(digest_));
  EXPECT_THAT(error, HasSubstr(file_.string()));  // how to place it by hand
  EXPECT_FALSE(fs::exists(part_));
  EXPECT_FALSE(fs::exists(file_));
}

TEST_F(WeightsFetchTest, RefusesFilesOfAnotherLength) {
  {
    const LocalServer server({.body = body_ + "more"});
    EXPECT_THAT(Error(server.Url()), HasSubstr("longer"));
    EXPECT_FALSE(fs::exists(part_));
  }
  const LocalServer server({.body = body_.substr(0, 2000)});
  EXPECT_THAT(Error(server.Url()), HasSubstr("2000 bytes, but 300000"));
  EXPECT_FALSE(fs::exists(file_));
  // The next run finds that the server has no more, and does not wait for it.
  EXPECT_THAT(Error(server.Url()), HasSubstr("2000 bytes, but 300000"));
}

TEST_F(WeightsFetchTest, ReplacesADamagedFile) {
  fs::create_directories(cache_);
  Write(file_, body_.substr(0, 10));
  const LocalServer server({.body = body_});
  FetchWeights(weights_, cache_, server.Url(), {});
  EXPECT_EQ(Read(file_), body_);
}

TEST_F(WeightsFetchTest, RefusalsAreNotRetried) {
  const LocalServer server({.body = body_, .status = 404});
  const std::string error = Error(server.Url());
  EXPECT_THAT(error, HasSubstr("404"));
  EXPECT_THAT(error, HasSubstr("by hand"));
  EXPECT_FALSE(fs::exists(part_));
  EXPECT_EQ(server.starts().size(), 1U);
}

TEST_F(WeightsFetchTest, NoNetworkNamesUrlAndTheWayByHand) {
  std::string url;
  {
    const LocalServer server({.body = body_});
    url = server.Url();
  }
  const std::string error = Error(url);  // nobody listens there any more
  EXPECT_THAT(error, HasSubstr(url + "/net.tflite"));
  EXPECT_THAT(error, HasSubstr(file_.string()));
  EXPECT_THAT(Error("file:///etc"), HasSubstr("file:///etc/net.tflite"));
}

TEST_F(WeightsFetchTest, AFullDiskIsNamed) {
  const LocalServer server({.body = body_});
  const FileSizeLimit limit(static_cast<rlim_t>(body_.size() / 2));
  EXPECT_THAT(Error(server.Url()), HasSubstr("disk full"));
  EXPECT_FALSE(fs::exists(file_));
}

TEST_F(WeightsFetchTest, WritesThroughNoLinkAndIntoNothingOfOthers) {
  fs::create_directories(cache_);
  const fs::path elsewhere = cache_ / "elsewhere";
  Write(elsewhere, "untouched");
  fs::create_symlink(elsewhere, part_);
  const LocalServer server({.body = body_});
  EXPECT_THAT(Error(server.Url()), HasSubstr("it is a link; remove it"));
  fs::remove(part_);
  fs::create_hard_link(elsewhere, part_);
  EXPECT_THAT(Error(server.Url()), HasSubstr("no file of ours"));
  EXPECT_EQ(Read(elsewhere), "untouched");
}

TEST_F(WeightsFetchTest, ACaptivePortalsPageDoesNotPoisonTheNextTry) {
  {
    const LocalServer portal({.body = "<html>Please log in</html>"});
    EXPECT_THAT(Error(portal.Url()), HasSubstr("a login page"));
  }
  EXPECT_FALSE(fs::exists(part_));
  const LocalServer server({.body = body_});
  EXPECT_EQ(Error(server.Url()), "no error");
  EXPECT_TRUE(fs::exists(file_));
}

TEST_F(WeightsFetchTest, BlanksInFileUrlsAreEscaped) {
  const fs::path folder = cache_.parent_path() / "a folder";
  fs::create_directories(folder);
  Write(folder / file_.filename(), body_);
  EXPECT_EQ(Error("file://" + folder.string()), "no error");
  EXPECT_TRUE(fs::exists(file_));
}

TEST_F(WeightsFetchTest, AFolderThatCannotBeMadeIsNamed) {
  fs::create_directories(cache_.parent_path());
  Write(cache_, "a file where the folder should be");
  EXPECT_THAT(Error("http://127.0.0.1:1"), HasSubstr(cache_.string()));
}

}  // namespace
}  // namespace rds
