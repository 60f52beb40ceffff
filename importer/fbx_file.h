// FBX files of version 7, binary and text: their tree of records, and the objects, properties and connections in it.
// Written from the files of several programs and the documentation of the FBX SDK 2020; the format is not published.
#pragma once
#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace umbrage {

/// A value of a record: a number or a text, which refers to the bytes of the file.
struct FbxValue {
  double number = 0.0;
  std::int64_t integer = 0;
  std::string_view text;
};

struct FbxRecord {
  std::string_view name;
  std::vector<FbxValue> values;
  std::vector<double> array;
  std::vector<FbxRecord> children;

  /// Returns the first child of a name; an empty record if there is none.
  const FbxRecord& operator[](std::string_view child) const;
  /// Returns a value's text; empty if there is none.
  std::string_view text(std::size_t index = 0) const { return index < values.size() ? values[index].text : ""; }
  double number(std::size_t index, double otherwise) const {
    return index < values.size() ? values[index].number : otherwise;
  }
};

/// Records of properties by their names.
using FbxProperties = std::map<std::string_view, const FbxRecord*>;

/// An object of the file, such as a Model, a Geometry or a Material.
struct FbxObject {
  struct Link {
    FbxObject* object;
    std::string_view property;  ///< of the parent that the child gives a value to; empty: it is a part of the parent
  };
  const FbxRecord* record = nullptr;
  const FbxProperties* defaults = nullptr;  ///< those of all objects of its type
  std::string_view type, subtype;           ///< such as "Geometry" and "Mesh"
  std::string name;
  std::vector<Link> children, parents;  ///< in the order of the file

  /// Returns the record of a property; an empty one if neither the object nor its type has it.
  const FbxRecord& property(std::string_view name) const;
  double number(std::string_view name, double otherwise) const;
  /// Returns a choice among `count`, from 0 on.
  int choice(std::string_view name, int count, int otherwise) const;
  glm::dvec3 vector(std::string_view name, const glm::dvec3& otherwise) const;
  /// Returns the parts of a type, in order.
  std::vector<FbxObject*> parts(std::string_view type) const;
};

struct FbxFile {
  std::string bytes;
  FbxRecord root;
  std::map<std::string_view, FbxProperties> defaults;  ///< by type of object
  std::map<std::int64_t, FbxObject> objects;           ///< by number; 0 is the root of all models
};

/// Reads a file. Errors: kFile.
Result<void> read_fbx_file(const std::filesystem::path& path, FbxFile& file);

}  // namespace umbrage
