// Which columns of a file are fields of values.
#include "scene/readers/field_columns.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace umbrage {
namespace {

using Endings = std::array<std::string_view, 3>;
constexpr Endings kEndings[] = {
    {"_x", "_y", "_z"}, {".x", ".y", ".z"}, {"_0", "_1", "_2"}, {":0", ":1", ":2"}, {"x", "y", "z"}};

std::size_t column_named(std::span<const FileColumn> columns, const std::string& name) {
  return std::size_t(std::find_if(columns.begin(), columns.end(), [&](const FileColumn& c) { return c.name == name; }) -
                     columns.begin());
}

/// Returns the columns of a vector of that name; none if it has none.
std::vector<std::size_t> vector_columns(std::span<const FileColumn> columns, const std::string& name) {
  for (const Endings& endings : kEndings) {
    std::vector<std::size_t> found;
    for (const std::string_view ending : endings) found.push_back(column_named(columns, name + std::string(ending)));
    if (std::count(found.begin(), found.end(), columns.size()) == 0) return found;
  }
  return {};
}

/// Returns the name of the vector of which a column is the first component; empty if it is none.
std::string vector_name(std::span<const FileColumn> columns, const std::string& first) {
  for (const Endings& endings : kEndings) {
    if (!first.ends_with(endings[0]) || first.size() == endings[0].size()) continue;
    std::string name = first.substr(0, first.size() - endings[0].size());
    if (!vector_columns(columns, name).empty()) return name;
  }
  return "";
}

}  // namespace

std::vector<FieldColumns> field_columns(std::span<const FileColumn> columns, const std::optional<std::string>& wanted) {
  std::vector<FieldColumns> fields;
  const auto add = [&](const std::string& name, std::vector<std::size_t> of) {
    fields.push_back({{.name = name, .components = int(of.size()), .values = {}}, std::move(of)});
  };
  if (!wanted) return fields;
  if (!wanted->empty()) {
    const std::size_t column = column_named(columns, *wanted);
    if (column < columns.size())
      add(*wanted, {column});
    else if (auto of = vector_columns(columns, *wanted); !of.empty())
      add(*wanted, std::move(of));
    return fields;
  }
  std::vector<std::uint8_t> used(columns.size(), 0);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (used[k] || !columns[k].is_value || columns[k].name.empty()) continue;
    const std::string name = vector_name(columns, columns[k].name);
    std::vector<std::size_t> of = name.empty() ? std::vector{k} : vector_columns(columns, name);
    for (const std::size_t column : of) used[column] = 1;
    add(name.empty() ? columns[k].name : name, std::move(of));
  }
  return fields;
}

}  // namespace umbrage
