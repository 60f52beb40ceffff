// Caps: the edges of a part in a plane are joined to loops, which are filled with triangles. Hatching follows ISO 128:
// lines at 45 degrees whose distance follows the size of the cap, and neighbouring parts differ in direction or
// distance. The lines are borders between strips of a cap that are different objects: so looks draw them as
// they draw all lines, with hidden parts left out, on every device and as curves in files.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/color.h"
#include "scene/section_parts.h"
#include "scene/triangulate.h"

namespace umbrage {
namespace {

using PlaneEdge = std::pair<std::uint32_t, std::uint32_t>;  // numbers of vertices

/// Two directions in a plane, unit, with their cross product along its normal; the second one points up, if it can.
struct PlaneAxes {
  glm::dvec3 right, up;
  glm::dvec2 of(const glm::vec3& p) const { return {glm::dot(right, glm::dvec3(p)), glm::dot(up, glm::dvec3(p))}; }
};

PlaneAxes plane_axes(const glm::dvec3& normal, const glm::vec3& scene_up) {
  constexpr double kNearlyParallel = 0.9;
  glm::dvec3 up = glm::normalize(glm::dvec3(scene_up));
  if (std::abs(glm::dot(up, normal)) > kNearlyParallel) {
    int least = 0;
    for (int k = 1; k < 3; ++k)
      if (std::abs(normal[k]) < std::abs(normal[least])) least = k;
    up = glm::dvec3(0.0);
    up[least] = 1.0;
  }
  up = glm::normalize(up - glm::dot(up, normal) * normal);
  return {glm::cross(up, normal), up};
}

/// The edges of a part in a plane as loops.
struct CutLoops {
  std::vector<glm::vec3> positions;
  std::vector<Loop> loops;
  bool has_gaps = false;  ///< some of them have edges across small gaps
  bool is_open = false;   ///< some edges do not close and are left out
};

/// Returns the loops of edges of which each vertex has an even number.
std::vector<Loop> loops_of(const std::vector<PlaneEdge>& edges, std::size_t vertices) {
  std::vector<std::vector<std::uint32_t>> edges_at(vertices);
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    edges_at[edges[e].first].push_back(e);
    edges_at[edges[e].second].push_back(e);
  }
  std::vector<char> is_used(edges.size(), 0), is_on_path(vertices, 0);
  std::vector<Loop> loops;
  for (std::uint32_t start = 0; start < vertices; ++start) {
    Loop path = {start};
    while (true) {
      auto& here = edges_at[path.back()];
      while (!here.empty() && is_used[here.back()]) here.pop_back();
      if (here.empty()) break;
      const std::uint32_t e = here.back();
      is_used[e] = 1;
      is_on_path[path.back()] = 1;
      const std::uint32_t to = edges[e].first == path.back() ? edges[e].second : edges[e].first;
      if (!is_on_path[to]) {
        path.push_back(to);
        continue;
      }
      // A vertex where loops touch is in each of them once.
      const auto first = std::find(path.begin(), path.end(), to);
      for (auto k = first; k != path.end(); ++k) is_on_path[*k] = 0;
      if (path.end() - first > 2) loops.emplace_back(first, path.end());
      path.erase(first + 1, path.end());
    }
    is_on_path[start] = 0;
  }
  return loops;
}

/// Sets of connected vertices, with boxes around them.
class CutChains {
 public:
  CutChains(const std::vector<glm::vec3>& positions, const std::vector<PlaneEdge>& edges)
      : parents_(positions.size()), low_(positions), high_(positions) {
    std::iota(parents_.begin(), parents_.end(), 0u);
    for (const auto& [a, b] : edges) join(a, b);
  }
  std::uint32_t root(std::uint32_t k) { return root_of(parents_, k); }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a), b = root(b);
    parents_[b] = a;
    low_[a] = glm::min(low_[a], low_[b]), high_[a] = glm::max(high_[a], high_[b]);
  }
  /// Returns the size of the set of a vertex.
  float size(std::uint32_t k) { return glm::distance(low_[root(k)], high_[root(k)]); }

 private:
  std::vector<std::uint32_t> parents_;
  std::vector<glm::vec3> low_, high_;
};

/// Returns pairs of vertices that are closer than `tolerance`, with their distance, near ones first.
std::vector<std::pair<float, PlaneEdge>> near_pairs(const std::vector<glm::vec3>& positions,
                                                    std::vector<std::uint32_t> vertices, float tolerance) {
  std::sort(vertices.begin(), vertices.end(),
            [&](std::uint32_t a, std::uint32_t b) { return positions[a].x < positions[b].x; });
  std::vector<std::pair<float, PlaneEdge>> pairs;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::size_t j = i + 1; j < vertices.size(); ++j) {
      const glm::vec3 &a = positions[vertices[i]], &b = positions[vertices[j]];
      if (b.x - a.x > tolerance) break;
      if (const float d = glm::distance(a, b); d <= tolerance) pairs.push_back({d, {vertices[i], vertices[j]}});
    }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

