// The surface of VTK's cells: faces of volumes that only one cell has, and flat cells; and the scene that it becomes.
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <map>
#include <span>
#include <utility>

#include "importer/vtk_parts.h"
#include "scene/readers/polygon.h"
#include "scene/readers/positions.h"
#include "scene/readers/vertex_colors.h"

namespace umbrage::vtk {
namespace {

using Index = std::uint32_t;
constexpr Index kNone = std::numeric_limits<Index>::max();

enum class Shape { kUnknown, kPoints, kLines, kFlat, kPixel, kStrip, kVolume };

/// How cells are drawn. Types above 20 have nodes besides their corners, which come first.
struct TypeRules {
  std::array<std::uint8_t, 6> types{};
  Shape shape = Shape::kUnknown;
  std::size_t corner_count = 0;  ///< 0: all nodes
  std::string_view faces = {};   ///< of volumes: a hexadecimal digit for each corner, blanks between faces
};

constexpr std::uint8_t kQuadraticPolygon = 36, kLastFlat = 20;
constexpr TypeRules kRules[] = {{{0, 1, 2}, Shape::kPoints},
                                {{3, 21, 35, 68, 75}, Shape::kLines, 2},
                                {{4}, Shape::kLines},
                                {{5, 22, 34, 69, 76}, Shape::kFlat, 3},
                                {{6}, Shape::kStrip},
                                {{7, kQuadraticPolygon}, Shape::kFlat},
                                {{8}, Shape::kPixel, 4},
                                {{9, 23, 28, 30, 70, 77}, Shape::kFlat, 4},
                                {{10, 24, 71, 78}, Shape::kVolume, 4, "013 123 203 021"},
                                {{11}, Shape::kVolume, 8, "0462 1375 0154 2673 0231 4576"},
                                {{12, 25, 29, 33, 72, 79}, Shape::kVolume, 8, "0473 1265 0154 3762 0321 4567"},
                                {{13, 26, 31, 32, 73, 80}, Shape::kVolume, 6, "012 354 0341 1452 2530"},
                                {{14, 27, 37, 74, 81}, Shape::kVolume, 5, "0321 014 124 234 304"},
                                {{15}, Shape::kVolume, 10, "04321 56789 0165 1276 2387 3498 4059"},
                                {{16}, Shape::kVolume, 12, "054321 6789ab 0176 1287 2398 34a9 45ba 506b"}};

const TypeRules& rules_of(double type) {
  static const auto table = [] {
    std::array<TypeRules, 256> all{};
    for (const TypeRules& rules : kRules)
      for (const std::uint8_t each : rules.types)
        if (all[each].shape == Shape::kUnknown) all[each] = rules;
    return all;
  }();
  return table[type >= 0.0 && type < 255.0 ? std::size_t(type) : 255];
}

/// Polygons, each with its cell.
struct Polygons {
  std::vector<Index> corners, cells;
  std::vector<std::size_t> ends;

  void add(std::span<const Index> polygon, Index cell) {
    corners.insert(corners.end(), polygon.begin(), polygon.end());
    ends.push_back(corners.size());
    cells.push_back(cell);
  }
  std::span<const Index> at(std::size_t i) const {
    const std::size_t begin = i == 0 ? 0 : ends[i - 1];
    return std::span(corners).subspan(begin, ends[i] - begin);
  }
};

/// Faces that an odd number of volumes have, in lists by their lowest point.
class Boundary {
 public:
  explicit Boundary(std::size_t point_count) : first_(point_count, kNone) {}

  void toggle(std::span<const Index> corners, Index cell) {
    Index& link = link_to(corners);
    if (link != kNone) {
      is_inside_[link] = true;
      link = next_[link];
      return;
    }
    link = Index(next_.size());
    next_.push_back(kNone);
    is_inside_.push_back(false);
    faces_.add(corners, cell);
  }
  bool has(std::span<const Index> corners) { return !next_.empty() && link_to(corners) != kNone; }
  void append_to(Polygons& out) const {
    for (std::size_t i = 0; i < next_.size(); ++i)
      if (!is_inside_[i]) out.add(faces_.at(i), faces_.cells[i]);
  }

 private:
  /// Returns the link to the face with these corners, in any order; or the end of its list.
  Index& link_to(std::span<const Index> corners) {
    Index* link = &first_[*std::min_element(corners.begin(), corners.end())];
    while (*link != kNone && !are_same(faces_.at(*link), corners)) link = &next_[*link];
    return *link;
  }
  static bool are_same(std::span<const Index> a, std::span<const Index> b) {
    return a.size() == b.size() && std::is_permutation(a.begin(), a.end(), b.begin());
  }

  std::vector<Index> first_, next_;
  std::vector<bool> is_inside_;
  Polygons faces_;
};

/// What is drawn of cells.
class Surface {
 public:
  Polygons polygons;
  std::vector<std::pair<Index, Index>> points;  ///< point and cell, of cells that are points or lines

