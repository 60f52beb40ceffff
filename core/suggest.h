// "did you mean": the closest of several names.
#pragma once
#include <algorithm>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace umbrage {

/// Returns the number of letters inserted, deleted, changed or swapped with their neighbour between two words (optimal
/// string alignment distance).
inline int edit_distance(std::string_view a, std::string_view b) {
  std::vector<int> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = int(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1), last[j] + 1, row[j - 1] + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before.swap(last);
    last.swap(row);
  }
  return last.back();
}

/// Returns " (did you mean 'x'?)" for the closest of `names` if it is close, otherwise " (available: a, b, c)".
template <class Names>
std::string suggestion(std::string_view word, const Names& names) {
  constexpr int kMaxSlips = 2;  // more, or two in a word of up to four letters, is a different word
  int best = kMaxSlips + 1;
  std::string_view nearest;
  std::string all;
  for (std::string_view name : names) {
    const int distance = edit_distance(word, name);
    if (distance < best && distance <= std::max(1, (int(name.size()) - 1) / 2)) best = distance, nearest = name;
    all += (all.empty() ? "" : ", ") + std::string(name);
  }
  if (!nearest.empty()) return " (did you mean '" + std::string(nearest) + "'?)";
  return " (available: " + all + ")";
}

}  // namespace umbrage
