// SPDX-License-Identifier: Apache-2.0
#include "base/strict_yaml.h"

#include <spdlog/fmt/fmt.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/file.h"

namespace rds {
namespace {

constexpr std::size_t kMostBytes = 1'000'000;
constexpr std::size_t kMostDepth = 16;
constexpr int kMostValues = 20'000;

// Counts while the file is parsed and stops it where it goes too far, before anything is built from it.
class Guard final : public YAML::EventHandler {
 public:
  explicit Guard(const std::filesystem::path& path) : path_(path) {}

  void OnDocumentStart(const YAML::Mark& /*mark*/) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override { Value(mark, ""); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override {
    Refuse(mark, "an alias ('*name') is not taken here; write the value out");
  }
  void OnScalar(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                const std::string& value) override {
    Value(mark, value);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                       YAML::EmitterStyle::value /*style*/) override {
    Open(mark, false);
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value /*style*/) override {
    Open(mark, true);
  }
  void OnMapEnd() override { open_.pop_back(); }

 private:
  struct Level {
    bool is_map = false;
    bool key_next = true;
    std::set<std::string> keys{};
  };

  [[noreturn]] void Refuse(const YAML::Mark& mark, const std::string& what) const {
    throw InputError(fmt::format("{}:{}: {}", path_.string(), mark.line + 1, what));
  }
  void Count(const YAML::Mark& mark) {
    if (++values_ > kMostValues) {
      Refuse(mark, fmt::format("more than {} values; this is no file of options or of a camera", kMostValues));
    }
  }
  void Value(const YAML::Mark& mark, const std::string& text) {
    Count(mark);
    if (open_.empty() || !open_.back().is_map) {
      return;
    }
    Level& level = open_.back();
    if (level.key_next && !level.keys.insert(text).second) {
      Refuse(mark, "'" + text + "' stands there twice");
    }
    level.key_next = !level.key_next;
  }
  void Open(const YAML::Mark& mark, bool is_map) {
    Count(mark);
    if (!open_.empty() && open_.back().is_map) {
      if (open_.back().key_next) {
        Refuse(mark, "the name before ':' must be a word");
      }
      open_.back().key_next = true;
    }
    if (open_.size() >= kMostDepth) {
      Refuse(mark, fmt::format("nested deeper than {} levels", kMostDepth));
    }
    open_.push_back({.is_map = is_map});
  }

  const std::filesystem::path& path_;
  std::vector<Level> open_;
  int values_ = 0;
};

std::string WithoutOpenCvHead(std::string text) {
  constexpr std::string_view kBom = "\xEF\xBB\xBF";
  if (text.starts_with(kBom)) {
    text.erase(0, kBom.size());
  }
  if (text.starts_with("%YAML:")) {
    text[0] = '#';  // a comment; lines keep their numbers
  }
  return text;
}

}  // namespace

YAML::Node ReadStrictYaml(const std::filesystem::path& path) {
  const std::string text = WithoutOpenCvHead(ReadFile(path, kMostBytes));
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    Guard guard(path);
    while (parser.HandleNextDocument(guard)) {
    }
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    for (std::size_t i = 1; i < documents.size(); ++i) {
      if (!documents[i].IsNull()) {  // an end mark with nothing after it is no document
        throw InputError(fmt::format("{}: a second document begins; one is wanted", WhereInYaml(path, documents[i])));
      }
    }
    return documents.empty() ? YAML::Node() : documents.front();
  } catch (const YAML::Exception& error) {
    throw InputError(fmt::format("{}:{}: not YAML: {}", path.string(), error.mark.line + 1, error.msg));
  }
}

std::string WhereInYaml(const std::filesystem::path& path, const YAML::Node& node) {
  return fmt::format("{}:{}", path.string(), node.Mark().line + 1);
}

}  // namespace rds
