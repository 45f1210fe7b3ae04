// SPDX-License-Identifier: Apache-2.0
// Text files of rows and columns, as the TUM benchmark has them, read so that each error names file and line.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/file.h"

namespace rds {

// One row: its fields and the line it stands on, from 1.
struct TextRow {
  std::size_t line = 0;
  std::vector<std::string> fields;
};

// A file of rows. Lines end with \n, \r\n or \r. Fields are separated by blanks, tabs or commas; quotes around a field
// (also as Python prints lists and bytes: ['a'], b'a') are taken off, and blanks inside them belong to it. Empty lines
// and what follows a field that begins with # are left out.
struct TextTable {
  std::filesystem::path path;
  std::string heading;  // the first line if it does not begin with a number, else the last comment before the first row
  std::vector<TextRow> rows;

  // "path:line", for messages.
  [[nodiscard]] std::string Where(const TextRow& row) const;
  // The finite number in a column, else InputError: "path:line: tx is 'nan', not a finite number".
  [[nodiscard]] double Number(const TextRow& row, std::size_t column, const char* what) const;
};

// The number that a field is, NaN and infinity included; nothing for other words.
[[nodiscard]] std::optional<double> ParseNumber(const std::string& field);

// InputError if the file cannot be read or is UTF-16. A byte order mark is passed over.
TextTable ReadTextTable(const std::filesystem::path& path);

}  // namespace rds
