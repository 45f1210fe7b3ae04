// SPDX-License-Identifier: Apache-2.0
// A table of named, bounded and explained options, bound to the variables that hold them.
#pragma once

#include <cstddef>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rds {

// One option: dotted key ("orb.features"), what it means (with its unit), the values it takes, and access to the bound
// variable as text.
struct OptionEntry {
  std::string key;
  std::string meaning;
  std::string range;                            // "100 .. 10000", "true or false", "front, back or newest", "text"
  bool is_text = false;                         // free text: a YAML writer may have to quote it
  std::function<std::string()> get;             // reads back exactly: shortest digits that give the same number
  std::function<void(const std::string&)> set;  // throws InputError naming key, value and range
};

// Built line by line; the bound variables must outlive it. Not thread-safe.
class OptionTable {
 public:
  void Flag(std::string key, bool& value, std::string meaning);
  // Both bounds belong to the range.
  void Int(std::string key, int& value, int min, int max, std::string meaning);
  void Real(std::string key, double& value, double min, double max, std::string meaning);
  void Text(std::string key, std::string& value, std::string meaning);
  // One of a few names, each standing for a value of an enumeration.
  template <typename Enum>
  void Choice(std::string key, Enum& value, std::initializer_list<std::pair<std::string, Enum>> choices,
              std::string meaning);

  [[nodiscard]] const std::vector<OptionEntry>& entries() const& { return entries_; }
  const std::vector<OptionEntry>& entries() const&& = delete;  // would dangle
  // The entry of a key; throws InputError that names the nearest key if there is none.
  [[nodiscard]] const OptionEntry& Find(std::string_view key) const;

 private:
  // Throws InvariantError if the key is there already.
  void Add(OptionEntry entry);
  void AddChoice(std::string key, std::vector<std::string> names, std::function<std::size_t()> get,
                 std::function<void(std::size_t)> set, std::string meaning);

  std::vector<OptionEntry> entries_;
};

template <typename Enum>
void OptionTable::Choice(std::string key, Enum& value, std::initializer_list<std::pair<std::string, Enum>> choices,
                         std::string meaning) {
  std::vector<std::string> names;
  std::vector<Enum> values;
  for (const auto& [name, choice] : choices) {
    names.push_back(name);
    values.push_back(choice);
  }
  const auto get = [&value, values] {
    std::size_t index = 0;
    while (index < values.size() && values[index] != value) {
      ++index;
    }
    return index;
  };
  const auto set = [&value, values](std::size_t index) { value = values[index]; };
  AddChoice(std::move(key), std::move(names), get, set, std::move(meaning));
}

}  // namespace rds
