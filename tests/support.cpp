#include "support.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <numbers>

#include "build_paths.h"
#include "core/check.h"
#include "core/gbuffer.h"
#include "kernel/isa.h"

namespace umbrage::test {

const char* const kProgram = UMBRAGE_PROGRAM;
const char* const kFaultyImport = UMBRAGE_FAULTY_IMPORT;
const char* const kSourceFolder = UMBRAGE_SOURCE;

std::string first_difference(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height || a.names != b.names) return "names or size";
  for (std::size_t p = 0; p < a.planes.size(); ++p)
    for (int y = 0; y < a.height; ++y)
      if (std::memcmp(a.planes[p].row(y), b.planes[p].row(y), std::size_t(a.width) * sizeof(float)) != 0)
        return fmt::format("{}, row {}", a.names[p], y);
  return "";
}

double scale_of(const Plane& plane) {
  double scale = 1.0;
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x)
      if (const double value = std::fabs(plane.at(x, y)); std::isfinite(value)) scale = std::max(scale, value);
  return scale;
}

std::vector<std::string_view> isas() {
  choose_isa("");
  const auto& usable = usable_isas();
  return {std::find(usable.begin(), usable.end(), isa_in_use()), usable.end()};
}

std::vector<std::string_view> lane_isas() {
  std::vector<std::string_view> names = isas();
  names.pop_back();
  return names;
}

PixelRay ray_of(const PictureInfo& info, int x, int y) {
  const Camera& c = info.camera;
  const glm::dmat4 view(c.view_from_world);
  const glm::dmat3 turn = glm::transpose(glm::dmat3(view));
  const glm::dvec3 eye = -(turn * glm::dvec3(view[3]));
  const double u = c.left + (x + 0.5) / info.width * (double(c.right) - c.left);
  const double v = c.top - (y + 0.5) / info.height * (double(c.top) - c.bottom);
  if (c.projection == Projection::kPerspective) return {eye, turn * glm::dvec3(u, v, -1.0)};
  return {eye + turn * glm::dvec3(u, v, 0.0), turn * glm::dvec3(0.0, 0.0, -1.0)};
}

int tilt_about_x(GBuffer& g, double tilt_deg) {
  const Camera& camera = g.info.camera;
  const int width = g.info.width, height = g.info.height;
  const double tilt = tilt_deg * std::numbers::pi / 180.0, ny = std::sin(tilt), nz = std::cos(tilt);
  int horizon = 0;
  for (int y = height - 1; y >= 0; --y)
    for (int x = 0; x < width; ++x) {
      const double v = camera.top - (camera.top - camera.bottom) * (y + 0.5) / height;
      const double depth =
          camera.projection == Projection::kOrthographic ? 40.0 + ny / nz * v : 5.0 * nz / (nz - ny * v);
      if (depth < 0.0) horizon = std::max(horizon, y + 1);
      g.layers[0].plane("depth").at(x, y) = depth > 0.0 ? float(depth) : std::numeric_limits<float>::infinity();
      g.layers[0].plane("normal.y").at(x, y) = float(ny);
      g.layers[0].plane("normal.z").at(x, y) = float(nz);
    }
  return horizon;
}

double volume(const Mesh& mesh) {
  double sum = 0.0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const glm::dvec3 a = mesh.positions[mesh.indices[i]], b = mesh.positions[mesh.indices[i + 1]],
                     c = mesh.positions[mesh.indices[i + 2]];
    sum += glm::dot(a, glm::cross(b, c)) / 6.0;
  }
  return sum;
}

unsigned hash(unsigned v) {
  v = (v ^ (v >> 16)) * 0x7feb352du;
  v = (v ^ (v >> 15)) * 0x846ca68bu;
  return v ^ (v >> 16);
}

GBuffer empty_gbuffer(int width, int height) {
  GBuffer g;
  g.info.width = width;
  g.info.height = height;
  g.info.camera = perspective_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 40.0f, float(width) / float(height));
  g.info.depth_min = 1.0f;
  g.info.depth_max = 10.0f;
  g.info.scene_radius = 5.0f;
  g.info.lights.push_back({.direction = glm::normalize(glm::vec3(-1, 1, 1)), .color = glm::vec3(0.7f)});
  g.layers.emplace_back(width, height);
  return g;
}

