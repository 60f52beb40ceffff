// Parsing of the text of an OBJ file [Wavefront 1995]: vertices, faces and the statements between them.
#pragma once
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/progress.h"

namespace umbrage {

/// Indices of a face's corner: from 0, of position, texture coordinates and normal. Indices that the file does not have
/// are kNoObjIndex; they may also be out of range.
using ObjCorner = glm::ivec3;
inline constexpr std::int32_t kNoObjIndex = INT32_MIN;
/// Indices in files are at most this; larger ones count as this one.
inline constexpr std::int32_t kMaxObjIndex = INT32_MAX / 2;

struct ObjFace {
  std::uint32_t end;   ///< number of corners in its block up to and including this face
  std::uint32_t line;  ///< bytes from the start of the block to its line
  bool is_bad;         ///< one of its words is not an index
};

/// A statement that applies to the faces after it.
struct ObjStatement {
  enum Kind { kMaterial, kObject, kGroup, kSmoothing } kind;
  std::size_t face;       ///< number of faces in the block before it
  std::string_view name;  ///< the remainder of its line
};

/// Counts of lines of one kind, and the first of them as bytes from the start of the text.
struct ObjLines {
  std::size_t count = 0, first = 0;
  void add(std::size_t at) {
    if (count++ == 0) first = at;
  }
  void add(const ObjLines& later) {
    if (count == 0) first = later.first;
    count += later.count;
  }
};

/// A block of whole lines. Positions with something other than a number are not finite.
struct ObjBlock {
  std::string_view text;
  std::vector<glm::dvec3> positions;
  std::vector<glm::vec3> colors;  ///< one per position, white where there is none, or empty
  std::vector<glm::dvec2> uvs;
  std::vector<glm::vec3> normals;
  std::vector<ObjCorner> corners;
  std::vector<ObjFace> faces;
  std::vector<ObjStatement> statements;
  ObjLines bad_positions;               ///< vertices without three finite numbers
  ObjLines commas;                      ///< numbers with decimal commas
  ObjLines lines, points, curves;       ///< elements that are not faces: l, p, and free-form curves and surfaces
  std::vector<std::string_view> other;  ///< first words of other lines, some of them
  std::size_t positions_of_faces = 0;   ///< positions before the last face
  std::size_t vertex_lines = 0;         ///< lines that are a vertex, texture coordinates or a normal
};

/// Prepares the text of an OBJ or MTL file for parsing, without a change of its line numbers: removes a byte order
/// mark, joins lines that end in a backslash unless they are comments, and replaces all line ends by '\n'. The text
/// ends with a line end.
void normalize_lines(std::string& text);

/// Returns the number, from 1, of the line at this position of a normalized text.
std::size_t line_number(std::string_view text, std::size_t at);

/// Returns whether a character of a normalized text separates words of a line.
constexpr bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }

/// Removes blanks at both ends.
std::string_view trimmed(std::string_view text);

/// Parses a normalized text, which must outlive the result, in blocks; `threads`: several at a time. Indices of all
/// blocks refer to the vertices of the whole file. If the poll ends, the result is incomplete.
std::vector<ObjBlock> parse_obj(std::string_view text, bool threads, Poll* poll);

}  // namespace umbrage
