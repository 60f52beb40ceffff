// Modelling kit of the built-in scenes. Curved surfaces are lattices of quads, with normals from their faces.
// Based on [Wang et al. 2008] (frames along a path) and ear clipping for flat polygons.
#include "generators/shapes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_inverse.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>
#include <numbers>
#include <unordered_map>

#include "generators/noise.h"

namespace umbrage::shapes {

namespace {

using glm::vec2;
using glm::vec3;

constexpr float kPi = std::numbers::pi_v<float>;

/// Sine of the min angle of a triangle that is kept. Thinner ones occur at poles, where a row is one point.
constexpr float kMinSine = 1e-6f;

float radians(float degrees) { return degrees * (kPi / 180.0f); }

vec3 unit_or(vec3 v, vec3 otherwise) {
  const float length = glm::length(v);
  return length > 0.0f ? v / length : otherwise;
}

/// Returns a unit vector perpendicular to a unit vector.
vec3 perpendicular_to(vec3 n) {
  return glm::normalize(std::abs(n.y) < 0.9f ? glm::cross(vec3(0, 1, 0), n) : glm::cross(vec3(1, 0, 0), n));
}

void add_triangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  mesh.indices.insert(mesh.indices.end(), {a, b, c});
}

/// Adds a triangle unless it is degenerate, as at a pole.
void add_solid_triangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const vec3 ab = mesh.positions[b] - mesh.positions[a], ac = mesh.positions[c] - mesh.positions[a];
  const vec3 bc = ac - ab;
  const float longest = std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(bc, bc)});
  if (glm::length(glm::cross(ab, ac)) > kMinSine * longest) add_triangle(mesh, a, b, c);
}

std::uint32_t add_vertex(Mesh& mesh, vec3 position, vec3 normal, vec2 uv) {
  mesh.positions.push_back(position);
  mesh.normals.push_back(normal);
  mesh.uvs.push_back(uv);
  return std::uint32_t(mesh.positions.size() - 1);
}

/// Returns the sum of the face normals around each vertex, weighted by area.
std::vector<vec3> summed_normals(const Mesh& mesh) {
  std::vector<vec3> sums(mesh.positions.size(), vec3(0.0f));
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const std::uint32_t a = mesh.indices[i], b = mesh.indices[i + 1], c = mesh.indices[i + 2];
    const vec3 face = glm::cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
    sums[a] += face;
    sums[b] += face;
    sums[c] += face;
  }
  return sums;
}

/// Makes (nu + 1) x (nv + 1) vertices and the quads between; `at(i, j)` returns a SurfacePoint.
template <class At>
Mesh lattice(int nu, int nv, const At& at, Wrap wrap = {}) {
  nu = std::max(nu, 1);
  nv = std::max(nv, 1);
  Mesh mesh;
  const std::size_t count = std::size_t(nu + 1) * std::size_t(nv + 1);
  mesh.positions.reserve(count);
  mesh.uvs.reserve(count);
  mesh.indices.reserve(std::size_t(nu) * std::size_t(nv) * 6);
  for (int j = 0; j <= nv; ++j)
    for (int i = 0; i <= nu; ++i) {
      const SurfacePoint point = at(i, j);
      mesh.positions.push_back(point.position);
      mesh.uvs.push_back(point.uv);
    }
  const auto index = [nu](int i, int j) { return std::uint32_t(j) * std::uint32_t(nu + 1) + std::uint32_t(i); };
  for (int j = 0; j < nv; ++j)
    for (int i = 0; i < nu; ++i) {
      const std::uint32_t a = index(i, j), b = index(i + 1, j), c = index(i + 1, j + 1), d = index(i, j + 1);
      add_solid_triangle(mesh, a, b, c);
      add_solid_triangle(mesh, a, c, d);
    }
  std::vector<vec3> sums = summed_normals(mesh);
  const auto merge = [&sums](std::uint32_t a, std::uint32_t b) { sums[a] = sums[b] = sums[a] + sums[b]; };
  if (wrap.u)
    for (int j = 0; j <= nv; ++j) merge(index(0, j), index(nu, j));
  if (wrap.v)
    for (int i = 0; i <= nu; ++i) merge(index(i, 0), index(i, nv));
  for (int j : {0, nv}) {  // a row that is one point has one normal
    const vec3 first = mesh.positions[index(0, j)];
    const vec3 across = mesh.positions[index(nu / 2, j)] - mesh.positions[index(nu / 2, nv / 2)];
    vec3 sum(0.0f);
    bool pole = true;
    for (int i = 0; i <= nu; ++i) {
      pole = pole && glm::length(mesh.positions[index(i, j)] - first) <= kMinSine * glm::length(across);
      sum += sums[index(i, j)];
    }
    if (pole)
      for (int i = 0; i <= nu; ++i) sums[index(i, j)] = sum;
  }
  mesh.normals.reserve(count);
  for (const vec3& sum : sums) mesh.normals.push_back(unit_or(sum, vec3(0, 1, 0)));
  return mesh;
}

