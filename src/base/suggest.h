// SPDX-License-Identifier: Apache-2.0
// "Did you mean ...?": the known word that is nearest to a mistyped one.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rds {

// Edits (insert, delete, replace, swap of neighbors) that turn `a` into `b`; bytes, case-sensitive.
int EditDistance(std::string_view a, std::string_view b);

// The known word with the fewest edits from `word`, ignoring case, if near enough to be meant (a third of the longer
// word at most, at least two edits for words of five letters or more), or if one begins with the other. First of
// equals.
std::optional<std::string> NearestWord(std::string_view word, std::span<const std::string> known);

// " (did you mean 'x'?)", or "" where nothing is near: to be appended to an error message.
std::string Suggestion(std::string_view word, std::span<const std::string> known);

}  // namespace rds