/// Adds edges between vertices that have an odd number of them: across cracks of up to `crack`, and between the ends of
/// a chain that are closer than a tenth of its size. Removes chains that are still open. Sets has_gaps, if some of
/// these edges are longer than rounding, and is_open.
void close_gaps(float crack, std::vector<PlaneEdge>& edges, CutLoops& out) {
  constexpr float kMaxGap = 0.1f, kRounding = 3e-3f;  // of the chain; of `crack`
  const std::vector<glm::vec3>& positions = out.positions;
  std::vector<char> is_end(positions.size(), 0), is_open(positions.size(), 0);
  for (const auto& [from, to] : edges) is_end[from] ^= 1, is_end[to] ^= 1;
  CutChains chains(positions, edges);
  std::vector<std::uint32_t> ends;
  float longest = 0.0f;
  for (std::uint32_t k = 0; k < is_end.size(); ++k)
    if (is_end[k]) ends.push_back(k), longest = std::max(longest, chains.size(k));
  constexpr std::size_t kMaxEnds = 4000;  // with more, the part is no solid, and all pairs take too much memory
  const float tolerance = ends.size() > kMaxEnds ? crack : std::max(crack, kMaxGap * longest);
  for (const auto& [d, pair] : near_pairs(positions, ends, tolerance)) {
    const auto [a, b] = pair;
    if (!is_end[a] || !is_end[b]) continue;
    if (d > crack && (chains.root(a) != chains.root(b) || d > kMaxGap * chains.size(a))) continue;
    edges.push_back(pair);
    chains.join(a, b);
    is_end[a] = is_end[b] = 0;
    out.has_gaps |= d > kRounding * crack;
  }
  for (const std::uint32_t k : ends)
    if (is_end[k]) is_open[chains.root(k)] = 1;
  out.is_open = std::erase_if(edges, [&](const PlaneEdge& edge) { return bool(is_open[chains.root(edge.first)]); }) > 0;
}

CutLoops join_segments(std::span<const CutSegment> segments) {
  constexpr float kCrack = 3e-3f;  // max width, of the size of the cut
  CutLoops out;
  std::map<std::tuple<float, float, float>, std::uint32_t> numbers;
  glm::vec3 low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
  const auto number = [&](const glm::vec3& p) {
    const auto [found, is_new] = numbers.try_emplace({p.x + 0.0f, p.y + 0.0f, p.z + 0.0f}, out.positions.size());
    if (is_new) out.positions.push_back(p), low = glm::min(low, p), high = glm::max(high, p);
    return found->second;
  };
  std::map<PlaneEdge, int> net;  // of both directions
  for (const CutSegment& segment : segments) {
    const std::uint32_t from = number(segment.from), to = number(segment.to);
    net[{std::min(from, to), std::max(from, to)}] += from < to ? 1 : -1;
  }
  // An edge in both directions lies inside of the part; but a surface may also have two sides.
  std::vector<PlaneEdge> edges;
  for (const bool with_inner : {false, true}) {
    edges.clear();
    for (const auto& [edge, count] : net)
      if (with_inner || count != 0) edges.push_back(edge);
    out.has_gaps = false;
    close_gaps(kCrack * glm::distance(low, high), edges, out);
    if (!edges.empty() && !out.is_open) break;
  }
  out.loops = loops_of(edges, out.positions.size());
  return out;
}

/// A cap, a box around it, its area, and what follows from its neighbours.
struct SectionCap {
  PartedMesh cap;
  glm::vec3 low{std::numeric_limits<float>::max()}, high{std::numeric_limits<float>::lowest()};
  double area = 0.0;
  int level = 0;  ///< number of steps by which it is moved outward

  explicit SectionCap(PartedMesh from) : cap(std::move(from)) {
    const Mesh& mesh = cap.mesh;
    for (const glm::vec3& p : mesh.positions) low = glm::min(low, p), high = glm::max(high, p);
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      const glm::dvec3 a(mesh.positions[mesh.indices[i]]), b(mesh.positions[mesh.indices[i + 1]]),
          c(mesh.positions[mesh.indices[i + 2]]);
      area += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
  }
  std::uint32_t part() const { return cap.parts[0]; }
  bool meets(const SectionCap& other, float gap) const {
    for (int k = 0; k < 3; ++k)
      if (low[k] - gap > other.high[k] || other.low[k] - gap > high[k]) return false;
    return true;
  }
};

