#include "io/text_table.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>

#include "base/error.h"

namespace rds {
namespace {

std::vector<std::string> Split(std::string_view line) {
  constexpr std::string_view kSeparators = " \t,\r";
  std::vector<std::string> fields;
  std::size_t begin = line.find_first_not_of(kSeparators);
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(kSeparators, begin), line.size());
    fields.emplace_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kSeparators, end);
  }
  return fields;
}

}  // namespace

std::string ReadFile(const std::filesystem::path& path) {
  const auto fail = [&path]() -> InputError {
    return InputError(path.string() + ": cannot be read: " + std::strerror(errno));
  };
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) {
    throw fail();
  }
  std::string text;
  struct stat status {};
  if (fstat(file, &status) == 0 && status.st_size > 0) {
    text.reserve(static_cast<std::size_t>(status.st_size) + 1);
  }
  for (;;) {
    const std::size_t size = text.size();
    text.resize(std::max(size + 4096, text.capacity()));
    const ssize_t count = read(file, text.data() + size, text.size() - size);
    text.resize(size + static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    if (count == 0) {
      break;
    }
    if (count < 0 && errno != EINTR) {
      const InputError error = fail();
      close(file);
      throw error;
    }
  }
  close(file);
  return text;
}

TextTable ReadTextTable(const std::filesystem::path& path) {
  TextTable table{path, {}};
  const std::string text = ReadFile(path);
  std::string_view rest = text;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::vector<std::string> fields = Split(rest.substr(0, end));
    if (!fields.empty() && fields.front().front() != '#') {
      table.rows.push_back({number, std::move(fields)});
    }
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return table;
}

std::string TextTable::Where(const TextRow& row) const { return path.string() + ":" + std::to_string(row.line); }

double TextTable::Number(const TextRow& row, std::size_t column, const char* what) const {
  const std::string& field = row.fields.at(column);
  const char* begin = field.data() + (field.size() > 1 && field.front() == '+' ? 1 : 0);
  const char* end = field.data() + field.size();
  double value = 0;
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error != std::errc{} || stop != end || !std::isfinite(value)) {
    throw InputError(Where(row) + ": " + what + " is '" + field + "', not a finite number");
  }
  return value;
}

}  // namespace rds