  Surface(const Grid& grid, Report& report) : point_count_(double(grid.points.size())), boundary_(grid.points.size()) {
    const Cells& cells = grid.cells;
    if (cells.types.size() != cells.ends.size())
      report.fail("it has the types of {} cells, and the corners of {}", cells.types.size(), cells.ends.size());
    double begin = 0.0;
    for (std::size_t i = 0; i < cells.types.size() && !report.failed(); begin = cells.ends[i++]) {
      const double end = cells.ends[i], all = double(cells.corners.size());
      if (!(end >= begin && end <= all)) report.fail("an offset of its cells is {}, not {} to {}", end, begin, all);
      if (report.failed()) break;
      add(cells.types[i], std::span(cells.corners).subspan(std::size_t(begin), std::size_t(end) - std::size_t(begin)),
          Index(i));
    }
    boundary_.append_to(polygons);
    // Meshes of simulations have the faces of their volumes' boundary once more, as flat cells.
    for (std::size_t i = 0; i < flat_.ends.size(); ++i)
      if (!boundary_.has(flat_.at(i))) polygons.add(flat_.at(i), flat_.cells[i]);
    boundary_ = Boundary(0);
    warn(cells.types.size(), report);
  }

 private:
  void add(double type, std::span<const double> nodes, Index cell) {
    const TypeRules& rules = rules_of(type);
    if (rules.shape == Shape::kUnknown) {
      ++unknown_[type >= 0.0 && type < 256.0 ? int(type) : -1];
      return;
    }
    const std::size_t all = type == kQuadraticPolygon ? nodes.size() / 2 : nodes.size(),
                      count = rules.corner_count > 0 ? rules.corner_count : all;
    corners_.clear();
    for (std::size_t i = 0; i < std::min(count, nodes.size()) && nodes[i] >= 0.0 && nodes[i] < point_count_; ++i)
      corners_.push_back(Index(nodes[i]));
    bad_ += corners_.size() < count;
    if (corners_.size() < count) return;
    curved_ += type > kLastFlat;
    lines_ += rules.shape == Shape::kLines;
    vertices_ += rules.shape == Shape::kPoints && count > 0;
    if (rules.shape == Shape::kPoints || rules.shape == Shape::kLines)
      for (const Index corner : corners_) points.emplace_back(corner, cell);
    if (rules.shape == Shape::kPixel) std::swap(corners_[2], corners_[3]);
    if ((rules.shape == Shape::kPixel || rules.shape == Shape::kFlat) && count > 2) flat_.add(corners_, cell);
    for (std::size_t i = 2; i < count && rules.shape == Shape::kStrip; ++i) {
      const std::size_t odd = i % 2;  // every second triangle has the opposite winding
      flat_.add(std::array{corners_[i - 2 + odd], corners_[i - 1 - odd], corners_[i]}, cell);
    }
    for (const char c : rules.faces) {
      if (c == ' ')
        add_face(cell);
      else
        face_.push_back(corners_[std::size_t(c >= 'a' ? c - 'a' + 10 : c - '0')]);
    }
    if (!face_.empty()) add_face(cell);
  }

  /// Adds face_ and clears it. Where corners of a cell coincide, faces have fewer corners, or none.
  void add_face(Index cell) {
    face_.erase(std::unique(face_.begin(), face_.end()), face_.end());
    if (face_.back() == face_.front()) face_.pop_back();
    if (face_.size() > 2) boundary_.toggle(face_, cell);
    face_.clear();
  }

  void warn(std::size_t cells, Report& report) const {
    const auto say = [&](std::size_t count, std::string_view what) {
      if (count > 0) report.warnings.push_back(fmt::format("{} {}", count, what));
    };
    if (bad_ > 0 && bad_ == cells) report.fail("its {} cells refer to points that do not exist, or lack some", bad_);
    say(bad_, "cells refer to points that do not exist, or lack some, and are left out");
    for (const auto& [type, count] : unknown_) say(count, fmt::format("cells of VTK's type {} are not drawn", type));
    say(curved_, "cells of higher order are drawn by their corners, with flat faces");
    say(lines_, polygons.ends.empty() ? "lines are drawn as their points" : "lines are not drawn");
    if (!polygons.ends.empty()) say(vertices_, "vertices are not drawn");
  }