/// A part of a profile or outline between sharp edges.
struct Run {
  Points2 points;
  std::vector<float> length;  ///< from the start of the whole line
  bool closed = false;        ///< a loop without a sharp edge; the last point repeats the first
};

std::vector<Run> runs_of(std::span<const vec2> points, bool closed) {
  Points2 line(points.begin(), points.end());
  bool smooth_loop = false;
  if (closed && line.size() > 1) {
    std::size_t edge = 0;
    while (edge < line.size() && line[edge] != line[(edge + 1) % line.size()]) ++edge;
    smooth_loop = edge == line.size();
    if (smooth_loop)
      line.push_back(line.front());
    else
      std::rotate(line.begin(), line.begin() + std::ptrdiff_t((edge + 1) % line.size()), line.end());
  }
  std::vector<Run> runs;
  float length = 0.0f;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (i == 0 || line[i] == line[i - 1]) {
      runs.emplace_back();
    } else {
      length += glm::length(line[i] - line[i - 1]);
    }
    runs.back().points.push_back(line[i]);
    runs.back().length.push_back(length);
  }
  std::erase_if(runs, [](const Run& run) { return run.points.size() < 2; });
  if (smooth_loop && !runs.empty()) runs.front().closed = true;
  return runs;
}

Points2 without_doubles(std::span<const vec2> points) {
  Points2 out;
  for (const vec2& point : points)
    if (out.empty() || out.back() != point) out.push_back(point);
  while (out.size() > 1 && out.front() == out.back()) out.pop_back();
  return out;
}

float turn_of(vec2 a, vec2 b, vec2 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

/// Returns the triangles of a simple counter-clockwise polygon. Ears are cut at the corner with the widest ear, so that
/// round outlines do not become fans of slivers.
std::vector<std::uint32_t> ear_clip(const Points2& polygon) {
  std::vector<std::uint32_t> left(polygon.size()), triangles;
  for (std::uint32_t i = 0; i < left.size(); ++i) left[i] = i;
  while (left.size() > 3) {
    std::size_t best = left.size();
    float shortest = 1e30f;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const vec2 a = polygon[left[(i + left.size() - 1) % left.size()]], b = polygon[left[i]],
                 c = polygon[left[(i + 1) % left.size()]];
      if (turn_of(a, b, c) <= 0.0f || glm::length(c - a) >= shortest) continue;
      const bool is_ear = std::none_of(left.begin(), left.end(), [&](std::uint32_t other) {
        const vec2 p = polygon[other];
        return p != a && p != b && p != c && turn_of(a, b, p) >= 0.0f && turn_of(b, c, p) >= 0.0f &&
               turn_of(c, a, p) >= 0.0f;
      });
      if (is_ear) best = i, shortest = glm::length(c - a);
    }
    if (best == left.size()) break;  // not simple: the rest stays open
    triangles.insert(triangles.end(),
                     {left[(best + left.size() - 1) % left.size()], left[best], left[(best + 1) % left.size()]});
    left.erase(left.begin() + std::ptrdiff_t(best));
  }
  if (left.size() == 3) triangles.insert(triangles.end(), left.begin(), left.end());
  return triangles;
}

/// Adds a flat polygon placed by an origin and two axes; the front is where x_axis x y_axis points.
void add_polygon(Mesh& mesh, const Points2& polygon, vec3 origin, vec3 x_axis, vec3 y_axis, bool back) {
  const vec3 normal = glm::normalize(glm::cross(x_axis, y_axis)) * (back ? -1.0f : 1.0f);
  const std::uint32_t base = std::uint32_t(mesh.positions.size());
  for (const vec2& p : polygon) add_vertex(mesh, origin + p.x * x_axis + p.y * y_axis, normal, p);
  const std::vector<std::uint32_t> triangles = ear_clip(polygon);
  for (std::size_t i = 0; i < triangles.size(); i += 3) {
    const std::uint32_t b = triangles[i + (back ? 2 : 1)], c = triangles[i + (back ? 1 : 2)];
    add_triangle(mesh, base + triangles[i], base + b, base + c);
  }
}