constexpr int kCapStyles = 6;

/// Sets the levels of caps, which are sorted by area, large ones first, and the styles of their parts.
void find_neighbors(std::vector<SectionCap>& caps, float radius, std::vector<SectionPart>& parts) {
  constexpr float kGap = 0.1f;  // of the radius: parts that are closer to each other are neighbours
  constexpr int kMaxLevel = 16;
  std::vector<char> has_style(parts.size(), 0);
  for (std::size_t k = 0; k < caps.size(); ++k) {
    SectionCap& cap = caps[k];
    std::array<int, kCapStyles> used{};
    for (const SectionCap& other : std::span(caps).first(k)) {
      if (other.part() == cap.part() || !cap.meets(other, kGap * radius)) continue;
      ++used[std::size_t(parts[other.part()].style)];
      if (other.cap.cap_of == cap.cap.cap_of && cap.meets(other, 0.0f))
        cap.level = std::max(cap.level, std::min(other.level + 1, kMaxLevel));
    }
    if (std::exchange(has_style[cap.part()], 1)) continue;
    parts[cap.part()].style = int(std::min_element(used.begin(), used.end()) - used.begin());
  }
}

/// The hatching of a style: its direction, and its distance relative to the usual one.
struct HatchStyle {
  bool falls;  ///< from the upper left to the lower right
  float distance;
};
constexpr HatchStyle kHatchStyles[kCapStyles] = {{false, 1.0f}, {true, 1.0f},  {false, 0.62f},
                                                 {true, 0.62f}, {false, 1.5f}, {true, 1.5f}};

/// Returns the distance of a cap's lines in scene units.
double hatch_distance(double area, float radius, int style) {
  constexpr double kOfCap = 0.12, kMin = 0.022, kMax = 0.045;  // of the cap's size; of the radius
  return std::clamp(kOfCap * std::sqrt(area), kMin * radius, kMax * radius) * kHatchStyles[style].distance;
}

using ConvexPolygon = std::vector<glm::dvec3>;

/// Returns the part of a convex polygon with dot(direction, p) >= limit.
ConvexPolygon clipped_polygon(const ConvexPolygon& polygon, const glm::dvec3& direction, double limit) {
  ConvexPolygon out;
  for (std::size_t k = 0, last = polygon.size() - 1; k < polygon.size(); last = k++) {
    const double from = glm::dot(direction, polygon[last]) - limit, to = glm::dot(direction, polygon[k]) - limit;
    if ((from < 0.0) != (to < 0.0)) out.push_back(polygon[last] + (from / (from - to)) * (polygon[k] - polygon[last]));
    if (to >= 0.0) out.push_back(polygon[k]);
  }
  return out;
}

void append_polygon(const ConvexPolygon& polygon, const glm::vec3& normal, Mesh& to) {
  if (polygon.size() < 3) return;
  const auto first = std::uint32_t(to.positions.size());
  for (const glm::dvec3& p : polygon) to.positions.emplace_back(p), to.normals.push_back(normal);
  for (std::uint32_t k = 1; k + 1 < polygon.size(); ++k)
    to.indices.insert(to.indices.end(), {first, first + k, first + k + 1});
}

/// Appends a cap to meshes in turn, one for every second strip between lines at `distance` across `direction`.
void append_strips(const Mesh& cap, const glm::dvec3& direction, double distance, const glm::vec3& normal,
                   std::array<Mesh, 2>& to) {
  for (std::size_t i = 0; i < cap.indices.size(); i += 3) {
    ConvexPolygon rest;
    double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
    for (std::size_t k = 0; k < 3; ++k) {
      rest.emplace_back(cap.positions[cap.indices[i + k]]);
      low = std::min(low, glm::dot(direction, rest.back()));
      high = std::max(high, glm::dot(direction, rest.back()));
    }
    const double last = std::floor(high / distance);
    for (double strip = std::floor(low / distance); strip <= last && rest.size() > 2; ++strip) {
      const double end = (strip + 1.0) * distance;
      append_polygon(clipped_polygon(rest, -direction, -end), normal, to[std::fmod(strip, 2.0) != 0.0]);
      rest = clipped_polygon(rest, direction, end);
    }
  }
}

