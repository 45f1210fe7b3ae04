// SPDX-License-Identifier: Apache-2.0
#include "system/option_table.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <system_error>

#include "base/error.h"
#include "base/suggest.h"

namespace rds {
namespace {

// The whole text as a number, or nothing.
template <typename Number>
std::optional<Number> Parse(const std::string& text) {
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || rest != end) {
    return std::nullopt;
  }
  return number;
}

[[noreturn]] void ThrowBadValue(const std::string& key, const std::string& text, const std::string& wanted) {
  throw InputError(fmt::format("option {}: '{}' is not {}", key, text, wanted));
}

template <typename Number>
OptionEntry NumberEntry(std::string key, Number& value, Number min, Number max, std::string meaning,
                        const std::string& kind) {
  OptionEntry entry;
  entry.range = fmt::format("{} .. {}", min, max);
  entry.get = [&value] { return fmt::format("{}", value); };
  entry.set = [&value, min, max, key, kind, range = entry.range](const std::string& text) {
    const std::optional<Number> number = Parse<Number>(text);
    if (!number) {
      ThrowBadValue(key, text, kind + "; range " + range);
    }
    if (!(*number >= min && *number <= max)) {
      throw InputError(fmt::format("option {}: {} is out of range; range {}", key, text, range));
    }
    value = *number;
  };
  entry.key = std::move(key);
  entry.meaning = std::move(meaning);
  return entry;
}

// "a, b or c"
std::string Enumerate(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    text += i == 0 ? "" : i + 1 == names.size() ? " or " : ", ";
    text += names[i];
  }
  return text;
}

}  // namespace

void OptionTable::Add(OptionEntry entry) {
  const bool is_new = std::none_of(entries_.begin(), entries_.end(),
                                   [&entry](const OptionEntry& other) { return other.key == entry.key; });
  Check(is_new, "an option's key is there twice");
  entries_.push_back(std::move(entry));
}

void OptionTable::Flag(std::string key, bool& value, std::string meaning) {
  OptionEntry entry;
  entry.range = "true or false";
  entry.get = [&value] { return std::string(value ? "true" : "false"); };
  entry.set = [&value, key](const std::string& text) {
    if (text != "true" && text != "false") {
      ThrowBadValue(key, text, "true or false");
    }
    value = text == "true";
  };
  entry.key = std::move(key);
  entry.meaning = std::move(meaning);
  Add(std::move(entry));
}

void OptionTable::Int(std::string key, int& value, int min, int max, std::string meaning) {
  Add(NumberEntry(std::move(key), value, min, max, std::move(meaning), "a whole number"));
}

void OptionTable::Real(std::string key, double& value, double min, double max, std::string meaning) {
  Add(NumberEntry(std::move(key), value, min, max, std::move(meaning), "a number"));
}

void OptionTable::Text(std::string key, std::string& value, std::string meaning) {
  OptionEntry entry;
  entry.key = std::move(key);
  entry.meaning = std::move(meaning);
  entry.range = "text";
  entry.is_text = true;
  entry.get = [&value] { return value; };
  entry.set = [&value](const std::string& text) { value = text; };
  Add(std::move(entry));
}

void OptionTable::AddChoice(std::string key, std::vector<std::string> names, std::function<std::size_t()> get,
                            std::function<void(std::size_t)> set, std::string meaning) {
  OptionEntry entry;
  entry.range = Enumerate(names);
  entry.get = [names, get = std::move(get)] {
    const std::size_t index = get();
    Check(index < names.size(), "an enumeration's value has no name");
    return names[index];
  };
  entry.set = [names, set = std::move(set), key, range = entry.range](const std::string& text) {
    const auto found = std::find(names.begin(), names.end(), text);
    if (found == names.end()) {
      ThrowBadValue(key, text, range);
    }
    set(static_cast<std::size_t>(found - names.begin()));
  };
  entry.key = std::move(key);
  entry.meaning = std::move(meaning);
  Add(std::move(entry));
}

const OptionEntry& OptionTable::Find(std::string_view key) const {
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [key](const OptionEntry& entry) { return entry.key == key; });
  if (found != entries_.end()) {
    return *found;
  }
  std::vector<std::string> keys;
  for (const OptionEntry& entry : entries_) {
    keys.push_back(entry.key);
  }
  throw InputError(fmt::format("unknown option '{}'{}; `rds config` lists all", key, Suggestion(key, keys)));
}

}  // namespace rds
