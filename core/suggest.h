// "did you mean": the nearest of some names.
#pragma once
#include <algorithm>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace umbrage {

/// Number of letters inserted, deleted or changed between two words (Levenshtein distance).
inline int edit_distance(std::string_view a, std::string_view b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    int diagonal = std::exchange(row[0], int(i) + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const int change = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = std::exchange(row[j + 1], std::min({change, row[j] + 1, row[j + 1] + 1}));
    }
  }
  return row.back();
}

/// " (did you mean 'x'?)" for the nearest of `names` if it is near, otherwise " (there are: a, b, c)".
template <class Names>
std::string suggestion(std::string_view word, const Names& names) {
  int best = 3;  // more than two slips is another word
  std::string_view nearest;
  std::string all;
  for (std::string_view name : names) {
    const int distance = edit_distance(word, name);
    if (distance < best && distance < int(name.size())) best = distance, nearest = name;
    all += (all.empty() ? "" : ", ") + std::string(name);
  }
  if (!nearest.empty()) return " (did you mean '" + std::string(nearest) + "'?)";
  return " (there are: " + all + ")";
}

}  // namespace umbrage
