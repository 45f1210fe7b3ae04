// SPDX-License-Identifier: Apache-2.0
#include "io/text_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "base/error.h"

namespace rds {
namespace {

// Takes off what Python prints around words: ['a'], b'a', "a".
std::string Bare(std::string_view field) {
  if (field.size() >= 4 && field.front() == '[' && field.back() == ']' && (field[1] == '\'' || field[1] == '"')) {
    field = field.substr(1, field.size() - 2);
  }
  if (field.size() >= 3 && field.front() == 'b' && (field[1] == '\'' || field[1] == '"') && field.back() == field[1]) {
    field.remove_prefix(1);
  }
  if (field.size() >= 2 && (field.front() == '\'' || field.front() == '"') && field.back() == field.front()) {
    field = field.substr(1, field.size() - 2);
  }
  return std::string(field);
}

std::vector<std::string> Split(std::string_view line) {
  constexpr std::string_view kSeparators = " \t,";
  std::vector<std::string> fields;
  std::size_t begin = line.find_first_not_of(kSeparators);
  while (begin != std::string_view::npos) {
    std::size_t end = std::min(line.find_first_of(kSeparators, begin), line.size());
    if (line[begin] == '"') {  // up to the closing quote, if there is one
      const std::size_t quote = line.find('"', begin + 1);
      end = quote == std::string_view::npos ? end : std::max(end, quote + 1);
    }
    fields.push_back(Bare(line.substr(begin, end - begin)));
    begin = line.find_first_not_of(kSeparators, end);
  }
  return fields;
}

bool BeginsWithNumber(const TextRow& row) { return ParseNumber(row.fields.front()).has_value(); }

}  // namespace

std::optional<double> ParseNumber(const std::string& field) {
  const char* begin = field.data() + (field.size() > 1 && field.front() == '+' ? 1 : 0);
  const char* end = field.data() + field.size();
  double value = 0;
  const auto [stop, error] = std::from_chars(begin, end, value);
  return error == std::errc{} && stop == end ? std::optional(value) : std::nullopt;
}

TextTable ReadTextTable(const std::filesystem::path& path) {
  TextTable table{path, {}, {}};
  const std::string text = ReadFile(path);
  std::string_view rest = text;
  if (rest.starts_with("\xFF\xFE") || rest.starts_with("\xFE\xFF")) {
    throw InputError(path.string() + ": written in UTF-16; save it as UTF-8 or plain text");
  }
  if (rest.starts_with("\xEF\xBB\xBF")) {
    rest.remove_prefix(3);
  }
  std::string first_line;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find_first_of("\r\n"), rest.size());
    const std::string_view line = rest.substr(0, end);
    std::vector<std::string> fields = Split(line);
    const auto comment = std::ranges::find_if(fields, [](const std::string& field) { return field.starts_with('#'); });
    if (table.rows.empty() && comment == fields.begin() && comment != fields.end()) {
      table.heading = line.substr(line.find('#') + 1);
    }
    fields.erase(comment, fields.end());
    if (!fields.empty()) {
      if (table.rows.empty() && !ParseNumber(fields.front())) {
        first_line = line;
      }
      table.rows.push_back({number, std::move(fields)});
    }
    rest.remove_prefix(std::min(end + (rest.substr(end).starts_with("\r\n") ? 2 : 1), rest.size()));
  }
  if (table.rows.size() > 1 && !BeginsWithNumber(table.rows[0]) && BeginsWithNumber(table.rows[1])) {
    table.heading = first_line;
    table.rows.erase(table.rows.begin());
  }
  return table;
}

std::string TextTable::Where(const TextRow& row) const { return path.string() + ":" + std::to_string(row.line); }

double TextTable::Number(const TextRow& row, std::size_t column, const char* what) const {
  const std::string& field = row.fields.at(column);
  const std::optional<double> value = ParseNumber(field);
  if (!value || !std::isfinite(*value)) {
    throw InputError(Where(row) + ": " + what + " is '" + field + "', not a finite number");
  }
  return *value;
}

}  // namespace rds
