// Lists of names in messages: "did you mean" for a misspelt word, and "a, b or c".
#pragma once
#include <algorithm>
#include <iterator>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.h"

namespace umbrage {

/// Returns the number of letters inserted, deleted, changed or swapped with their neighbour between two words (optimal
/// string alignment distance).
inline int edit_distance(std::string_view a, std::string_view b) {
  std::vector<int> previous_row(b.size() + 1), last_row(b.size() + 1), row(b.size() + 1);
  std::iota(last_row.begin(), last_row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = int(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last_row[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1), last_row[j] + 1, row[j - 1] + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], previous_row[j - 2] + 1);
    }
    previous_row.swap(last_row);
    last_row.swap(row);
  }
  return last_row.back();
}

/// Returns "a, b or c". `names` has a size and elements that convert to std::string_view.
template <class Names>
std::string joined_by_or(const Names& names) {
  std::string text;
  std::size_t k = 0;
  for (const std::string_view name : names) {
    text += k == 0 ? "" : k + 1 == std::size(names) ? " or " : ", ";
    text += name;
    ++k;
  }
  return text;
}

/// Returns the closest of `names` if it is close; otherwise "".
template <class Names>
std::string_view nearest_name(std::string_view word, const Names& names) {
  // A larger distance, or 2 for a name of up to four letters, means a different word.
  constexpr int kMaxEdits = 2;
  int best = kMaxEdits + 1;
  std::string_view nearest;
  for (const std::string_view name : names) {
    const int distance = edit_distance(word, name);
    if (distance < best && distance <= std::max(1, (int(name.size()) - 1) / 2)) best = distance, nearest = name;
  }
  return nearest;
}

/// Returns " (did you mean 'x'?)"; "" for an empty name.
inline std::string did_you_mean(std::string_view name) {
  return name.empty() ? "" : fmt::format(" (did you mean '{}'?)", name);
}

/// Returns " (did you mean 'x'?)" for the closest of `names` if it is close, otherwise " (available: a, b, c)".
template <class Names>
std::string suggestion(std::string_view word, const Names& names) {
  if (const std::string_view nearest = nearest_name(word, names); !nearest.empty()) return did_you_mean(nearest);
  std::string all;
  for (const std::string_view name : names) all += (all.empty() ? "" : ", ") + std::string(name);
  return " (available: " + all + ")";
}

/// Returns the error for a name that is none of `names`, which are those of a kind: "effect".
template <class Names>
Error unknown_name(std::string_view kind, std::string_view name, const Names& names) {
  return usage_error("there is no {} '{}'{}", kind, name, suggestion(name, names));
}

}  // namespace umbrage
