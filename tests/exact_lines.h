// The exact lines of closed triangle meshes in a picture, in double: edges between a face that is seen and one that
// faces away, creases and borders, each divided where triangles hide it. Positions and lengths are in pixels from the
// picture's upper left corner. Solids must not penetrate each other: where they do, their surfaces meet in no edge.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "core/gbuffer.h"
#include "scene/scene.h"

namespace umbrage::test {

/// A straight line in a picture.
struct Segment {
  glm::dvec2 from, to;

  double length() const { return glm::distance(from, to); }
  glm::dvec2 at(double t) const { return from + t * (to - from); }
  double distance(const glm::dvec2& p) const {
    const glm::dvec2 way = to - from;
    const double square = glm::dot(way, way), t = square > 0.0 ? glm::dot(p - from, way) / square : 0.0;
    return glm::distance(p, at(std::clamp(t, 0.0, 1.0)));
  }
};
using Segments = std::vector<Segment>;

/// The cells of a picture, and which things of a list are in each.
class PictureCells {
 public:
  PictureCells(double width, double height, double size)
      : size_(size),
        columns_(int(width / size) + 1),
        cells_(std::size_t(columns_) * (std::size_t(height / size) + 1)) {}

  void add(int thing, const glm::dvec2& low, const glm::dvec2& high) {
    for_cells(low, high, [&](std::vector<int>& cell) { cell.push_back(thing); });
  }
  /// Calls use(thing) for those near a segment; some more than once.
  template <class Use>
  void along(const Segment& s, double reach, const Use& use) {
    const int steps = int(s.length() / size_) + 1;
    for (int k = 0; k < steps; ++k) {
      const glm::dvec2 a = s.at(double(k) / steps), b = s.at(double(k + 1) / steps);
      for_cells(glm::min(a, b) - reach, glm::max(a, b) + reach, [&](std::vector<int>& cell) {
        for (const int thing : cell) use(thing);
      });
    }
  }

 private:
  template <class Use>
  void for_cells(const glm::dvec2& low, const glm::dvec2& high, const Use& use) {
    const int rows = int(cells_.size()) / columns_;
    const auto cell = [&](double v, int count) { return std::clamp(int(std::floor(v / size_)), 0, count - 1); };
    for (int y = cell(low.y, rows); y <= cell(high.y, rows); ++y)
      for (int x = cell(low.x, columns_); x <= cell(high.x, columns_); ++x) use(cells_[std::size_t(y * columns_ + x)]);
  }

  double size_;
  int columns_;
  std::vector<std::vector<int>> cells_;
};

inline double length_of(const Segments& lines) {
  double sum = 0.0;
  for (const Segment& line : lines) sum += line.length();
  return sum;
}

/// Returns the pieces of `lines`, of up to a quarter of a pixel, that are not within `reach` pixels of `others`.
inline Segments far_pieces(const Segments& lines, const Segments& others, double reach, double width, double height) {
  constexpr double kStep = 0.25, kCell = 4.0;  // pixels
  PictureCells cells(width, height, kCell);
  for (std::size_t k = 0; k < others.size(); ++k) {
    const int steps = int(others[k].length() / kCell) + 1;
    for (int i = 0; i < steps; ++i) {
      const glm::dvec2 a = others[k].at(double(i) / steps), b = others[k].at(double(i + 1) / steps);
      cells.add(int(k), glm::min(a, b) - reach, glm::max(a, b) + reach);
    }
  }
  Segments far;
  for (const Segment& line : lines) {
    const int steps = int(line.length() / kStep) + 1;
    for (int k = 0; k < steps; ++k) {
      const glm::dvec2 p = line.at((k + 0.5) / steps);
      bool found = false;
      cells.along({p, p}, 0.0, [&](int other) { found = found || others[std::size_t(other)].distance(p) <= reach; });
      if (!found) far.push_back({line.at(double(k) / steps), line.at((k + 1.0) / steps)});
    }
  }
  return far;
}

class ExactLines {
 public:
  Segments visible, hidden;
  int borders = 0;  ///< edges that do not have two faces

  /// `crease_deg`: min angle between the normals of two faces whose edge is a line.
  ExactLines(const Scene& scene, const PictureInfo& info, double crease_deg)
      : cells_(info.inner_width(), info.inner_height(), 8.0) {
    for (const Mesh& mesh : scene.meshes) add_mesh(mesh, scene.radius(), info);
    last_.resize(faces_.size(), -1);
    for (std::size_t k = 0; k < faces_.size(); ++k)
      if (faces_[k].area != 0.0) {
        const auto& [a, b, c] = faces_[k].corners;
        cells_.add(int(k), glm::min(a.at, glm::min(b.at, c.at)), glm::max(a.at, glm::max(b.at, c.at)));
      }
    for (const auto& [key, edge] : edges_)
      if (is_line(edge, std::cos(crease_deg * std::numbers::pi / 180.0))) divide(edge);
  }

 private:
  /// A point in the picture. `inverse_depth`, in parallel views the negative depth, is an affine function of the
  /// position on each plane; 1 is about a pixel.
  struct Seen {
    glm::dvec2 at;
    double inverse_depth;
  };
  struct Face {
    std::array<Seen, 3> corners;
    glm::dvec3 normal;
    double area;  ///< twice the signed area in the picture, positive if it is seen; 0: edge-on
  };
  struct MeshEdge {
    Seen from, to;
    std::vector<int> faces;
  };