/// Adds the material of a style, unless it is there. Returns its index.
int cap_material(const SectionSettings& settings, int style, std::array<int, kCapStyles>& known, Scene& scene) {
  static constexpr std::array<float, 3> kColors[kCapStyles] = {{0.87f, 0.65f, 0.42f}, {0.51f, 0.68f, 0.80f},
                                                               {0.80f, 0.49f, 0.44f}, {0.57f, 0.72f, 0.55f},
                                                               {0.72f, 0.62f, 0.78f}, {0.83f, 0.77f, 0.50f}};
  static constexpr float kShades[kCapStyles] = {0.72f, 0.5f, 0.86f, 0.6f, 0.42f, 0.95f};
  int& material = known[std::size_t(style)];
  if (material >= 0) return material;
  material = int(scene.materials.size());
  Material made{.name = "section " + std::to_string(style + 1)};
  const auto& c = kColors[style];
  made.albedo = settings.tint ? *settings.tint * (settings.hatched ? 1.0f : kShades[style])
                              : glm::vec3(linear_from_srgb(c[0]), linear_from_srgb(c[1]), linear_from_srgb(c[2]));
  if (settings.is_blank) made.emission = glm::vec3(1.0f);
  scene.materials.push_back(std::move(made));
  return material;
}

}  // namespace

std::vector<PartedMesh> caps_of(const CutPlane& plane, std::vector<CutSegment> segments, const glm::vec3& up,
                                std::vector<SectionPart>& parts) {
  std::stable_sort(segments.begin(), segments.end(), [](const auto& a, const auto& b) { return a.part < b.part; });
  const PlaneAxes axes = plane_axes(plane.normal, up);
  std::vector<PartedMesh> caps;
  for (std::size_t first = 0, end = 0; first < segments.size(); first = end) {
    const std::uint32_t part = segments[first].part;
    while (end < segments.size() && segments[end].part == part) ++end;
    CutLoops loops = join_segments(std::span(segments).subspan(first, end - first));
    parts[part].is_open |= loops.is_open;
    parts[part].has_gaps |= loops.has_gaps;
    std::vector<glm::dvec2> points;
    for (const glm::vec3& p : loops.positions) points.push_back(axes.of(p));
    PartedMesh cap;
    for (const auto& triangle : triangulate(points, loops.loops))
      cap.mesh.indices.insert(cap.mesh.indices.end(), triangle.begin(), triangle.end());
    if (cap.mesh.indices.empty()) continue;
    cap.mesh.normals.assign(loops.positions.size(), glm::vec3(plane.normal));
    cap.mesh.positions = std::move(loops.positions);
    cap.parts.assign(cap.mesh.indices.size() / 3, part);
    caps.push_back(std::move(cap));
  }
  return caps;
}

void add_caps(const SectionSettings& settings, std::span<const CutPlane> planes, std::vector<PartedMesh> meshes,
              std::vector<SectionPart>& parts, float radius, int object, Scene& scene) {
  constexpr float kStep = 1e-5f;  // of the radius; as coplanar faces are moved
  std::vector<SectionCap> caps;
  for (PartedMesh& mesh : meshes)
    if (!mesh.parts.empty()) caps.emplace_back(std::move(mesh));
  std::stable_sort(caps.begin(), caps.end(), [](const auto& a, const auto& b) { return a.area > b.area; });
  find_neighbors(caps, radius, parts);

  std::array<int, kCapStyles> materials;
  materials.fill(-1);
  struct PartCaps {
    std::array<Mesh, 2> meshes;
    double distance;  ///< of the hatching
  };
  std::map<std::uint32_t, PartCaps> made;  // by part
  for (SectionCap& each : caps) {
    const int style = parts[each.part()].style;
    const CutPlane& plane = planes[std::size_t(each.cap.cap_of)];
    const glm::vec3 normal(plane.normal);
    Mesh& cap = each.cap.mesh;
    for (glm::vec3& p : cap.positions) p += float(each.level) * kStep * radius * normal;
    const auto [found, is_new] = made.try_emplace(each.part());
    auto& [to, distance] = found->second;
    if (is_new) {
      distance = hatch_distance(each.area, radius, style);
      for (Mesh& mesh : to)
        mesh.name = "section", mesh.object = object++, mesh.material = cap_material(settings, style, materials, scene);
    }
    if (settings.hatched) {
      const PlaneAxes axes = plane_axes(plane.normal, scene.up);
      const glm::dvec3 across = glm::normalize(kHatchStyles[style].falls ? axes.right + axes.up : axes.right - axes.up);
      append_strips(cap, across, distance, normal, to);
    } else {
      const auto first = std::uint32_t(to[0].positions.size());
      to[0].positions.insert(to[0].positions.end(), cap.positions.begin(), cap.positions.end());
      to[0].normals.insert(to[0].normals.end(), cap.normals.begin(), cap.normals.end());
      for (const std::uint32_t index : cap.indices) to[0].indices.push_back(first + index);
    }
  }
  for (auto& [part, of_part] : made)
    for (Mesh& mesh : of_part.meshes)
      if (!mesh.indices.empty()) scene.meshes.push_back(std::move(mesh));
}

}  // namespace umbrage
