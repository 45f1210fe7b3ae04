// SPDX-License-Identifier: Apache-2.0
#include "io/trajectory_columns.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>
#include <vector>

namespace rds {
namespace {

// Lower-case letters and digits only.
std::string Plain(const std::string& word) {
  std::string plain;
  for (const char c : word) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  return plain;
}

// Its place among timestamp tx ty tz qx qy qz qw; -1 if it is none of them.
int Meaning(const std::string& word) {
  if (word.starts_with("time") || word == "t" || word == "stamp") {
    return 0;
  }
  if (word.empty()) {
    return -1;
  }
  const std::size_t axis = std::string_view("xyzw").find(word.back());
  const bool rotation = word.front() == 'q';
  const bool position = word.size() == 1 || word.starts_with("p") || word.starts_with("t");
  if (axis == std::string_view::npos || (!rotation && (!position || axis == 3))) {
    return -1;
  }
  return static_cast<int>(axis) + (rotation ? 4 : 1);
}

// The names in a heading: between commas, or between blanks where there is no comma. Units in brackets are no part of
// them.
std::vector<std::string> NamesIn(const std::string& heading) {
  std::string names;
  int depth = 0;
  for (const char c : heading) {
    depth += c == '[' || c == '(' ? 1 : 0;
    if (depth == 0) {
      names += c;
    }
    depth -= c == ']' || c == ')' ? 1 : 0;
  }
  const std::string separators = names.find(',') == std::string::npos ? " \t" : ",";
  std::vector<std::string> result;
  std::size_t begin = names.find_first_not_of(separators);
  while (begin != std::string::npos) {
    const std::size_t end = std::min(names.find_first_of(separators, begin), names.size());
    result.push_back(Plain(names.substr(begin, end - begin)));
    begin = names.find_first_not_of(separators, end);
  }
  return result;
}

std::optional<PoseColumns> ByHeading(const std::string& heading) {
  PoseColumns columns{};
  std::array<bool, 8> found{};
  const std::vector<std::string> names = NamesIn(heading);
  for (std::size_t column = 0; column < names.size(); ++column) {
    if (const int meaning = Meaning(names[column]); meaning >= 0) {
      const auto place = static_cast<std::size_t>(meaning);
      if (found[place]) {
        return std::nullopt;  // named twice: not certain
      }
      found[place] = true;
      columns[place] = column;
    }
  }
  return std::ranges::all_of(found, [](bool f) { return f; }) ? std::optional(columns) : std::nullopt;
}

bool FirstColumnCounts(const TextTable& table) {
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const auto number = ParseNumber(table.rows[i].fields.front());
    const auto first = ParseNumber(table.rows.front().fields.front());
    if (!number || !first || *number != *first + static_cast<double>(i) || *first < 0 || *first > 1) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::optional<PoseColumns> FindPoseColumns(const TextTable& table) {
  const std::size_t count = table.rows.front().fields.size();
  if (const auto columns = ByHeading(table.heading); columns && *std::ranges::max_element(*columns) < count) {
    return columns;
  }
  if (count == 8) {
    return PoseColumns{0, 1, 2, 3, 4, 5, 6, 7};
  }
  if (count == 9 && FirstColumnCounts(table)) {
    return PoseColumns{1, 2, 3, 4, 5, 6, 7, 8};
  }
  return std::nullopt;
}

}  // namespace rds
