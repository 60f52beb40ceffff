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

/// What other programs call an option or a parameter, with "-" for "_", and the name that it has here. The Python
/// package has the file beside its code.
inline constexpr std::pair<std::string_view, std::string_view> kOtherNames[] = {
#include "other_names.inc"
};

/// Returns whether `word` is a part of `name` between dashes, underscores or dots.
inline bool is_part_of_name(std::string_view word, std::string_view name) {
  constexpr std::string_view kSeparators = "-_.";
  for (std::size_t begin = 0; begin <= name.size();) {
    const std::size_t end = std::min(name.find_first_of(kSeparators, begin), name.size());
    if (!word.empty() && name.substr(begin, end - begin) == word) return true;
    begin = end + 1;
  }
  return false;
}

/// Returns the one of `names` that is meant by a word: the closest if it is close; else a name of kOtherNames; else the
/// shortest of which the word is a part; otherwise "".
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
  if (!nearest.empty()) return nearest;
  std::string with_dashes(word);
  std::replace(with_dashes.begin(), with_dashes.end(), '_', '-');
  for (const auto& [other, own] : kOtherNames)
    for (const std::string_view name : names)
      if (other == with_dashes && own == name) return name;
  for (const std::string_view name : names)
    if (is_part_of_name(with_dashes, name) && (nearest.empty() || name.size() < nearest.size())) nearest = name;
  return nearest;
}

/// Returns " (did you mean 'x'?)"; "" for an empty name.
inline std::string did_you_mean(std::string_view name) {
  return name.empty() ? "" : fmt::format(" (did you mean '{}'?)", name);
}

/// Returns " (did you mean 'x'?)" for the one of `names` that is meant, otherwise " (available: a, b, c)".
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
