// Text files of rows and columns, as the TUM benchmark has them, read so that each error names file and line.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace rds {

// One row: its fields and the line it stands on, from 1.
struct TextRow {
  std::size_t line = 0;
  std::vector<std::string> fields;
};

// A file of rows. Fields are separated by blanks, tabs or commas; empty lines and lines that begin with # are left out.
struct TextTable {
  std::filesystem::path path;
  std::vector<TextRow> rows;

  // "path:line", for messages.
  [[nodiscard]] std::string Where(const TextRow& row) const;
  // The finite number in a column, else InputError: "path:line: tx is 'nan', not a finite number".
  [[nodiscard]] double Number(const TextRow& row, std::size_t column, const char* what) const;
};

// InputError if the file cannot be read.
TextTable ReadTextTable(const std::filesystem::path& path);

// All bytes of a file; InputError naming it and the system's reason if it cannot be read.
std::string ReadFile(const std::filesystem::path& path);

}  // namespace rds
