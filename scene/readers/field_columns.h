// Which columns of a file are fields of values: properties of PLY files, columns of points in text form.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace umbrage {

struct FileColumn {
  std::string name;      ///< empty: not a number
  bool is_value = true;  ///< not a position, a colour or the like, which are fields only if they are named
};

/// A field, and its column of the file for each component.
struct FieldColumns {
  Field field;
  std::vector<std::size_t> columns;

  /// Appends the values of a row; `at(column)` returns its number.
  template <class At>
  void append(const At& at) {
    for (const std::size_t column : columns) field.values.push_back(float(at(column)));
  }
};

/// Returns the fields that `wanted` asks for, as ImportSettings::field, without values. Columns whose names differ in
/// their last letters, x, y and z, after "_", "." or nothing, or in 0, 1 and 2 after "_" or ":", are the components of
/// one field with the name before that; each is also a field of its own name.
std::vector<FieldColumns> field_columns(std::span<const FileColumn> columns, const std::optional<std::string>& wanted);

}  // namespace umbrage