struct CubeFace {
  vec3 normal, s, t;  ///< s x t = normal
};
constexpr CubeFace kCubeFaces[6] = {{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}, {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                                    {{0, 1, 0}, {1, 0, 0}, {0, 0, -1}}, {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
                                    {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}},  {{0, 0, -1}, {-1, 0, 0}, {0, 1, 0}}};

/// Warps a cube face's coordinate to steps of equal angle; the ends stay exactly -1 and 1.
float even_in_angle(float t) { return std::abs(t) == 1.0f ? t : std::tan(0.25f * kPi * t); }

/// Tangents and axes along a path, and the length up to each point.
struct PathFrames {
  std::vector<vec3> tangent, side, over;
  std::vector<float> length;
};

PathFrames frames_of(std::span<const vec3> path, vec3 side, bool closed) {
  PathFrames f;
  const std::size_t n = path.size();
  const auto at = [&](std::ptrdiff_t i) {
    const std::ptrdiff_t count = std::ptrdiff_t(n);
    return closed ? path[std::size_t((i + count) % count)]
                  : path[std::size_t(std::clamp<std::ptrdiff_t>(i, 0, count - 1))];
  };
  float length = 0.0f;
  for (std::size_t i = 0; i < n; ++i) {
    const std::ptrdiff_t k = std::ptrdiff_t(i);
    f.tangent.push_back(unit_or(at(k + 1) - at(k - 1), vec3(0, 1, 0)));
    if (i > 0) length += glm::length(path[i] - path[i - 1]);
    f.length.push_back(length);
  }
  for (std::size_t i = 0; i < n; ++i) {
    vec3 carried = side;
    if (i > 0) {  // double reflection: in the plane between the points, then in the plane between the tangents
      const vec3 v1 = path[i] - path[i - 1];
      const float c1 = std::max(glm::dot(v1, v1), 1e-30f);
      const vec3 side_l = f.side[i - 1] - 2.0f / c1 * glm::dot(v1, f.side[i - 1]) * v1;
      const vec3 tangent_l = f.tangent[i - 1] - 2.0f / c1 * glm::dot(v1, f.tangent[i - 1]) * v1;
      const vec3 v2 = f.tangent[i] - tangent_l;
      const float c2 = glm::dot(v2, v2);
      carried = c2 > 1e-12f ? side_l - 2.0f / c2 * glm::dot(v2, side_l) * v2 : side_l;
    }
    const vec3 flat = carried - glm::dot(carried, f.tangent[i]) * f.tangent[i];
    f.side.push_back(glm::length(flat) > 1e-6f ? glm::normalize(flat) : perpendicular_to(f.tangent[i]));
    f.over.push_back(glm::cross(f.tangent[i], f.side[i]));
  }
  return f;
}

}  // namespace

// ---------------------------------------------------------------------------------------------------------- surfaces

Mesh surface(int nu, int nv, const std::function<SurfacePoint(float, float)>& at, Wrap wrap) {
  nu = std::max(nu, 1);
  nv = std::max(nv, 1);
  return lattice(
      nu, nv, [&](int i, int j) { return at(float(i) / float(nu), float(j) / float(nv)); }, wrap);
}

Mesh plane(vec2 low, vec2 high, float height, int nx, int nz) {
  return surface(nx, nz, [&](float u, float v) {
    const vec2 p(low.x + u * (high.x - low.x), high.y + v * (low.y - high.y));
    return SurfacePoint{{p.x, height, p.y}, {p.x, -p.y}};
  });
}

Mesh quad(vec3 a, vec3 b, vec3 c, vec3 d, int nu, int nv) {
  const float width = glm::length(b - a), height = glm::length(d - a);
  return surface(nu, nv, [&](float u, float v) {
    const vec3 low = a + u * (b - a), high = d + u * (c - d);
    return SurfacePoint{low + v * (high - low), {u * width, v * height}};
  });
}

Mesh drape(float width, float height, float folds, float depth, std::uint32_t seed, int nu, int nv) {
  noise::Random random{noise::hash(seed)};
  const float start = random.next(), wander = random.between(0.5f, 1.0f), lean = random.between(-1.0f, 1.0f);
  const std::uint32_t cloth_seed = seed * 7u + 3u;
  return surface(nu, nv, [&](float u, float v) {
    const float down = 1.0f - v;  // 0 at the rail, 1 at the hem
    const float drift = wander * noise::gradient({u * folds * 0.5f, down * 1.3f}, cloth_seed);
    const float phase = 2.0f * kPi * (folds * u + start + (0.1f + 0.4f * down) * drift + 0.12f * lean * down * down);
    const float open = 0.55f + 0.45f * down + 0.3f * noise::gradient({u * folds * 0.7f, down * 2.0f}, cloth_seed + 1);
    const float wave = std::sin(phase) + 0.25f * std::sin(2.0f * phase + 1.0f);
    const float x = width * (u - 0.5f) + 0.35f * depth * open * std::cos(phase);
    const float hem = -0.15f * depth * wave * down;
    return SurfacePoint{{x, -height * down + hem, depth * open * wave}, {width * 1.4f * u, height * v}};
  });
}

// ------------------------------------------------------------------------------------------------------------ solids

Mesh box(vec3 low, vec3 high, float bevel, int bevel_segments) {
  const vec3 centre = 0.5f * (low + high), half = 0.5f * (high - low);
  bevel = std::min({bevel, half.x, half.y, half.z});
  const int n = bevel > 0.0f ? std::max(bevel_segments, 0) : 0;
  Mesh mesh;
  for (const CubeFace& face : kCubeFaces) {
    // Along each edge direction: n steps around the low edge, one over the flat, n around the high edge.
    const int side = 2 * n + 2;
    const std::uint32_t base = std::uint32_t(mesh.positions.size());
    const auto slope = [n](int i) {  // tangent of the angle to the face's normal
      if (n == 0) return 0.0f;
      if (i <= n) return -even_in_angle(float(n - i) / float(n));
      return even_in_angle(float(i - n - 1) / float(n));
    };
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const vec3 out = glm::normalize(face.normal + slope(i) * face.s + slope(j) * face.t);
        const vec3 corner = face.normal + (i <= n ? -1.0f : 1.0f) * face.s + (j <= n ? -1.0f : 1.0f) * face.t;
        const vec3 position = centre + corner * (half - vec3(bevel)) + bevel * (n > 0 ? out : corner);
        add_vertex(mesh, position, n > 0 ? out : face.normal, {glm::dot(position, face.s), glm::dot(position, face.t)});
      }
    for (int j = 0; j + 1 < side; ++j)
      for (int i = 0; i + 1 < side; ++i) {
        const std::uint32_t a = base + std::uint32_t(j * side + i), d = a + std::uint32_t(side);
        add_solid_triangle(mesh, a, a + 1, d + 1);
        add_solid_triangle(mesh, a, d + 1, d);
      }
  }
  return mesh;
}

