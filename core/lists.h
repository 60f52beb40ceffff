// Unsorted lists: whether they contain a value, and their quantiles.
#pragma once
#include <algorithm>
#include <cstddef>
#include <iterator>
#include <vector>

namespace umbrage {

/// Returns whether an element of `list` equals `value`.
bool contains(const auto& list, const auto& value) {
  return std::find(std::begin(list), std::end(list), value) != std::end(list);
}

/// Returns the element at a fraction of the sorted values, 0 to 1; 0 if there are none. Reorders the values.
template <class T>
T quantile_of_reordered(std::vector<T>& values, double fraction) {
  if (values.empty()) return T(0);
  const auto nth = values.begin() + std::ptrdiff_t(fraction * double(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

/// Returns the element at a fraction of the sorted values, 0 to 1; 0 if there are none.
template <class T>
T quantile(std::vector<T> values, double fraction) {
  return quantile_of_reordered(values, fraction);
}

}  // namespace umbrage