GBuffer bumpy_gbuffer(int width, int height, unsigned seed) {
  GBuffer g = empty_gbuffer(width, height);
  for (int c = 0; c < 3; ++c)  // brighter from above, and negative for some normals
    g.info.ambient_shape.by_color[std::size_t(c)] =
        glm::mat4(0.05f, 0.02f, 0.01f, 0.03f, 0.02f, -0.03f, 0.04f, 0.3f, 0.01f, 0.04f, -0.02f, -0.05f * float(c),
                  0.03f, 0.3f, -0.05f * float(c), 0.0f);
  const std::vector<Occluder> occluders = {{{-1.5f, 0.5f, -5.0f}, 0.7f, {0.2f, 0.6f, 0.3f}, 0},
                                           {{1.0f, -1.0f, -8.0f}, 0.9f, {0.0f, 0.0f, 0.0f}, 0},
                                           {{0.5f, 1.0f, -3.0f}, 0.4f, {0.0f, -1.0f, 0.0f}, 1},
                                           {{0.0f, 0.0f, -12.0f}, 3.0f, {0.0f, 0.0f, 0.9f}, 2}};
  g.info.occluders = std::make_shared<const OccluderSet>(OccluderSet{occluders, 3});
  Image& image = g.layers[0];
  const auto random = [&](unsigned x, unsigned y, unsigned k) {
    return float(hash(hash(hash(seed + k) + x) + y) >> 8) * 0x1p-24f;
  };
  for (const char* name : {"depth", "normal.x", "normal.y", "normal.z", "albedo.r", "albedo.g", "albedo.b", "specular",
                           "shininess", "shadow", "object_id", "material_id"})
    image.add(name);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const unsigned cell = unsigned(x / 13 + 57 * (y / 9));
      const bool hole = hash(seed ^ cell) % 5 == 0;
      const float base = 2.0f + 6.0f * float(hash(seed * 3 + cell) % 8) / 8.0f;
      const float depth = base + 0.3f * std::sin(0.21f * x) * std::cos(0.17f * y) + 0.002f * random(x, y, 1);
      image.plane("depth").at(x, y) = hole ? std::numeric_limits<float>::infinity() : depth;
      const glm::vec3 n =
          glm::normalize(glm::vec3(random(x, y, 2) - 0.5f, random(x, y, 3) - 0.5f, 0.3f + random(x, y, 4)));
      for (int c = 0; c < 3; ++c) {
        image.planes[1 + c].at(x, y) = hole ? 0.0f : n[c];
        image.planes[4 + c].at(x, y) = hole ? 0.0f : random(x, y, 5 + c);
      }
      image.plane("specular").at(x, y) = random(x, y, 8);
      image.plane("shininess").at(x, y) = 1.0f + 100.0f * random(x, y, 9);
      image.plane("shadow").at(x, y) = random(x, y, 10) < 0.5f ? 0.0f : 1.0f;
      image.plane("object_id").at(x, y) = image.plane("material_id").at(x, y) = hole ? -1.0f : float(cell);
    }
  return g;
}

GBuffer hostile_gbuffer(int width, int height, unsigned seed) {
  GBuffer g = bumpy_gbuffer(width, height, seed);
  const float infinity = std::numeric_limits<float>::infinity();
  const float odd[] = {std::nanf(""), infinity, -infinity, 0.0f, -0.0f, -1.0f, 1e30f, -1e30f, 1e-40f, 3.4e38f};
  for (std::size_t p = 0; p < g.layers[0].planes.size(); ++p)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        if (const unsigned r = hash(seed + 977u * unsigned(p) + 31u * x + 7919u * y); r % 3 == 0)
          g.layers[0].planes[p].at(x, y) = odd[(r / 3) % std::size(odd)];
  return g;
}

Difference difference(const Plane& a, const Plane& b, double bound) {
  check_equal(a.width, b.width, "widths of compared planes");
  check_equal(a.height, b.height, "heights of compared planes");
  Difference d;
  double sum = 0.0;
  long over = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      const float u = a.at(x, y), v = b.at(x, y);
      double e = 0.0;
      if (std::isnan(u) != std::isnan(v))
        e = std::numeric_limits<double>::infinity();
      else if (u != v && !std::isnan(u))
        e = std::fabs(double(u) - double(v));
      d.max = std::max(d.max, e);
      sum += e;
      over += e > bound;
    }
  const double count = std::max(1.0, double(a.width) * a.height);
  d.mean = sum / count;
  d.fraction_over = double(over) / count;
  return d;
}

}  // namespace umbrage::test
