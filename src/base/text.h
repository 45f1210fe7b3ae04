// SPDX-License-Identifier: Apache-2.0
// Small things about text.
#pragma once

#include <string_view>

namespace rds {

// Without blanks, tabs and line ends at either side. A view of the same characters.
[[nodiscard]] inline std::string_view Trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kBlanks);
  return begin == std::string_view::npos ? std::string_view{}
                                         : text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
}

// The last line that is not blank, trimmed; of foreign errors and logs the one that says something.
[[nodiscard]] inline std::string_view LastLine(std::string_view text) {
  text = Trimmed(text);
  const std::size_t line = text.rfind('\n');
  return Trimmed(line == std::string_view::npos ? text : text.substr(line + 1));
}

}  // namespace rds
