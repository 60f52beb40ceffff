// Implements hidden_edges.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "effects/hidden/hidden_lines.h"
#include "kernel/host_surface.h"

namespace umbrage {
namespace {

constexpr int kClearance = 2;  // max distance of a hidden edge from a visible one at which it is left out, pixels

/// A surface in a pixel, in view space.
struct Sheet {
  float depth = 0.0f;
  scalar::Vec3 position{}, normal{};
};

/// The surfaces along the ray of a pixel, nearest first.
struct Stack {
  int count = 0;
  std::array<Sheet, kLayersRead> sheets;
};

class Surfaces {
 public:
  Surfaces(const HostFrame& frame, const HiddenConstants& c)
      : host_{frame.frame}, c_(c), pixel_(std::abs(frame.frame.ray_scale_x)) {
    // The host step's inputs: five planes of each layer, in order.
    for (std::size_t layer = 0; layer < std::size_t(c.captured); ++layer)
      for (std::size_t k = 0; k < 4; ++k) planes_[layer][k] = layer_input(frame, layer, k);
  }

  Stack stack(int x, int y) const {
    Stack stack;
    for (int layer = 0; layer < c_.captured; ++layer) {
      const auto& [depth, nx, ny, nz] = planes_[std::size_t(layer)];
      Sheet sheet{.depth = depth.row(y)[x]};
      if (!HostSurface::is_surface(sheet.depth)) break;
      sheet.position = host_.view_position(x, y, sheet.depth);
      sheet.normal = host_.unit_normal({nx.row(y)[x], ny.row(y)[x], nz.row(y)[x]}, sheet.position);
      stack.sheets[std::size_t(stack.count++)] = sheet;
    }
    return stack;
  }

  /// Returns whether the surface of number `k` in one stack continues in another one. What lies behind the last captured
  /// surface is unknown: it counts as continued.
  bool continues(const Stack& from, int k, const Stack& to) const {
    const Sheet& a = from.sheets[std::size_t(k)];
    if (to.count == c_.captured && a.depth >= to.sheets[std::size_t(to.count) - 1].depth) return true;
    if (k < to.count && is_same(a, to.sheets[std::size_t(k)])) return true;
    for (int j = 0; j < to.count; ++j)
      if (j != k && is_same(a, to.sheets[std::size_t(j)])) return true;
    return false;
  }

  /// Returns whether a surface that `first` numbers to `end` - 1 count ends between two stacks.
  bool ends(const Stack& a, const Stack& b, int first, int end) const {
    for (int k = first; k < std::min(a.count, end); ++k)
      if (!continues(a, k, b)) return true;
    for (int k = first; k < std::min(b.count, end); ++k)
      if (!continues(b, k, a)) return true;
    return false;
  }

 private:
  using Planes = std::array<HostPlane, 4>;  // depth, normal

  static HostPlane layer_input(const HostFrame& frame, std::size_t layer, std::size_t plane) {
    constexpr std::size_t kPerLayer = 5;
    return frame.inputs[layer * kPerLayer + plane];
  }

  /// Returns whether both lie on one smooth surface: the chord between two points of a plane, and of a sphere, is
  /// perpendicular to the mean of their normals.
  bool is_same(const Sheet& a, const Sheet& b) const {
    const scalar::Vec3 &n = a.normal, &m = b.normal;
    if (!(n.x * m.x + n.y * m.y + n.z * m.z >= c_.min_cosine)) return false;
    const float sx = n.x + m.x, sy = n.y + m.y, sz = n.z + m.z;
    const float off = sx * (b.position.x - a.position.x) + sy * (b.position.y - a.position.y) +
                      sz * (b.position.z - a.position.z);
    const float size = host_.frame.orthographic ? pixel_ : pixel_ * std::min(a.depth, b.depth);
    const float bound = c_.depth * size;
    return off * off <= bound * bound * (sx * sx + sy * sy + sz * sz);
  }

  HostSurface host_;
  const HiddenConstants& c_;
  float pixel_;
  std::array<Planes, kLayersRead> planes_{};
};

/// The edges between the pixels of a row and their right and lower neighbours.
struct RowEdges {
  std::vector<Edge> visible, hidden;
};

RowEdges edges_of_row(const Surfaces& surfaces, int y, int width, int height, int drawn) {
  RowEdges found;
  Stack here = surfaces.stack(0, y), right;
  for (int x = 0; x < width; ++x, here = right) {
    if (x + 1 < width) right = surfaces.stack(x + 1, y);
    for (const bool below : {false, true}) {
      if (below ? y + 1 >= height : x + 1 >= width) continue;
      const Stack lower = below ? surfaces.stack(x, y + 1) : Stack();
      const Stack& there = below ? lower : right;
      const Edge edge{.x = x, .y = y, .below = below, .kind = 1, .step_kind = 1, .strength = 1.0f};
      if (surfaces.ends(here, there, 0, 1)) found.visible.push_back(edge);
      if (surfaces.ends(here, there, 1, drawn)) found.hidden.push_back(edge);
    }
  }
  return found;
}

}  // namespace

std::vector<Edge> hidden_edges(const HostFrame& frame, const HiddenConstants& c) {
  const int width = frame.frame.width, height = frame.frame.height;
  if (c.drawn < 2) return {};
  const Surfaces surfaces(frame, c);
  std::vector<RowEdges> rows;
  rows.resize(std::size_t(height));
  tbb::parallel_for(0, height, [&](int y) {
    rows[std::size_t(y)] = edges_of_row(surfaces, y, width, height, c.drawn);
  });
  std::vector<std::uint8_t> near_visible(std::size_t(width) * std::size_t(height), 0);
  for (const RowEdges& row : rows)
    for (const Edge& e : row.visible)
      for (int y = std::max(e.y - kClearance, 0); y <= std::min(e.y + e.below + kClearance, height - 1); ++y)
        for (int x = std::max(e.x - kClearance, 0); x <= std::min(e.x + !e.below + kClearance, width - 1); ++x)
          near_visible[std::size_t(y) * std::size_t(width) + std::size_t(x)] = 1;
  std::vector<Edge> all;
  for (const RowEdges& row : rows)
    for (const Edge& e : row.hidden)
      if (!near_visible[std::size_t(e.y) * std::size_t(width) + std::size_t(e.x)]) all.push_back(e);
  return without_noise(std::move(all), width);
}

}  // namespace umbrage