Mesh sphere(float radius, int slices, int stacks) {
  slices = std::max(slices, 3);
  stacks = std::max(stacks, 2);
  Mesh mesh =
      surface(slices, stacks,
              [&](float u, float v) {
                const float turn = 2.0f * kPi * u, tilt = kPi * (v - 0.5f);
                const vec3 out(std::cos(tilt) * std::sin(turn), std::sin(tilt), std::cos(tilt) * std::cos(turn));
                return SurfacePoint{radius * out, {2.0f * kPi * radius * u, kPi * radius * v}};
              },
              {.u = true});
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) mesh.normals[i] = unit_or(mesh.positions[i], mesh.normals[i]);
  return mesh;
}

Mesh cube_sphere(int n, const std::function<float(vec3)>& displace) {
  n = std::max(n, 2);
  Mesh mesh;
  std::vector<std::uint64_t> keys;  // vertices of neighbouring faces at one position have the same key
  for (const CubeFace& face : kCubeFaces) {
    const std::uint32_t base = std::uint32_t(mesh.positions.size());
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const float s = 2.0f * float(i) / float(n) - 1.0f, t = 2.0f * float(j) / float(n) - 1.0f;
        const vec3 out = glm::normalize(face.normal + even_in_angle(s) * face.s + even_in_angle(t) * face.t);
        const float radius = displace(out);
        add_vertex(mesh, radius * out, out, 0.25f * kPi * radius * vec2(s, t));
        const vec3 place = float(n) * face.normal + float(2 * i - n) * face.s + float(2 * j - n) * face.t;
        const auto part = [n](float x) { return std::uint64_t(int(std::lround(x)) + n); };
        keys.push_back((part(place.x) << 42) | (part(place.y) << 21) | part(place.z));
      }
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const std::uint32_t a = base + std::uint32_t(j * (n + 1) + i), d = a + std::uint32_t(n + 1);
        add_triangle(mesh, a, a + 1, d + 1);
        add_triangle(mesh, a, d + 1, d);
      }
  }
  const std::vector<vec3> sums = summed_normals(mesh);
  std::unordered_map<std::uint64_t, vec3> joined;
  const auto on_edge = [n](std::size_t i) {
    const int k = int(i % std::size_t((n + 1) * (n + 1)));
    const int x = k % (n + 1), y = k / (n + 1);
    return x == 0 || y == 0 || x == n || y == n;
  };
  for (std::size_t i = 0; i < sums.size(); ++i)
    if (on_edge(i)) joined.try_emplace(keys[i], vec3(0.0f)).first->second += sums[i];
  for (std::size_t i = 0; i < sums.size(); ++i)
    mesh.normals[i] = unit_or(on_edge(i) ? joined[keys[i]] : sums[i], mesh.normals[i]);
  return mesh;
}

Mesh superellipsoid(vec3 radii, float power, int n) {
  return cube_sphere(n, [&](vec3 out) {
    const vec3 q = glm::abs(out) / radii;
    return std::pow(std::pow(q.x, power) + std::pow(q.y, power) + std::pow(q.z, power), -1.0f / power);
  });
}

Mesh cushion(vec3 size, int n) {
  n = std::max(n, 2);
  constexpr float kSeam = 0.06f;    // thickness at the seam, as a fraction
  constexpr float kPulled = 0.07f;  // indentation of the sides between the corners
  Mesh mesh;
  for (const float side : {1.0f, -1.0f}) {
    Mesh half = surface(n, n, [&](float u, float v) {
      // Steps are smaller towards the seam, where the cloth turns.
      const float a = std::sin(0.5f * kPi * (2.0f * u - 1.0f)), b = -side * std::sin(0.5f * kPi * (2.0f * v - 1.0f));
      const float full = std::pow(std::max((1.0f - a * a) * (1.0f - b * b), 0.0f), 0.36f);
      const float x = a * (1.0f - kPulled * (1.0f - b * b) * std::abs(a)),
                  z = b * (1.0f - kPulled * (1.0f - a * a) * std::abs(b));
      const float y = side * (kSeam * std::min(full * 8.0f, 1.0f) + (1.0f - kSeam) * full);
      return SurfacePoint{0.5f * size * vec3(x, y, z), 0.5f * vec2(a * size.x, b * size.z)};
    });
    append(mesh, half);
  }
  return mesh;
}

