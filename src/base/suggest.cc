// SPDX-License-Identifier: Apache-2.0
#include "base/suggest.h"

#include <algorithm>
#include <cctype>
#include <numeric>

namespace rds {
namespace {

std::string LowerCase(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

int Tolerance(std::size_t a, std::size_t b) {
  const std::size_t longer = std::max(a, b);
  return static_cast<int>(std::max(longer / 3, longer >= 5 ? std::size_t{2} : std::size_t{1}));
}

}  // namespace

// Optimal string alignment: Damerau-Levenshtein in which no piece is edited twice.
int EditDistance(std::string_view a, std::string_view b) {
  std::vector<int> before_last(b.size() + 1);
  std::vector<int> last(b.size() + 1);
  std::vector<int> current(b.size() + 1);
  std::iota(last.begin(), last.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    current[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      current[j] = std::min({last[j] + 1, current[j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        current[j] = std::min(current[j], before_last[j - 2] + 1);
      }
    }
    std::swap(before_last, last);
    std::swap(last, current);
  }
  return last[b.size()];
}

std::optional<std::string> NearestWord(std::string_view word, std::span<const std::string> known) {
  const std::string wanted = LowerCase(word);
  std::optional<std::string> nearest;
  int fewest = 0;
  for (const std::string& candidate : known) {
    const std::string lower = LowerCase(candidate);
    int edits = EditDistance(wanted, lower);
    if (wanted.size() >= 3 && (lower.starts_with(wanted) || wanted.starts_with(lower))) {
      edits = std::min(edits, 1);
    }
    if (edits <= Tolerance(wanted.size(), lower.size()) && (!nearest || edits < fewest)) {
      nearest = candidate;
      fewest = edits;
    }
  }
  return nearest;
}

std::string Suggestion(std::string_view word, std::span<const std::string> known) {
  const std::optional<std::string> nearest = NearestWord(word, known);
  return nearest ? " (did you mean '" + *nearest + "'?)" : "";
}

}  // namespace rds
