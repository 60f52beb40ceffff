// Points are spread over the surfaces of each object by area. k-means clusters them: Lloyd's steps from a
// farthest-first start. Each cluster becomes an occluder with the area of its points.
#include "scene/occluders.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numbers>

namespace umbrage {
namespace {

constexpr int kPointsPerOccluder = 64;
constexpr int kLloydSteps = 20;
// Distance that opposite normals add between points, in units of a cluster's diameter. It separates the faces of an
// edge and the sides of a wall.
constexpr float kNormalDistance = 0.5f;
constexpr double kDiscOverlap = 0.5;  // fraction of a disc's area that counts: discs of a cloud cover twice its area

/// A point of a surface, in a space in which the scene has about unit size, so that squares stay in the range of
/// floats. The normal is unit, or 0 for the surface of a sphere.
struct SurfacePoint {
  glm::vec3 position, normal;
};

/// That space: positions are (world - center) / scale.
struct UnitSpace {
  glm::dvec3 center{0.0};
  double scale = 1.0;
};

/// A part of an object's surface: a triangle of a mesh, or one of its points.
struct Part {
  const Mesh* mesh = nullptr;
  std::uint32_t index = 0;
  double area_up_to = 0.0;  // of the object: this part and all before it
};

using Object = std::vector<Part>;

double area_of(const Object& object) { return object.empty() ? 0.0 : object.back().area_up_to; }

/// Returns the cross product of two edges of a triangle, on the side of the vertex normals.
glm::dvec3 cross_of(const Mesh& mesh, std::uint32_t triangle) {
  const std::uint32_t* corner = &mesh.indices[3 * std::size_t(triangle)];
  const glm::dvec3 a = mesh.positions[corner[0]], b = mesh.positions[corner[1]], c = mesh.positions[corner[2]];
  const glm::dvec3 cross = glm::cross(b - a, c - a);
  if (mesh.normals.size() != mesh.positions.size()) return cross;
  const glm::dvec3 side = mesh.normals[corner[0]] + mesh.normals[corner[1]] + mesh.normals[corner[2]];
  return glm::dot(cross, side) < 0.0 ? -cross : cross;
}

double area_of(const Mesh& mesh, std::uint32_t index) {
  if (!mesh.points) return 0.5 * glm::length(cross_of(mesh, index));
  const double radius = index < mesh.radii.size() ? double(mesh.radii[index]) : 0.0;
  return std::numbers::pi * radius * radius * (mesh.spheres ? 4.0 : kDiscOverlap);
}

void add_parts(const Mesh& mesh, Object& object) {
  const std::size_t count = mesh.points ? mesh.positions.size() : mesh.indices.size() / 3;
  double sum = area_of(object);
  for (std::size_t k = 0; k < count; ++k) {
    const double area = area_of(mesh, std::uint32_t(k));
    if (!(area > 0.0 && std::isfinite(area))) continue;
    sum += area;
    object.push_back({&mesh, std::uint32_t(k), sum});
  }
}

/// Returns the objects of a scene that have a surface, in the order of their ids; one for all if they exceed `count`.
std::vector<Object> objects_of(const Scene& scene, int count) {
  std::map<int, std::vector<const Mesh*>> meshes;
  for (const Mesh& mesh : scene.meshes) {
    const bool has_material = std::size_t(mesh.material) < scene.materials.size();
    const Material* material = has_material ? &scene.materials[std::size_t(mesh.material)] : nullptr;
    if (!(material && material->blended && material->opacity < kOpaque)) meshes[mesh.object].push_back(&mesh);
  }
  std::vector<Object> objects;
  const bool joined = int(meshes.size()) > count;
  for (const auto& [id, of_object] : meshes) {
    if (objects.empty() || !(joined || objects.back().empty())) objects.emplace_back();
    for (const Mesh* mesh : of_object) add_parts(*mesh, objects.back());
  }
  if (!objects.empty() && objects.back().empty()) objects.pop_back();
  return objects;
}

SurfacePoint point_of(const Part& part, const UnitSpace& space, double u, double v) {
  const Mesh& mesh = *part.mesh;
  const auto unit_of = [&](const glm::dvec3& world) { return glm::vec3((world - space.center) / space.scale); };
  if (mesh.points)
    return {unit_of(mesh.positions[part.index]),
            mesh.normals.size() == mesh.positions.size() ? mesh.normals[part.index] : glm::vec3(0.0f)};
  const std::uint32_t* corner = &mesh.indices[3 * std::size_t(part.index)];
  const glm::dvec3 a = mesh.positions[corner[0]], b = mesh.positions[corner[1]], c = mesh.positions[corner[2]];
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  return {unit_of(a + u * (b - a) + v * (c - a)), glm::vec3(glm::normalize(cross_of(mesh, part.index)))};
}

/// Returns points at equal steps of area.
std::vector<SurfacePoint> points_on(const Object& object, const UnitSpace& space, int count) {
  std::vector<SurfacePoint> points;
  points.reserve(std::size_t(count));
  std::size_t part = 0;
  for (int k = 0; k < count; ++k) {
    const double area = area_of(object) * ((k + 0.5) / count);
    while (part + 1 < object.size() && object[part].area_up_to < area) ++part;
    // The two-dimensional golden-ratio sequence [Roberts 2018].
    const auto fraction = [k](double step) { return std::fmod(0.5 + step * k, 1.0); };
    points.push_back(point_of(object[part], space, fraction(0.7548776662466927), fraction(0.5698402909980532)));
  }
  return points;
}

/// Returns the squared distance of points, in which a normal counts `normal2` times its squared difference.
float distance2(const SurfacePoint& a, const SurfacePoint& b, float normal2) {
  const glm::vec3 way = a.position - b.position, turn = a.normal - b.normal;
  return glm::dot(way, way) + normal2 * glm::dot(turn, turn);
}

/// Returns the first centres: each is the point that is farthest from those before it.
std::vector<SurfacePoint> first_centers(const std::vector<SurfacePoint>& points, int count, float normal2) {
  std::vector<SurfacePoint> centers = {points[0]};
  std::vector<float> nearest(points.size(), std::numeric_limits<float>::infinity());
  while (int(centers.size()) < count) {
    for (std::size_t k = 0; k < points.size(); ++k)
      nearest[k] = std::min(nearest[k], distance2(points[k], centers.back(), normal2));
    const auto farthest = std::max_element(nearest.begin(), nearest.end());
    if (!(*farthest > 0.0f)) break;
    centers.push_back(points[std::size_t(farthest - nearest.begin())]);
  }
  return centers;
}

/// Returns the sums of the points of each cluster and their number.
struct Cluster {
  glm::dvec3 positions{0.0}, normals{0.0};
  int points = 0;
};

std::vector<Cluster> clusters_of(const std::vector<SurfacePoint>& points, int count, float normal2) {
  std::vector<SurfacePoint> centers = first_centers(points, count, normal2);
  std::vector<int> nearest(points.size(), 0);
  std::vector<Cluster> clusters;
  for (int step = 0; step < kLloydSteps; ++step) {
    tbb::parallel_for(std::size_t(0), points.size(), [&](std::size_t k) {
      float best = std::numeric_limits<float>::infinity();
      for (std::size_t c = 0; c < centers.size(); ++c)
        if (const float d = distance2(points[k], centers[c], normal2); d < best) {
          best = d;
          nearest[k] = int(c);
        }
    });
    clusters.assign(centers.size(), {});
    for (std::size_t k = 0; k < points.size(); ++k) {
      Cluster& cluster = clusters[std::size_t(nearest[k])];
      cluster.positions += glm::dvec3(points[k].position);
      cluster.normals += glm::dvec3(points[k].normal);
      ++cluster.points;
    }
    for (std::size_t c = 0; c < centers.size(); ++c)
      if (const double n = clusters[c].points; n > 0.0)
        centers[c] = {glm::vec3(clusters[c].positions / n), glm::vec3(clusters[c].normals / n)};
  }
  return clusters;
}

/// Adds the occluders of one object.
void add_occluders(const Object& object, const UnitSpace& space, int count, OccluderSet& set) {
  const std::vector<SurfacePoint> points = points_on(object, space, count * kPointsPerOccluder);
  const double area = area_of(object), diameter = 2.0 * std::sqrt(area / (std::numbers::pi * count)) / space.scale;
  const double opposite = kNormalDistance * diameter / 2.0;  // opposite unit normals differ by 2
  for (const Cluster& cluster : clusters_of(points, count, float(opposite * opposite))) {
    if (cluster.points == 0) continue;
    const double n = cluster.points, fraction = n / double(points.size());
    set.occluders.push_back({.center = glm::vec3(space.center + space.scale * cluster.positions / n),
                             .radius = float(std::sqrt(area / (4.0 * std::numbers::pi) * fraction)),
                             .mean_normal = glm::vec3(cluster.normals / n),
                             .object = set.objects});
  }
  ++set.objects;
}

}  // namespace

OccluderSet make_occluders(const Scene& scene, int count) {
  count = std::clamp(count, 1, kMaxOccluders);
  const UnitSpace space = {scene.center(), std::max(double(scene.radius()), 1e-30)};
  const std::vector<Object> objects = objects_of(scene, count);
  const auto is_ground = [&](const Object& object) {
    return scene.ground_object >= 0 && object.front().mesh->object == scene.ground_object;
  };
  double model = 0.0;
  for (const Object& object : objects) model += is_ground(object) ? 0.0 : std::sqrt(area_of(object));
  // The ground is many times as large as the model, but has no more occluders.
  const auto root_of = [&](const Object& object) {
    const double root = std::sqrt(area_of(object));
    return is_ground(object) && model > 0.0 ? std::min(root, model) : root;
  };
  double roots = 0.0;
  for (const Object& object : objects) roots += root_of(object);
  OccluderSet set;
  const int more = count - int(objects.size());  // beyond one for each object
  constexpr double kRounding = 1e-6;
  for (const Object& object : objects)
    add_occluders(object, space, 1 + int(double(more) * root_of(object) / roots + kRounding), set);
  return set;
}

std::shared_ptr<const OccluderSet> occluders_of(const Scene& scene, int count, MadeOccluders& made) {
  if (count == 0) return nullptr;
  if (made.count != count || !made.set)
    made = {count, std::make_shared<const OccluderSet>(make_occluders(scene, count))};
  return made.set;
}

}  // namespace umbrage