Mesh torus(float ring_radius, float tube_radius, int slices, int sides) {
  return surface(std::max(slices, 3), std::max(sides, 3),
                 [&](float u, float v) {
                   const float turn = 2.0f * kPi * u, roll = 2.0f * kPi * v;
                   const float r = ring_radius + tube_radius * std::cos(roll);
                   return SurfacePoint{{r * std::sin(turn), tube_radius * std::sin(roll), r * std::cos(turn)},
                                       {ring_radius * turn, tube_radius * roll}};
                 },
                 {.u = true, .v = true});
}

Mesh cone(float radius_bottom, float radius_top, float height, int slices, int stacks) {
  Points2 side;
  stacks = std::max(stacks, 1);
  for (int i = 0; i <= stacks; ++i) {
    const float t = float(i) / float(stacks);
    side.emplace_back(radius_bottom + t * (radius_top - radius_bottom), t * height);
  }
  Points2 profile;
  if (radius_bottom > 0.0f) profile = {{0.0f, 0.0f}, {radius_bottom, 0.0f}};
  profile.insert(profile.end(), side.begin(), side.end());
  if (radius_top > 0.0f) profile.insert(profile.end(), {{radius_top, height}, {0.0f, height}});
  return lathe(profile, slices);
}

Mesh lathe(std::span<const vec2> profile, int slices, float turn_deg) {
  slices = std::max(slices, turn_deg >= 360.0f ? 3 : 1);
  float widest = 0.0f;
  for (const vec2& point : profile) widest = std::max(widest, point.x);
  Mesh mesh;
  for (const Run& run : runs_of(profile, false))
    append(mesh, lattice(slices, int(run.points.size()) - 1,
                         [&](int i, int j) {
                           const float turn = radians(turn_deg) * float(i) / float(slices);
                           // The last slice coincides exactly with the first, so that there is no crack.
                           const float angle = turn_deg >= 360.0f && i == slices ? 0.0f : turn;
                           const vec2 p = run.points[std::size_t(j)];
                           return SurfacePoint{{p.x * std::sin(angle), p.y, p.x * std::cos(angle)},
                                               {widest * turn, run.length[std::size_t(j)]}};
                         },
                         {.u = turn_deg >= 360.0f}));
  return mesh;
}

Mesh extrusion(std::span<const vec2> outline, float depth) {
  Mesh mesh;
  for (const Run& run : runs_of(outline, true))
    append(mesh,
           lattice(int(run.points.size()) - 1, 1,
                   [&](int i, int j) {
                     const vec2 p = run.points[std::size_t(i)];
                     return SurfacePoint{{p.x, p.y, float(j) * depth}, {run.length[std::size_t(i)], float(j) * depth}};
                   },
                   {.u = run.closed}));
  const Points2 polygon = without_doubles(outline);
  add_polygon(mesh, polygon, {0, 0, depth}, {1, 0, 0}, {0, 1, 0}, false);
  add_polygon(mesh, polygon, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, true);
  return mesh;
}

Mesh sweep(std::span<const vec3> path, std::span<const vec2> section, vec3 side, bool closed_path,
           std::span<const float> scale) {
  Mesh mesh;
  if (path.size() < 2) return mesh;
  const PathFrames frames = frames_of(path, side, closed_path);
  const float closing = closed_path ? glm::length(path.front() - path.back()) : 0.0f;
  const auto size = [&](std::size_t k) { return scale.empty() ? 1.0f : scale[k]; };
  for (const Run& run : runs_of(section, true))
    append(mesh, lattice(int(run.points.size()) - 1, int(path.size()) - (closed_path ? 0 : 1),
                         [&](int i, int j) {
                           const std::size_t k = std::size_t(j) % path.size();
                           const vec2 p = size(k) * run.points[std::size_t(i)];
                           const float along =
                               std::size_t(j) == path.size() ? frames.length.back() + closing : frames.length[k];
                           return SurfacePoint{path[k] + p.x * frames.side[k] + p.y * frames.over[k],
                                               {run.length[std::size_t(i)], along}};
                         },
                         {.u = run.closed, .v = closed_path}));
  if (!closed_path) {
    const Points2 polygon = without_doubles(section);
    const auto cap = [&](std::size_t k, bool back) {
      if (size(k) > 0.0f) add_polygon(mesh, polygon, path[k], size(k) * frames.side[k], size(k) * frames.over[k], back);
    };
    cap(0, true);
    cap(path.size() - 1, false);
  }
  return mesh;
}

Mesh tube(std::span<const vec3> path, float radius, int sides, bool closed_path, std::span<const float> scale) {
  return sweep(path, circle(radius, std::max(sides, 3)), {1.0f, 0.0f, 0.01f}, closed_path, scale);
}

