// What the readers of VTK files consist of [VTK, "VTK file formats"]: numbers, the grid that a file describes, and its
// surface.
#pragma once
#include <fmt/core.h>

#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.h"

namespace umbrage::vtk {

/// All numbers of a file, also indices. Doubles hold integers up to 2^53.
using Numbers = std::vector<double>;

/// A type of numbers in binary arrays.
struct NumberType {
  std::size_t bytes = 4;  ///< of each; 0: bits, eight to a byte, the first one the highest
  char kind = 'f';        ///< 'f': float, 'i': integer, 'u': without sign

  std::size_t size(std::size_t count) const { return bytes == 0 ? (count + 7) / 8 : bytes * count; }
};

/// Returns the type with this name in a text file ("unsigned_char") or an XML file ("UInt8"); nothing for others.
std::optional<NumberType> type_named(std::string_view name);

void append_numbers(std::string_view bytes, NumberType type, bool big_endian, Numbers& out);

/// Appends numbers of a text, at most `count`, and removes them from its start. Ends before another word.
void append_text_numbers(std::string_view& text, std::size_t count, Numbers& out);

inline constexpr std::string_view kBlanks = " \t\r\n\v\f";

/// The most points, cells or values of an array that files may have.
inline constexpr std::size_t kMaxCount = 0xfffffffeu, kMaxComponents = 1 << 16;

/// Values on the points or cells of a grid.
struct Values {
  std::string name;
  std::size_t components = 1;
  bool is_active = false;    ///< the file names them as its scalars
  bool is_normal = false;    ///< the file names them as normals
  double color_scale = 0.0;  ///< they are sRGB colours, 0 to this; 0: they are none
  Numbers numbers{};

  /// Makes active bytes of three or four components colours, as VTK draws them.
  void find_colors(const std::optional<NumberType>& type);
};

enum CellType { kPolyVertex = 2, kPolyLine = 4, kStrip = 6, kPolygon = 7 };

struct Cells {
  Numbers types, ends;  ///< of each cell: VTK's number of its type; its end in `corners`
  Numbers corners;      ///< indices of points
};

struct Grid {
  std::vector<glm::dvec3> points;
  Cells cells;
  std::size_t cell_count = 0;  ///< of values on cells
  std::vector<Values> point_values, cell_values;

  /// Appends cells whose points are numbered from `first_point`; of one type, if they have none.
  void add_cells(const Cells& more, std::size_t first_point = 0, std::optional<CellType> type = {});
};

/// What is found while a file is read.
struct Report {
  const std::optional<std::string>& field;  ///< see ImportSettings
  std::string problem{};                    ///< why the file cannot be read; empty: it can
  std::vector<std::string> warnings{};      ///< one sentence each
  std::vector<std::string> left_out{};      ///< names of values that are not asked for

  bool failed() const { return !problem.empty(); }
  /// Notes a problem, if it is the first one.
  template <class... Args>
  void fail(fmt::format_string<Args...> text, Args&&... args) {
    if (problem.empty()) problem = fmt::format(text, std::forward<Args>(args)...);
  }
  /// Returns whether the values of an array are to be read: as a field, or for what they mean. Notes its name if not.
  bool needs(const Values& values);
};

/// Reads a file in VTK's text format, whose numbers are text or big-endian.
Grid read_text_file(std::string_view bytes, Report& report);
/// Reads the pieces of an XML file of polygons or of an unstructured grid.
Grid read_xml_file(std::string bytes, Report& report);

/// Returns the scene of one mesh that a grid becomes, before finish_scene: the faces of volumes that one cell has, and
/// flat cells; without any, the points of cells; without cells, all points. Values of cells are fields on triangles, or
/// of the points that they are drawn as. Sets the report's problem if the cells are not consistent.
Scene scene_of(Grid grid, const std::string& name, Report& report);

}  // namespace umbrage::vtk
