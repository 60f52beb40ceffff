// Functions shared by the registries of effects and looks: lists of named entries.
#pragma once
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "core/suggest.h"

namespace umbrage {

/// Returns pointers to the entries of a list, which must outlive the result.
template <class Entry, std::size_t count>
std::vector<const Entry*> pointers_to(const Entry (&list)[count]) {
  std::vector<const Entry*> pointers;
  for (const Entry& entry : list) pointers.push_back(&entry);
  return pointers;
}

/// Returns the entry of that name, or null.
template <class Entry>
const Entry* find_named(std::span<const Entry* const> entries, std::string_view name) {
  for (const Entry* entry : entries)
    if (entry->name == name) return entry;
  return nullptr;
}

/// Returns the entry of a name given by a user. `kind` describes the entries, such as "effect". Errors: kUsage, with a
/// suggestion.
template <class Entry>
Result<const Entry*> require_named(std::string_view kind, std::span<const Entry* const> entries,
                                   std::string_view name) {
  if (const Entry* entry = find_named(entries, name)) return entry;
  std::vector<std::string_view> names;
  names.reserve(entries.size());
  for (const Entry* each : entries) names.push_back(each->name);
  return unknown_name(kind, name, names);
}

}  // namespace umbrage