Mesh moulding(std::span<const vec3> path, std::span<const vec2> section, bool closed) {
  Mesh mesh;
  const std::size_t n = path.size();
  if (n < 2) return mesh;
  const vec3 up(0, 1, 0);
  const auto direction = [&](std::size_t i) { return unit_or(path[(i + 1) % n] - path[i % n], vec3(1, 0, 0)); };
  const auto out_at = [&](std::size_t i) {  // along the mitre, long enough to keep the section's width
    const bool has_before = closed || i > 0, has_after = closed || i + 1 < n;
    const vec3 after = glm::cross(has_after ? direction(i) : direction(i - 1), up);
    const vec3 before = has_before ? glm::cross(direction(i + n - 1), up) : after;
    const vec3 middle = unit_or(before + after, after);
    return middle / std::max(glm::dot(middle, after), 0.1f);
  };
  float start = 0.0f;
  for (std::size_t i = 0; i < (closed ? n : n - 1); ++i) {
    const std::size_t next = (i + 1) % n;
    const float length = glm::length(path[next] - path[i]);
    for (const Run& run : runs_of(section, false))
      append(mesh, lattice(1, int(run.points.size()) - 1, [&](int a, int b) {
               const std::size_t k = a == 0 ? i : next;
               const vec2 p = run.points[std::size_t(b)];
               return SurfacePoint{path[k] + p.x * out_at(k) + p.y * up,
                                   {start + float(a) * length, run.length[std::size_t(b)]}};
             }));
    start += length;
  }
  return mesh;
}

Mesh arch(float opening, float width, float height, float depth, int segments, bool closed) {
  const float radius = 0.5f * opening, half = 0.5f * width, front = 0.5f * depth;
  // Equal steps, and one step exactly into each corner of the wall.
  std::vector<float> angles;
  segments = std::max(segments, 4);
  const float corner = std::atan2(height, half);
  for (int i = 0; i <= segments; ++i) angles.push_back(kPi * float(i) / float(segments));
  for (const float exact : {corner, kPi - corner}) {
    auto closest = std::min_element(angles.begin() + 1, angles.end() - 1,
                                    [&](float a, float b) { return std::abs(a - exact) < std::abs(b - exact); });
    *closest = exact;
  }
  const auto inner = [&](float a) { return radius * vec2(std::cos(a), std::sin(a)); };
  const auto outer = [&](float a) {
    const float c = std::abs(std::cos(a)), s = std::sin(a);
    if (a <= 0.0f || a >= kPi) return vec2(a <= 0.0f ? half : -half, 0.0f);
    const float reach = s * half <= c * height * 1.000001f ? half / c : height / s;
    return reach * vec2(std::cos(a), std::sin(a));
  };
  Mesh mesh;
  for (const float side : {1.0f, -1.0f}) {
    const std::uint32_t base = std::uint32_t(mesh.positions.size());
    for (const float a : angles)
      for (const vec2 p : {inner(a), outer(a)})
        add_vertex(mesh, {p.x, p.y, side * front}, {0, 0, side}, {side * p.x, p.y});
    for (std::uint32_t i = 0; i + 1 < angles.size(); ++i) {
      const std::uint32_t a = base + 2 * i, b = a + 1, c = a + 3, d = a + 2;
      add_solid_triangle(mesh, a, side > 0 ? b : c, side > 0 ? c : b);
      add_solid_triangle(mesh, a, side > 0 ? c : d, side > 0 ? d : c);
    }
  }
  Mesh underside = lattice(int(angles.size()) - 1, 1, [&](int i, int j) {
    const float a = angles[std::size_t(i)];
    return SurfacePoint{{inner(a), front - depth * float(j)}, {radius * a, depth * float(j)}};
  });
  for (std::size_t i = 0; i < underside.normals.size(); ++i)
    underside.normals[i] = unit_or(-vec3(vec2(underside.positions[i]), 0.0f), {0, -1, 0});
  append(mesh, underside);
  for (const float side : {-1.0f, 1.0f}) {
    const float low = side < 0.0f ? -half : radius, high = side < 0.0f ? -radius : half;
    if (high > low) append(mesh, quad({low, 0, -front}, {high, 0, -front}, {high, 0, front}, {low, 0, front}, 1, 1));
  }
  if (closed) {
    append(mesh,
           quad({-half, height, front}, {half, height, front}, {half, height, -front}, {-half, height, -front}, 1, 1));
    append(mesh, quad({half, 0, front}, {half, 0, -front}, {half, height, -front}, {half, height, front}, 1, 1));
    append(mesh, quad({-half, 0, -front}, {-half, 0, front}, {-half, height, front}, {-half, height, -front}, 1, 1));
  }
  return mesh;
}