  double point_count_;
  Boundary boundary_;
  Polygons flat_;
  std::vector<Index> corners_, face_;
  std::size_t bad_ = 0, curved_ = 0, lines_ = 0, vertices_ = 0;
  std::map<int, std::size_t> unknown_;  ///< cells by type
};

/// Returns a field with the values of `items`, one after the other.
Field field_of(const Values& values, const std::vector<Index>& items) {
  Field field{.name = values.name, .components = int(values.components), .values = {}};
  field.values.reserve(items.size() * values.components);
  for (const std::size_t item : items)
    for (std::size_t c = 0; c < values.components; ++c)
      field.values.push_back(float(values.numbers[item * values.components + c]));
  return field;
}

/// Gives a mesh its values. `used`: the point of each position; `cell_of`: the cell of each triangle, or of each
/// position of points; empty: they have none.
void fill_values(const Grid& grid, const std::vector<Index>& used, const std::vector<Index>& cell_of,
                 const Report& report, Mesh& mesh) {
  const auto triples = [&](const Values& values, double scale) {
    std::vector<glm::vec3> out;
    for (const std::size_t i : used) {
      const double* const v = &values.numbers[i * values.components];
      out.emplace_back(glm::dvec3(v[0], v[1], v[2]) / scale);
    }
    return out;
  };
  for (const Values& each : grid.point_values) {
    if (each.is_normal && each.components == 3) mesh.normals = triples(each, 1.0);
    if (each.color_scale > 0.0) mesh.colors = triples(each, each.color_scale);
  }
  for (glm::vec3& color : mesh.colors) color = linear_color(color);
  for (const bool is_active : {true, false})  // active ones come first
    for (const bool on_cells : {false, true})
      for (const Values& each : on_cells ? grid.cell_values : grid.point_values) {
        if (!report.field || (!report.field->empty() && *report.field != each.name)) continue;
        if (each.is_active != is_active || (on_cells && cell_of.empty())) continue;
        mesh.fields.push_back(field_of(each, on_cells ? cell_of : used));
        mesh.fields.back().on_triangles = on_cells && !mesh.points;
      }
}

}  // namespace

void Values::find_colors(const std::optional<NumberType>& type) {
  constexpr double kByte = 255.0;
  if (is_active && components >= 3 && type && type->bytes == 1 && type->kind == 'u') color_scale = kByte;
}

bool Report::needs(const Values& values) {
  if (values.is_normal || values.color_scale > 0.0 || (field && (field->empty() || *field == values.name))) return true;
  if (std::find(left_out.begin(), left_out.end(), values.name) == left_out.end()) left_out.push_back(values.name);
  return false;
}

void Grid::add_cells(const Cells& more, std::size_t first_point, std::optional<CellType> type) {
  const auto before = double(cells.corners.size()), first = double(first_point);
  cells.types.insert(cells.types.end(), more.types.begin(), more.types.end());
  if (type) cells.types.resize(cells.types.size() + more.ends.size(), *type);
  for (const double end : more.ends) cells.ends.push_back(before + end);
  for (const double corner : more.corners)  // of a wrong one nothing is drawn, also where another piece has that point
    cells.corners.push_back(corner >= 0.0 && first + corner < double(points.size()) ? first + corner : -1.0);
  cell_count += more.ends.size();
}

Scene scene_of(Grid grid, const std::string& name, Report& report) {
  Scene scene;
  scene.materials.emplace_back();
  Surface surface(grid, report);
  grid.cells = {};
  if (report.failed()) return scene;
  Mesh mesh;
  mesh.name = name;
  Polygons& polygons = surface.polygons;
  mesh.points = polygons.ends.empty();
  const bool has_cells = !mesh.points || !surface.points.empty();
  // First whether each point is used, of points by which cell; then its number, in the order of the file.
  std::vector<Index> number_of(grid.points.size(), has_cells ? kNone : 0), used, cell_of;
  for (const Index corner : polygons.corners) number_of[corner] = 0;
  if (mesh.points)
    for (const auto& [point, cell] : surface.points) number_of[point] = cell;
  std::vector<glm::dvec3> positions;
  for (std::size_t i = 0; i < number_of.size(); ++i) {
    if (number_of[i] == kNone) continue;
    if (mesh.points && has_cells) cell_of.push_back(number_of[i]);
    number_of[i] = Index(used.size());
    used.push_back(Index(i));
    positions.push_back(grid.points[i]);
  }
  set_positions(positions, mesh, scene);
  for (Index& corner : polygons.corners) corner = number_of[corner];
  FaceSplitter splitter(nullptr);
  for (std::size_t p = 0; p < polygons.ends.size(); ++p) {
    const std::span<const Index> corners = polygons.at(p);
    const std::vector<Index>& triangles = splitter.split(corners, mesh.positions);
    for (const Index corner : triangles) mesh.indices.push_back(corners[corner]);
    cell_of.insert(cell_of.end(), triangles.size() / 3, polygons.cells[p]);
  }
  fill_values(grid, used, cell_of, report, mesh);
  if (!mesh.colors.empty()) scene.materials[0].albedo = glm::vec3(1.0f);
  if (!report.field && !report.left_out.empty())
    report.warnings.push_back(fmt::format("not drawn: '{}'", fmt::join(report.left_out, "', '")));
  scene.warnings = std::move(report.warnings);
  if (!mesh.positions.empty()) scene.meshes.push_back(std::move(mesh));
  return scene;
}

}  // namespace umbrage::vtk
