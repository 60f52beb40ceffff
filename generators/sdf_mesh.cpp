// Mesher of implicit surfaces: surface nets [Gibson 1998] on a grid whose cells away from the surface are skipped; the
// mesh is then split and projected. Splitting costs one vertex per two triangles, whereas a finer grid costs many
// samples.
#include "generators/sdf_mesh.h"

#include <array>
#include <cstdint>
#include <glm/common.hpp>
#include <unordered_map>
#include <vector>

namespace umbrage::sdf {

namespace {

using glm::ivec3;
using glm::vec3;

/// Number of cells along a block's edge. It is small, so that few cells far from the surface are sampled.
constexpr int kBlock = 4;
constexpr int kCorners = kBlock + 1;

/// Max number of cells along the grid's longest side; finer meshes are split. Enough to find every part.
constexpr float kMaxCells = 96.0f;

/// A block is skipped if the field at its centre exceeds this factor times its half diagonal, since the gradient of a
/// field may be as large as this factor.
constexpr float kSlack = 1.4f;

struct Grid {
  vec3 origin{0.0f};
  float cell = 1.0f;
  ivec3 blocks{1};
};

/// Value and gradient from four samples at the corners of a tetrahedron around a point. Their mean approximates the
/// value at the point: the error is the square of the step times the curvature, much less than a cell.
struct Sample {
  float value;
  vec3 slope;
};

Sample sample(const Field& field, vec3 p, float step) {
  const vec3 a(1, -1, -1), b(-1, -1, 1), c(-1, 1, -1), d(1, 1, 1);
  const float at_a = field(p + step * a), at_b = field(p + step * b), at_c = field(p + step * c),
              at_d = field(p + step * d);
  return {0.25f * (at_a + at_b + at_c + at_d), (a * at_a + b * at_b + c * at_c + d * at_d) / (4.0f * step)};
}

/// Makes one Newton step onto the surface, at most `reach` long. Returns the direction of the gradient at the start.
vec3 project(const Field& field, vec3& p, float step, float reach) {
  const auto [value, slope] = sample(field, p, step);
  const float square = glm::dot(slope, slope);
  if (!(square > 1e-12f)) return vec3(0, 1, 0);
  const vec3 move = -value / square * slope;
  const float length = glm::length(move);
  p += length > reach ? move * (reach / length) : move;
  return slope / std::sqrt(square);
}

/// Appends the blocks that the surface may cross, by subdivision of the cube of `size` blocks per side at `block`.
void find_blocks(const Field& field, const Grid& grid, ivec3 block, int size, std::vector<ivec3>& found) {
  if (block.x >= grid.blocks.x || block.y >= grid.blocks.y || block.z >= grid.blocks.z) return;
  const float edge = grid.cell * float(kBlock * size);
  const vec3 centre = grid.origin + grid.cell * float(kBlock) * vec3(block) + 0.5f * edge;
  if (std::abs(field(centre)) > kSlack * 0.8661f * edge) return;
  if (size == 1) {
    found.push_back(block);
    return;
  }
  const int half = size / 2;
  for (int i = 0; i < 8; ++i) find_blocks(field, grid, block + half * ivec3(i & 1, (i >> 1) & 1, i >> 2), half, found);
}

/// The index of the vertex in each cell of a block, or -1, and whether each corner of the cells is inside the surface.
struct BlockVertices {
  std::array<std::int32_t, kBlock * kBlock * kBlock> vertex;
  std::array<bool, kCorners * kCorners * kCorners> inside;
};

int cell_index(ivec3 c) { return (c.z * kBlock + c.y) * kBlock + c.x; }
int corner_index(ivec3 c) { return (c.z * kCorners + c.y) * kCorners + c.x; }

/// Returns the mean of the surface's crossings of a cell's edges.
vec3 mean_crossing(const std::array<float, 8>& value) {
  vec3 sum(0.0f);
  int count = 0;
  for (int corner = 0; corner < 8; ++corner)
    for (int axis = 0; axis < 3; ++axis) {
      const int other = corner | (1 << axis);
      if (other == corner || (value[corner] < 0.0f) == (value[other] < 0.0f)) continue;
      vec3 p(float(corner & 1), float((corner >> 1) & 1), float(corner >> 2));
      p[axis] = value[corner] / (value[corner] - value[other]);
      sum += p;
      ++count;
    }
  return sum / float(count);
}

BlockVertices block_vertices(const Field& field, const Grid& grid, ivec3 block, std::vector<vec3>& positions) {
  BlockVertices result;
  std::array<float, kCorners * kCorners * kCorners> value;
  const vec3 low = grid.origin + grid.cell * float(kBlock) * vec3(block);
  for (int z = 0; z < kCorners; ++z)
    for (int y = 0; y < kCorners; ++y)
      for (int x = 0; x < kCorners; ++x) {
        // Corner positions depend on the index in the whole grid, so that two blocks have bitwise identical values.
        const vec3 p = grid.origin + grid.cell * vec3(block * kBlock + ivec3(x, y, z));
        const int i = corner_index({x, y, z});
        value[i] = field(p);
        result.inside[i] = value[i] < 0.0f;
      }
  for (int z = 0; z < kBlock; ++z)
    for (int y = 0; y < kBlock; ++y)
      for (int x = 0; x < kBlock; ++x) {
        std::array<float, 8> corners;
        int inside = 0;
        for (int i = 0; i < 8; ++i) {
          corners[i] = value[corner_index({x + (i & 1), y + ((i >> 1) & 1), z + (i >> 2)})];
          inside += corners[i] < 0.0f;
        }
        std::int32_t& vertex = result.vertex[cell_index({x, y, z})];
        vertex = -1;
        if (inside == 0 || inside == 8) continue;
        vertex = std::int32_t(positions.size());
        positions.push_back(low + grid.cell * (vec3(x, y, z) + mean_crossing(corners)));
      }
  return result;
}

/// Makes a mesh by surface nets: a vertex in every cell that the surface crosses, and a quad around every edge of the
/// grid that it crosses.
Mesh surface_nets(const Field& field, const Grid& grid) {
  int size = 1;
  while (size < std::max({grid.blocks.x, grid.blocks.y, grid.blocks.z})) size *= 2;
  std::vector<ivec3> blocks;
  find_blocks(field, grid, ivec3(0), size, blocks);

  Mesh mesh;
  const auto key = [&](ivec3 b) { return (std::int64_t(b.z) * grid.blocks.y + b.y) * grid.blocks.x + b.x; };
  std::unordered_map<std::int64_t, std::size_t> block_index;
  std::vector<BlockVertices> vertices;
  vertices.reserve(blocks.size());
  for (const ivec3& block : blocks) {
    block_index.emplace(key(block), vertices.size());
    vertices.push_back(block_vertices(field, grid, block, mesh.positions));
  }

  const auto vertex_at = [&](ivec3 cell) {
    if (cell.x < 0 || cell.y < 0 || cell.z < 0) return -1;
    const ivec3 block = cell / kBlock;
    const auto found = block_index.find(key(block));
    return found == block_index.end() ? -1 : vertices[found->second].vertex[cell_index(cell - block * kBlock)];
  };
  for (std::size_t b = 0; b < blocks.size(); ++b)
    for (int z = 0; z < kBlock; ++z)
      for (int y = 0; y < kBlock; ++y)
        for (int x = 0; x < kBlock; ++x) {
          const ivec3 corner(x, y, z), cell = blocks[b] * kBlock + corner;
          const bool inside = vertices[b].inside[corner_index(corner)];
          for (int axis = 0; axis < 3; ++axis) {
            ivec3 along(0), u(0), v(0);
            along[axis] = 1;
            u[(axis + 1) % 3] = 1;
            v[(axis + 2) % 3] = 1;
            if (inside == vertices[b].inside[corner_index(corner + along)]) continue;
            const std::array<int, 4> quad = {vertex_at(cell - u - v), vertex_at(cell - v), vertex_at(cell),
                                             vertex_at(cell - u)};
            if (std::ranges::min(quad) < 0) continue;
            const auto add = [&](int i, int j, int k) {
              if (!inside) std::swap(j, k);
              mesh.indices.insert(mesh.indices.end(),
                                  {std::uint32_t(quad[i]), std::uint32_t(quad[j]), std::uint32_t(quad[k])});
            };
            // Split the quad along the shorter diagonal, which bends less.
            const auto span = [&](int i, int j) {
              return glm::distance(mesh.positions[quad[i]], mesh.positions[quad[j]]);
            };
            if (span(0, 2) <= span(1, 3)) {
              add(0, 1, 2);
              add(0, 2, 3);
            } else {
              add(0, 1, 3);
              add(1, 2, 3);
            }
          }
        }
  return mesh;
}

/// Splits every triangle into n * n triangles. The vertices of an edge are common to the two triangles beside it.
Mesh split(const Mesh& mesh, int n) {
  Mesh fine;
  fine.positions = mesh.positions;
  const std::size_t triangles = mesh.indices.size() / 3;
  fine.positions.reserve(mesh.positions.size() * n * n);
  fine.indices.reserve(mesh.indices.size() * n * n);
  std::unordered_map<std::uint64_t, std::uint32_t> edges;  // the first of an edge's n - 1 inner vertices
  edges.reserve(triangles * 3 / 2);
  const auto edge_vertex = [&](std::uint32_t from, std::uint32_t to, int step) {
    const std::uint32_t low = std::min(from, to), high = std::max(from, to);
    const auto [found, inserted] =
        edges.try_emplace((std::uint64_t(low) << 32) | high, std::uint32_t(fine.positions.size()));
    if (inserted)
      for (int i = 1; i < n; ++i)
        fine.positions.push_back(glm::mix(mesh.positions[low], mesh.positions[high], float(i) / float(n)));
    return found->second + std::uint32_t((from == low ? step : n - step) - 1);
  };
  std::vector<std::uint32_t> lattice((n + 1) * (n + 1));
  for (std::size_t t = 0; t < triangles; ++t) {
    const std::uint32_t a = mesh.indices[3 * t], b = mesh.indices[3 * t + 1], c = mesh.indices[3 * t + 2];
    const vec3 origin = mesh.positions[a];
    const vec3 ab = (mesh.positions[b] - origin) / float(n), ac = (mesh.positions[c] - origin) / float(n);
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i + j <= n; ++i) {
        std::uint32_t& at = lattice[j * (n + 1) + i];
        if (i == 0 && j == 0)
          at = a;
        else if (i == n)
          at = b;
        else if (j == n)
          at = c;
        else if (j == 0)
          at = edge_vertex(a, b, i);
        else if (i == 0)
          at = edge_vertex(a, c, j);
        else if (i + j == n)
          at = edge_vertex(b, c, j);
        else {
          at = std::uint32_t(fine.positions.size());
          fine.positions.push_back(origin + float(i) * ab + float(j) * ac);
        }
      }
    for (int j = 0; j < n; ++j)
      for (int i = 0; i + j < n; ++i) {
        const std::uint32_t p = lattice[j * (n + 1) + i], q = lattice[j * (n + 1) + i + 1],
                            r = lattice[(j + 1) * (n + 1) + i];
        fine.indices.insert(fine.indices.end(), {p, q, r});
        if (i + j + 1 < n) fine.indices.insert(fine.indices.end(), {q, lattice[(j + 1) * (n + 1) + i + 1], r});
      }
  }
  return fine;
}

}  // namespace

Mesh mesh(const Field& field, vec3 low, vec3 high, float cell) {
  const vec3 size = high - low;
  const int pieces = std::max(1, int(std::ceil(std::max({size.x, size.y, size.z}) / (cell * kMaxCells))));
  Grid grid;
  grid.cell = cell * float(pieces);
  grid.origin = low - 1.5f * grid.cell;
  grid.blocks = ivec3(glm::ceil((size / grid.cell + 3.0f) / float(kBlock)));
  grid.blocks = glm::max(grid.blocks, ivec3(1));

  // The gradient's step is small relative to the cell, but large relative to the rounding of coordinates.
  const float step = std::max(0.03f * cell, 1e-5f * glm::length(size));
  const float reach = 0.5f * grid.cell;
  Mesh result = surface_nets(field, grid);
  for (vec3& p : result.positions)
    for (int i = 0; i < 2; ++i) project(field, p, step, reach);
  if (pieces > 1) result = split(result, pieces);
  // The vertices are now so close to the surface that one step reaches it, and the step's direction is the normal.
  result.normals.reserve(result.positions.size());
  for (vec3& p : result.positions) result.normals.push_back(project(field, p, step, reach));
  return result;
}

}  // namespace umbrage::sdf