Mesh wall_with_hole(vec2 size, vec2 hole_low, vec2 hole_high, float depth) {
  const float x[4] = {0.0f, hole_low.x, hole_high.x, size.x}, y[4] = {0.0f, hole_low.y, hole_high.y, size.y};
  Mesh mesh;
  for (const float z : {0.0f, -depth})
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        if ((i == 1 && j == 1) || x[i + 1] <= x[i] || y[j + 1] <= y[j]) continue;
        const std::uint32_t base = std::uint32_t(mesh.positions.size());
        const float facing = z == 0.0f ? 1.0f : -1.0f;
        for (const vec2 p : {vec2(x[i], y[j]), vec2(x[i + 1], y[j]), vec2(x[i + 1], y[j + 1]), vec2(x[i], y[j + 1])})
          add_vertex(mesh, {p, z}, {0, 0, facing}, {facing * p.x, p.y});
        add_triangle(mesh, base, base + (facing > 0 ? 1 : 2), base + (facing > 0 ? 2 : 1));
        add_triangle(mesh, base, base + (facing > 0 ? 2 : 3), base + (facing > 0 ? 3 : 2));
      }
  const float l = x[1], r = x[2], b = y[1], t = y[2], d = -depth;
  append(mesh, quad({l, b, 0}, {r, b, 0}, {r, b, d}, {l, b, d}, 1, 1));
  append(mesh, quad({l, t, d}, {r, t, d}, {r, t, 0}, {l, t, 0}, 1, 1));
  append(mesh, quad({l, b, 0}, {l, b, d}, {l, t, d}, {l, t, 0}, 1, 1));
  append(mesh, quad({r, b, d}, {r, b, 0}, {r, t, 0}, {r, t, d}, 1, 1));
  return mesh;
}

// ---------------------------------------------------------------------------------------------- curves and profiles

Points2 circle(float radius, int n) {
  Points2 points;
  n = std::max(n, 3);
  for (int i = 0; i < n; ++i) {
    const float a = 2.0f * kPi * float(i) / float(n);
    points.emplace_back(radius * std::cos(a), radius * std::sin(a));
  }
  return points;
}

Points2 rectangle(vec2 size, float round, int n) {
  const vec2 half = 0.5f * size;
  round = std::min({round, half.x, half.y});
  if (round <= 0.0f || n < 1) {
    const Points2 corners = {{-half.x, -half.y}, {half.x, -half.y}, {half.x, half.y}, {-half.x, half.y}};
    return sharp(corners);
  }
  Points2 points;
  for (int i = 0; i < 4; ++i) {
    const vec2 centre((i == 0 || i == 3 ? 1.0f : -1.0f) * (half.x - round), (i < 2 ? 1.0f : -1.0f) * (half.y - round));
    const Points2 corner = arc(centre, round, 90.0f * float(i), 90.0f * float(i + 1), n);
    for (const vec2& point : corner)
      if (points.empty() || glm::length(point - points.back()) > 1e-6f * glm::length(size)) points.push_back(point);
  }
  if (glm::length(points.front() - points.back()) <= 1e-6f * glm::length(size)) points.pop_back();
  return points;
}

Points2 sharp(std::span<const vec2> points) {
  Points2 out;
  for (const vec2& point : points) out.insert(out.end(), {point, point});
  return out;
}

namespace {

/// Evaluates the Catmull-Rom spline between p1 and p2.
template <class Vec>
Vec catmull_rom(const Vec& p0, const Vec& p1, const Vec& p2, const Vec& p3, float t) {
  return 0.5f * (2.0f * p1 +
                 t * ((p2 - p0) + t * ((2.0f * p0 - 5.0f * p1 + 4.0f * p2 - p3) + t * (3.0f * (p1 - p2) + p3 - p0))));
}

template <class Vec>
std::vector<Vec> smooth_curve(std::span<const Vec> points, int segments, bool closed) {
  std::vector<Vec> out;
  const int n = int(points.size());
  if (n < 2) return {points.begin(), points.end()};
  segments = std::max(segments, 1);
  const auto at = [&](int i) { return points[std::size_t(closed ? (i + n) % n : std::clamp(i, 0, n - 1))]; };
  for (int i = 0; i < (closed ? n : n - 1); ++i)
    for (int s = 0; s < segments; ++s)
      out.push_back(catmull_rom(at(i - 1), at(i), at(i + 1), at(i + 2), float(s) / float(segments)));
  if (!closed) out.push_back(points.back());
  return out;
}

}  // namespace

Points2 smooth(std::span<const vec2> points, int segments) { return smooth_curve(points, segments, false); }
Points3 smooth(std::span<const vec3> points, int segments, bool closed) {
  return smooth_curve(points, segments, closed);
}

Points2 arc(vec2 centre, float radius, float from_deg, float to_deg, int segments) {
  Points2 points;
  segments = std::max(segments, 1);
  for (int i = 0; i <= segments; ++i) {
    const float a = radians(from_deg + (to_deg - from_deg) * float(i) / float(segments));
    points.push_back(centre + radius * vec2(std::cos(a), std::sin(a)));
  }
  return points;
}

Points2 join(std::initializer_list<Points2> pieces) {
  Points2 out;
  for (const Points2& piece : pieces) {
    if (piece.empty()) continue;
    // Parts that do not meet are connected by a straight line, sharp at both ends.
    if (!out.empty() && out.back() != piece.front()) out.insert(out.end(), {out.back(), piece.front()});
    out.insert(out.end(), piece.begin(), piece.end());
  }
  return out;
}

// --------------------------------------------------------------------------------------------- placing and joining

