// SPDX-License-Identifier: Apache-2.0
#include "io/options_yaml.h"

#include <spdlog/fmt/fmt.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <set>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/strict_yaml.h"
#include "system/option_binding.h"

namespace rds {
namespace {

// Reads one file into one table.
class Reader {
 public:
  Reader(const std::filesystem::path& file, const OptionTable& table) : file_(file), table_(table) {}

  void ReadMap(const YAML::Node& map, const std::string& prefix) {
    for (const auto& item : map) {
      const std::string key = prefix + item.first.Scalar();
      if (IsGroup(key) && (item.second.IsMap() || item.second.IsNull())) {
        ReadMap(item.second, key + ".");
      } else {
        ReadValue(item.first, item.second, key);
      }
    }
  }

  [[noreturn]] void Throw(const YAML::Node& where, const std::string& what) const {
    throw InputError(WhereInYaml(file_, where) + ": " + what);
  }

 private:
  void ReadValue(const YAML::Node& name, const YAML::Node& value, const std::string& key) {
    if (IsGroup(key)) {
      Throw(name, fmt::format("'{}' is a group of options, not an option; `rds config` lists all", key));
    }
    try {
      const OptionEntry& option = table_.Find(key);
      const bool is_list = value.IsSequence() && option.is_text;
      if (!value.IsScalar() && !is_list) {
        throw InputError(fmt::format("option {}: expected one value", key));
      }
      if (!seen_.insert(key).second) {
        throw InputError(fmt::format("option {} is given twice", key));
      }
      option.set(is_list ? JoinedList(value) : value.Scalar());
    } catch (const InputError& error) {
      Throw(name, error.what());
    }
  }

  // A text option that holds several words may be given as a list.
  [[nodiscard]] static std::string JoinedList(const YAML::Node& list) {
    std::string words;
    for (const auto& word : list) {
      if (!word.IsScalar()) {
        throw InputError("a list of words is wanted");
      }
      words += (words.empty() ? "" : ", ") + word.Scalar();
    }
    return words;
  }

  [[nodiscard]] bool IsGroup(const std::string& key) const {
    const std::string prefix = key + ".";
    return std::any_of(table_.entries().begin(), table_.entries().end(),
                       [&prefix](const OptionEntry& entry) { return entry.key.starts_with(prefix); });
  }

  const std::filesystem::path& file_;
  const OptionTable& table_;
  std::set<std::string> seen_;
};

std::vector<std::string> SplitKey(std::string_view key) {
  std::vector<std::string> parts;
  while (true) {
    const std::size_t dot = key.find('.');
    parts.emplace_back(key.substr(0, dot));
    if (dot == std::string_view::npos) {
      return parts;
    }
    key.remove_prefix(dot + 1);
  }
}

std::string YamlScalar(const OptionEntry& entry) {
  if (!entry.is_text) {
    return entry.get();
  }
  YAML::Emitter emitter;
  emitter << YAML::DoubleQuoted << entry.get();
  return emitter.c_str();
}

// Walks the table in its order; `comment` gives the lines to put before an entry (may be empty).
template <typename Comment>
std::string Write(const OptionTable& table, Comment&& comment) {
  std::string text;
  std::vector<std::string> open;  // groups around the last entry
  for (const OptionEntry& entry : table.entries()) {
    const std::vector<std::string> parts = SplitKey(entry.key);
    const std::size_t groups = parts.size() - 1;
    const auto same = static_cast<std::size_t>(
        std::mismatch(open.begin(), open.end(), parts.begin(), parts.end() - 1).first - open.begin());
    for (std::size_t i = same; i < groups; ++i) {
      text += std::string(2 * i, ' ') + parts[i] + ":\n";
    }
    open.assign(parts.begin(), parts.end() - 1);
    const std::string indent(2 * groups, ' ');
    for (const std::string& line : comment(entry)) {
      text += indent + "# " + line + "\n";
    }
    text += indent + parts.back() + ": " + YamlScalar(entry) + "\n";
  }
  return text;
}

}  // namespace

void ApplyOptionsFile(const std::filesystem::path& file, Options& options) {
  const OptionTable table = BindOptions(options);
  Reader reader(file, table);
  const YAML::Node root = ReadStrictYaml(file);
  if (root.IsNull()) {
    return;
  }
  if (!root.IsMap()) {
    reader.Throw(root, "expected options as 'name: value'; `rds config` prints an example");
  }
  reader.ReadMap(root, "");
}

std::string OptionsYaml(const Options& options) {
  Options copy = options;
  return Write(BindOptions(copy), [](const OptionEntry&) { return std::vector<std::string>{}; });
}

std::string DocumentedOptionsYaml(const Options& options) {
  Options copy = options;
  Options defaults;
  const OptionTable default_table = BindOptions(defaults);
  return Write(BindOptions(copy), [&default_table](const OptionEntry& entry) {
    const OptionEntry& fallback = default_table.Find(entry.key);
    return std::vector<std::string>{entry.meaning, fmt::format("{}; default {}", entry.range, YamlScalar(fallback))};
  });
}

}  // namespace rds