  void add_mesh(const Mesh& mesh, float radius, const PictureInfo& info) {
    const Camera camera = inner_camera(info);
    const bool is_parallel = camera.projection == Projection::kOrthographic;
    const double pixel = (double(camera.right) - camera.left) / info.inner_width();
    const double middle = 0.5 * (double(info.depth_min) + info.depth_max), weld = 1e-5 * radius;
    const auto seen = [&](const glm::dvec3& p) {
      const glm::dvec3 v = glm::dmat4(camera.view_from_world) * glm::dvec4(p, 1.0);
      const double scale = (is_parallel ? 1.0 : -1.0 / v.z) / pixel;
      return Seen{{v.x * scale - camera.left / pixel, camera.top / pixel - v.y * scale},
                  is_parallel ? v.z / pixel : -middle / (v.z * pixel)};
    };
    std::map<std::array<std::int64_t, 3>, int> numbers;  // of positions that are equal but for rounding
    std::vector<int> corners;
    for (const glm::vec3& p : mesh.positions) {
      const std::array<std::int64_t, 3> key = {std::llround(p.x / weld), std::llround(p.y / weld),
                                               std::llround(p.z / weld)};
      corners.push_back(numbers.emplace(key, int(positions_.size())).first->second);
      if (corners.back() == int(positions_.size())) positions_.push_back(p);
    }
    for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
      std::array<int, 3> n;
      for (std::size_t i = 0; i < 3; ++i) n[i] = corners[mesh.indices[k + i]];
      if (n[0] == n[1] || n[1] == n[2] || n[2] == n[0]) continue;
      const auto p = [&](std::size_t i) { return positions_[std::size_t(n[i])]; };
      Face face{{seen(p(0)), seen(p(1)), seen(p(2))}, glm::normalize(glm::cross(p(1) - p(0), p(2) - p(0))), 0.0};
      const glm::dvec2 u = face.corners[1].at - face.corners[0].at, v = face.corners[2].at - face.corners[0].at;
      const double area = u.y * v.x - u.x * v.y;
      if (std::abs(area) > 1e-6 * (glm::dot(u, u) + glm::dot(v, v))) face.area = area;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        const auto ends = std::minmax(n[i], n[j]);
        MeshEdge& edge = edges_[{ends.first, ends.second}];
        edge.from = face.corners[i], edge.to = face.corners[j];
        edge.faces.push_back(int(faces_.size()));
      }
      faces_.push_back(face);
    }
  }

  bool is_line(const MeshEdge& edge, double min_cosine) {
    borders += edge.faces.size() != 2;
    if (edge.faces.size() != 2) return true;
    const Face &a = faces_[std::size_t(edge.faces[0])], &b = faces_[std::size_t(edge.faces[1])];
    return glm::dot(a.normal, b.normal) <= min_cosine || (a.area > 0.0) != (b.area > 0.0);
  }

  /// Returns the part of an edge, from 0 to 1, that a face hides; empty if the second is not larger.
  static std::pair<double, double> hidden_part(const MeshEdge& edge, const Face& face) {
    constexpr double kOnBorder = 1e-6, kBehind = 1e-3;  // pixels
    double low = 0.0, high = 1.0;
    const auto limit = [&](double from, double to) {  // to where this linear function is positive
      if (from <= 0.0 && to <= 0.0) high = -1.0;
      if (from * to < 0.0)
        (from < 0.0 ? low : high) = from < 0.0 ? std::max(low, from / (from - to)) : std::min(high, from / (from - to));
    };
    const auto& corner = face.corners;
    const double sign = face.area > 0.0 ? -1.0 : 1.0;
    std::array<double, 2> inverse_depth = {0.0, 0.0};
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::dvec2 base = corner[(i + 1) % 3].at, side = corner[(i + 2) % 3].at - base;
      const auto twice = [&](const glm::dvec2& p) {
        return sign * (side.x * (p.y - base.y) - side.y * (p.x - base.x));
      };
      const std::array<double, 2> of_ends = {twice(edge.from.at), twice(edge.to.at)};
      const double margin = kOnBorder * glm::length(side);
      limit(of_ends[0] + margin, of_ends[1] + margin);
      for (std::size_t k = 0; k < 2; ++k)
        inverse_depth[k] += corner[i].inverse_depth * of_ends[k] / std::abs(face.area);
    }
    limit(inverse_depth[0] - edge.from.inverse_depth - kBehind, inverse_depth[1] - edge.to.inverse_depth - kBehind);
    return {low, high};
  }

  /// Appends the visible and the hidden parts of an edge.
  void divide(const MeshEdge& edge) {
    constexpr double kGap = 1e-3;  // pixels: between the triangles of a surface
    const Segment whole{edge.from.at, edge.to.at};
    std::vector<std::pair<double, double>> parts;
    ++now_;
    cells_.along(whole, 0.01, [&](int k) {
      if (std::exchange(last_[std::size_t(k)], now_) == now_) return;
      if (const auto part = hidden_part(edge, faces_[std::size_t(k)]); part.second > part.first) parts.push_back(part);
    });
    parts.push_back({1.0, 1.0});
    std::sort(parts.begin(), parts.end());
    double end = 0.0;
    for (const auto& [first, last] : parts) {
      if ((first - end) * whole.length() > kGap) visible.push_back({whole.at(end), whole.at(first)});
      if (last > std::max(first, end)) hidden.push_back({whole.at(std::max(first, end)), whole.at(last)});
      end = std::max(end, last);
    }
  }

  std::vector<glm::dvec3> positions_;
  std::vector<Face> faces_;
  std::map<std::pair<int, int>, MeshEdge> edges_;
  PictureCells cells_;
  std::vector<int> last_;  // per face: the last edge for which it was tested
  int now_ = 0;
};

}  // namespace umbrage::test