Mesh transformed(Mesh mesh, const glm::mat4& map) {
  const glm::mat3 linear(map), for_normals = glm::inverseTranspose(linear);
  for (vec3& position : mesh.positions) position = vec3(map * glm::vec4(position, 1.0f));
  for (vec3& normal : mesh.normals) normal = unit_or(for_normals * normal, {0, 1, 0});
  if (glm::determinant(linear) < 0.0f)
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
  return mesh;
}

Mesh moved(Mesh mesh, vec3 by) {
  for (vec3& position : mesh.positions) position += by;
  return mesh;
}

Mesh scaled(Mesh mesh, vec3 by) { return transformed(std::move(mesh), glm::scale(glm::mat4(1.0f), by)); }

Mesh turned(Mesh mesh, vec3 axis, float angle_deg) {
  return transformed(std::move(mesh), glm::rotate(glm::mat4(1.0f), radians(angle_deg), axis));
}

Mesh flipped(Mesh mesh) {
  for (vec3& normal : mesh.normals) normal = -normal;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
  return mesh;
}

void append(Mesh& mesh, const Mesh& part) {
  const std::uint32_t base = std::uint32_t(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
  mesh.normals.insert(mesh.normals.end(), part.normals.begin(), part.normals.end());
  mesh.uvs.insert(mesh.uvs.end(), part.uvs.begin(), part.uvs.end());
  for (const std::uint32_t index : part.indices) mesh.indices.push_back(base + index);
}

void recompute_normals(Mesh& mesh) {
  const std::vector<vec3> sums = summed_normals(mesh);
  mesh.normals.resize(sums.size(), {0, 1, 0});
  for (std::size_t i = 0; i < sums.size(); ++i) mesh.normals[i] = unit_or(sums[i], mesh.normals[i]);
}

void displace(Mesh& mesh, const std::function<vec3(vec3)>& move) {
  for (vec3& position : mesh.positions) position = move(position);
  recompute_normals(mesh);
}

void scale_uvs(Mesh& mesh, vec2 by) {
  for (vec2& uv : mesh.uvs) uv *= by;
}

void box_uvs(Mesh& mesh) {
  mesh.uvs.resize(mesh.positions.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const vec3 p = mesh.positions[i], n = glm::abs(mesh.normals[i]);
    if (n.y >= n.x && n.y >= n.z) {
      mesh.uvs[i] = {p.x, -p.z};
    } else {
      mesh.uvs[i] = n.x >= n.z ? vec2(p.z, p.y) : vec2(p.x, p.y);
    }
  }
}

// ----------------------------------------------------------------------------------------------------------- scenes

int add_texture(Scene& scene, Texture texture) {
  scene.textures.push_back(std::move(texture));
  return int(scene.textures.size()) - 1;
}

int add_material(Scene& scene, Material material) {
  scene.materials.push_back(std::move(material));
  return int(scene.materials.size()) - 1;
}

int MaterialMaker::plain(std::string name, glm::vec3 albedo, float strength, float exponent) const {
  return add_material(
      scene, {.name = std::move(name), .albedo = albedo, .specular_strength = strength, .specular_exponent = exponent});
}

int MaterialMaker::textured(std::string name, Texture texture, float strength, float exponent) const {
  return add_material(scene, {.name = std::move(name),
                              .albedo = glm::vec3(1.0f),
                              .texture = add_texture(scene, std::move(texture)),
                              .specular_strength = strength,
                              .specular_exponent = exponent});
}

int MaterialMaker::cut_out(std::string name, Texture texture) const {
  return add_material(scene, {.name = std::move(name),
                              .albedo = glm::vec3(1.0f),
                              .texture = add_texture(scene, std::move(texture)),
                              .alpha_mask = true});
}

int add_mesh(Scene& scene, std::string name, Mesh mesh, int material, int part_of) {
  mesh.name = std::move(name);
  mesh.material = material;
  mesh.object = part_of >= 0 ? part_of : int(scene.meshes.size());
  const int object = mesh.object;
  if (!mesh.indices.empty()) scene.meshes.push_back(std::move(mesh));
  return object;
}

int Detail::operator()(float base, int min) const { return std::max(min, int(std::lround(base * scale))); }

Scene build_to_count(int triangles, const std::function<Scene(const Detail&)>& build) {
  // builtin.h documents a factor of 2. 1.2 leaves a margin and is met at the second attempt.
  constexpr float kMaxFactor = 1.2f;
  constexpr int kMaxTries = 6;
  constexpr float kMaxRatio = 64.0f;  // max change in one attempt, since counts are rounded
  Detail detail;
  float count_before = 0.0f;
  for (int i = 0;; ++i) {
    Scene scene = build(detail);
    const float count = float(scene.triangle_count()), target = float(triangles);
    const bool is_close = count < kMaxFactor * target && count * kMaxFactor > target;
    if (is_close || i + 1 == kMaxTries || count == count_before) return scene;
    const float ratio = std::clamp(target / std::max(count, 1.0f), 1.0f / kMaxRatio, kMaxRatio);
    detail.scale *= std::sqrt(ratio);
    count_before = count;
  }
}

}  // namespace umbrage::shapes
