// Tests of sections: what remains of bodies with known volumes, and their caps.
#include "scene/section.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <tuple>

#include "generators/shapes.h"
#include "scene/finish.h"
#include "scene/framing.h"
#include "scene/triangulate.h"
#include "support.h"

namespace umbrage {
namespace {

using test::hash;

/// Returns a finished scene of meshes.
Scene scene_of(std::vector<Mesh> meshes) {
  Scene scene;
  scene.name = "test";
  scene.materials.emplace_back();
  scene.meshes = std::move(meshes);
  EXPECT_EQ(finish_scene(scene), 0u);
  return scene;
}

Mesh moved(Mesh mesh, const glm::vec3& by, int object = 0) {
  for (glm::vec3& p : mesh.positions) p += by;
  mesh.object = object;
  return mesh;
}

Mesh reversed(Mesh mesh) {
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) std::swap(mesh.indices[i], mesh.indices[i + 1]);
  for (glm::vec3& normal : mesh.normals) normal = -normal;
  return mesh;
}

/// Returns the mesh with rounded positions, so that the seams of its surface are closed exactly.
Mesh closed(Mesh mesh) {
  for (glm::vec3& p : mesh.positions) p = glm::round(p * 4096.0f) / 4096.0f;
  Mesh out = mesh;
  out.indices.clear();
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const glm::vec3 &a = mesh.positions[mesh.indices[i]], &b = mesh.positions[mesh.indices[i + 1]],
                    &c = mesh.positions[mesh.indices[i + 2]];
    if (a != b && b != c && c != a) out.indices.insert(out.indices.end(), &mesh.indices[i], &mesh.indices[i] + 3);
  }
  return out;
}

/// Returns the mesh with three vertices of its own for each triangle, as in STL files.
Mesh unwelded(const Mesh& mesh) {
  Mesh out;
  for (const std::uint32_t k : mesh.indices) {
    out.indices.push_back(std::uint32_t(out.positions.size()));
    out.positions.push_back(mesh.positions[k]);
    out.normals.push_back(mesh.normals[k]);
  }
  return out;
}

Scene cut(Scene scene, const std::vector<std::string>& texts, bool hatched = false) {
  SectionSettings settings;
  settings.hatched = hatched;
  for (const std::string& text : texts) settings.planes.push_back(parse_sections(text)->at(0));
  const auto done = cut_scene(settings, scene);
  EXPECT_TRUE(done) << done.error().message;
  return scene;
}

std::string refusal(Scene scene, const std::string& text) {
  SectionSettings settings;
  settings.planes = *parse_sections(text);
  const auto done = cut_scene(settings, scene);
  return done ? "" : done.error().message;
}

bool is_cap(const Mesh& mesh) { return mesh.name == "section"; }

/// Returns a scene's volume, with that of all meshes.
double volume_of(const Scene& scene) {
  double sum = 0.0;
  for (const Mesh& mesh : scene.meshes) sum += test::volume(mesh);
  return sum;
}

double cap_area(const Scene& scene) {
  double sum = 0.0;
  for (const Mesh& mesh : scene.meshes)
    for (std::size_t i = 0; is_cap(mesh) && i < mesh.indices.size(); i += 3) {
      const glm::dvec3 a(mesh.positions[mesh.indices[i]]), b(mesh.positions[mesh.indices[i + 1]]),
          c(mesh.positions[mesh.indices[i + 2]]);
      sum += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
  return sum;
}

/// Returns the number of edges of triangles, by positions, that no triangle runs through in the other direction.
std::size_t open_edges(const Scene& scene) {
  using Point = std::tuple<float, float, float>;
  std::map<std::pair<Point, Point>, int> edges;
  const auto point = [](const glm::vec3& p) { return Point(p.x + 0.0f, p.y + 0.0f, p.z + 0.0f); };
  for (const Mesh& mesh : scene.meshes)
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
      const std::size_t next = i % 3 == 2 ? i - 2 : i + 1;
      const Point a = point(mesh.positions[mesh.indices[i]]), b = point(mesh.positions[mesh.indices[next]]);
      edges[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  return std::size_t(std::count_if(edges.begin(), edges.end(), [](const auto& edge) { return edge.second != 0; }));
}

std::size_t cap_count(const Scene& scene) {
  return std::size_t(std::count_if(scene.meshes.begin(), scene.meshes.end(), is_cap));
}

TEST(Section, CutsACube) {
  const Scene scene = scene_of({shapes::box(glm::vec3(0), glm::vec3(1))});
  for (const char* text : {"x<0.4", "y<0.4", "z<0.4", "1,0,0,0.4", "0,2,0,0.8", "0,0,1,0.4", "x<40%"}) {
    const Scene below = cut(scene, {text});
    EXPECT_NEAR(volume_of(below), 0.4, 1e-6) << text;
    EXPECT_NEAR(cap_area(below), 1.0, 1e-6) << text;
    EXPECT_EQ(open_edges(below), 0u) << text;
    EXPECT_EQ(below.warnings.size(), 0u);
  }
  EXPECT_NEAR(volume_of(cut(scene, {"x>0.4"})), 0.6, 1e-6);
  EXPECT_NEAR(volume_of(cut(scene, {"x>0.5", "y>0.5", "z>0.5"})), 0.125, 1e-6);
  EXPECT_EQ(open_edges(cut(scene, {"x>0.5", "y>0.5", "z>0.5"})), 0u);
  EXPECT_NEAR(volume_of(cut(scene, {"1,1,1,0.5"})), 0.125 / 6.0, 1e-7) << "a corner";
}

TEST(Section, CapsLieInThePlaneAndFaceWhatWasRemoved) {
  const Scene scene = cut(scene_of({closed(shapes::torus(1.0f, 0.3f, 40, 20))}), {"x>0.1"});
  ASSERT_EQ(cap_count(scene), 1u) << "both discs are one part's";
  for (const Mesh& mesh : scene.meshes) {
    if (!is_cap(mesh)) continue;
    for (const glm::vec3& p : mesh.positions) EXPECT_EQ(p.x, 0.1f);
    for (const glm::vec3& n : mesh.normals) EXPECT_EQ(n, glm::vec3(-1, 0, 0));
    EXPECT_NE(mesh.object, scene.meshes[0].object);
    EXPECT_NE(mesh.material, scene.meshes[0].material);
  }
}

TEST(Section, KeepsTheFarSideForTheDefaultView) {
  const Scene scene = scene_of({shapes::box(glm::vec3(0), glm::vec3(1))});
  const glm::vec3 eye = frame_scene(scene, {}, 1, 1).eye();
  for (const char axis : {'x', 'y', 'z'})
    for (const char* at : {"5%", "30%", "95%"}) {
      const Scene far = cut(scene, {fmt::format("{}={}", axis, at)});
      const float front = eye[axis - 'x'] > 0.5f ? 1.0f : 0.0f;
      for (const Mesh& mesh : far.meshes)
        for (const glm::vec3& p : mesh.positions) EXPECT_NE(p[axis - 'x'], front) << axis << at;
    }
}

TEST(Section, LeavesCavitiesOfClosedPartsEmpty) {
  const Mesh outer = closed(shapes::cube_sphere(24, [](glm::vec3) { return 1.0f; }));
  const Mesh inner = closed(shapes::cube_sphere(24, [](glm::vec3) { return 0.5f; }));
  const double solid = cap_area(cut(scene_of({outer}), {"x<0.1"})),
               hollow = cap_area(cut(scene_of({inner}), {"x<0.1"}));
  EXPECT_NEAR(solid, M_PI * (1.0 - 0.01), 0.02);
  const Scene shell = cut(scene_of({outer, reversed(inner)}), {"x<0.1"});
  EXPECT_NEAR(cap_area(shell), solid - hollow, 1e-5);
  EXPECT_EQ(cap_count(shell), 1u) << "a cavity is no part";
  EXPECT_EQ(open_edges(shell), 0u);
  // A ball in a ball, of which each is a part.
  const Scene both = cut(scene_of({outer, moved(inner, glm::vec3(0), 1)}), {"x<0.1"});
  EXPECT_EQ(cap_count(both), 2u);
  EXPECT_NEAR(cap_area(both), solid + hollow, 1e-5);
  std::vector<const Mesh*> caps;
  for (const Mesh& mesh : both.meshes)
    if (is_cap(mesh)) caps.push_back(&mesh);
  EXPECT_NE(caps[0]->material, caps[1]->material) << "neighbours differ";
  EXPECT_NE(caps[0]->object, caps[1]->object);
  const auto front = [](const Mesh* cap) { return cap->positions[0].x; };
  EXPECT_GT(std::abs(front(caps[0]) - front(caps[1])), 5e-6f) << "the inner one hides the outer one";
  EXPECT_LT(std::abs(front(caps[0]) - front(caps[1])), 1e-4f);
}

TEST(Section, RandomPlanesDivideABodyIntoItsHalves) {
  std::vector<std::pair<const char*, Mesh>> bodies = {
      {"torus", closed(shapes::torus(1.0f, 0.4f, 48, 24))},
      {"soup", unwelded(closed(shapes::torus(1.0f, 0.4f, 31, 17)))},
      {"stone",
       closed(shapes::cube_sphere(16, [](glm::vec3 d) { return 1.0f + 0.3f * std::sin(9.0f * d.x + 7.0f * d.y); }))},
      {"profile",
       shapes::extrusion(std::vector<glm::vec2>{{0, 0}, {2, 0}, {2, 2}, {1.5f, 0.5f}, {1, 2}, {0.5f, 0.5f}, {0, 2}},
                         1.0f)}};
  for (const auto& [name, body] : bodies) {
    const Scene scene = scene_of({body});
    const double whole = volume_of(scene);
    const glm::vec3 center = scene.center();
    for (unsigned seed = 0; seed < 40; ++seed) {
      const auto random = [&](unsigned k) { return double(hash(8 * seed + k)) / 4294967295.0 * 2.0 - 1.0; };
      const glm::dvec3 n(random(0), random(1), random(2));
      const double d = glm::dot(n, glm::dvec3(center)) + 0.3 * glm::length(n) * random(3);
      const std::string one = fmt::format("{},{},{},{}", n.x, n.y, n.z, d),
                        other = fmt::format("{},{},{},{}", -n.x, -n.y, -n.z, -d);
      const Scene a = cut(scene, {one}), b = cut(scene, {other});
      EXPECT_EQ(open_edges(a), 0u) << name << " " << one;
      EXPECT_EQ(open_edges(b), 0u) << name << " " << other;
      EXPECT_NEAR(volume_of(a) + volume_of(b), whole, 1e-5 * whole) << name << " " << one;
      EXPECT_NEAR(cap_area(a), cap_area(b), 1e-5) << name;
      EXPECT_TRUE(a.warnings.empty());
      const Scene twice = cut(
          scene, {one, fmt::format("{},{},{},{}", n.y, -n.x, 0.1, n.y * center.x - n.x * center.y + 0.1 * center.z)});
      EXPECT_EQ(open_edges(twice), 0u) << name << " twice " << one;
    }
  }
}

TEST(Section, TakesVerticesAndFacesInThePlane) {
  // The plane runs through vertices, edges and faces.
  Mesh octahedron;
  octahedron.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  octahedron.indices = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  for (const char* text : {"x<0", "y>0", "z<0", "1,1,0,0", "1,-1,0,0"}) {
    const Scene half = cut(scene_of({octahedron}), {text});
    EXPECT_NEAR(volume_of(half), 2.0 / 3.0, 1e-6) << text;
    EXPECT_EQ(open_edges(half), 0u) << text;
  }
  const Mesh below = shapes::box(glm::vec3(0), glm::vec3(1)),
             above = shapes::box(glm::vec3(0, 1, 0), glm::vec3(1, 2, 1));
  const Scene stack = scene_of({below, moved(above, glm::vec3(0), 1)});
  EXPECT_NEAR(volume_of(cut(stack, {"y<1"})), 1.0, 1e-6) << "nothing of the upper one remains";
  EXPECT_NEAR(cap_area(cut(stack, {"y<1"})), 1.0, 1e-6);
  EXPECT_NEAR(volume_of(cut(stack, {"y<0.5", "y<0.5"})), 0.5, 1e-6) << "twice the same";
}

TEST(Section, CountsPartsThatAreNotClosed) {
  // A box without a side, of which two of three planes cut the border.
  Mesh open = shapes::box(glm::vec3(0), glm::vec3(1));
  open.indices.resize(open.indices.size() - 6);
  const Mesh ball = moved(closed(shapes::sphere(0.5f, 24, 12)), glm::vec3(0.5f), 1);
  int without_cap = 0;
  for (const char* text : {"x<0.5", "y<0.5", "z<0.5"}) {
    const Scene scene = cut(scene_of({open, ball}), {text});
    if (scene.warnings.empty()) continue;
    EXPECT_EQ(scene.warnings[0], "1 part is not closed where `sections` cut it: there is no cap there");
    EXPECT_EQ(cap_count(scene), 1u) << "the ball";
    ++without_cap;
  }
  EXPECT_EQ(without_cap, 2);
  const Scene sheet = cut(scene_of({shapes::plane(glm::vec2(0), glm::vec2(1), 0, 3, 3)}), {"x<0.5"});
  EXPECT_EQ(cap_count(sheet), 0u);
  EXPECT_EQ(sheet.warnings.size(), 1u);
}

TEST(Section, ClosesCracksAndSmallHoles) {
  // A pipe whose four faces are apart by a thousandth, as faces of CAD files are; one object.
  const std::vector<glm::vec2> outside = {{1, 0}, {1, 2}}, inside = {{0.5f, 2.001f}, {0.5f, -0.001f}},
                               top = {{1.001f, 2}, {0.501f, 2}}, bottom = {{0.501f, 0}, {1.001f, 0}};
  std::vector<Mesh> faces;
  for (const auto& profile : {outside, inside, top, bottom}) faces.push_back(shapes::lathe(profile, 96));
  for (const auto& [text, area] :
       {std::pair("z<0.2", 2.0 * (std::sqrt(0.96) - std::sqrt(0.21)) * 2.0), std::pair("y<1", M_PI * 0.75)}) {
    const Scene scene = cut(scene_of(faces), {text});
    EXPECT_EQ(cap_count(scene), 1u) << text;
    EXPECT_NEAR(cap_area(scene), area, 0.01 * area) << "the bore is empty: " << text;
    EXPECT_EQ(scene.warnings.size(), text[0] == 'z' ? 1u : 0u) << "only the first plane cuts gaps";
  }
  EXPECT_TRUE(cut(scene_of({shapes::torus(1.0f, 0.3f, 40, 20)}), {"x<0.1"}).warnings.empty()) << "a seam, by rounding";
  // A ball without its first triangles, as scans have holes.
  Mesh ball = closed(shapes::sphere(1.0f, 64, 32));
  ball.indices.erase(ball.indices.begin(), ball.indices.begin() + 3 * 64);
  const Scene scene = cut(scene_of({ball}), {"x<0.01"});
  EXPECT_NEAR(cap_area(scene), M_PI, 0.02 * M_PI);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("1 part has small gaps"), std::string::npos) << scene.warnings[0];
}

TEST(Section, FillsPartsWhoseTrianglesFaceAnyWay) {
  Mesh box = shapes::box(glm::vec3(0), glm::vec3(1));
  for (std::size_t i = 0; i < box.indices.size(); i += 9) std::swap(box.indices[i], box.indices[i + 1]);
  EXPECT_NEAR(cap_area(cut(scene_of({box}), {"x<0.4"})), 1.0, 1e-6);
  EXPECT_NEAR(cap_area(cut(scene_of({reversed(closed(shapes::torus(1.0f, 0.3f, 40, 20)))}), {"y<0"})),
              cap_area(cut(scene_of({closed(shapes::torus(1.0f, 0.3f, 40, 20))}), {"y<0"})), 1e-6);
}

TEST(Section, InterpolatesAttributes) {
  Mesh sheet = shapes::plane(glm::vec2(0), glm::vec2(1), 0, 1, 1);
  sheet.uvs.clear();
  for (const glm::vec3& p : sheet.positions) {
    sheet.uvs.emplace_back(p.x, 2.0f * p.z);
    sheet.colors.push_back(p);
  }
  const Scene scene = cut(scene_of({sheet}), {"x<0.3"});
  const Mesh& mesh = scene.meshes[0];
  std::size_t in_plane = 0;
  for (std::size_t k = 0; k < mesh.positions.size(); ++k) {
    const glm::vec3& p = mesh.positions[k];
    in_plane += p.x == 0.3f;
    EXPECT_LE(p.x, 0.3f);
    EXPECT_NEAR(mesh.uvs[k].x, p.x, 1e-6f);
    EXPECT_NEAR(mesh.uvs[k].y, 2.0f * p.z, 1e-6f);
    EXPECT_NEAR(glm::length(mesh.colors[k] - p), 0.0f, 1e-6f);
    EXPECT_NEAR(glm::length(mesh.normals[k]), 1.0f, 1e-6f);
  }
  EXPECT_GE(in_plane, 2u);
}

TEST(Section, HatchesCapsWithStripsOfEqualWidth) {
  const Scene scene = cut(scene_of({shapes::box(glm::vec3(0), glm::vec3(1))}), {"z<0.5"}, true);
  EXPECT_EQ(cap_count(scene), 2u) << "strips alternate between two objects";
  EXPECT_NEAR(cap_area(scene), 1.0, 1e-5);
  EXPECT_NEAR(volume_of(scene), 0.5, 1e-5);
  // At 45 degrees, each strip ends at multiples of one distance.
  const Mesh& cap = scene.meshes.back();
  std::map<long, int> ends;
  for (const glm::vec3& p : cap.positions) {
    const double across = std::abs(double(p.x) - double(p.y)) / std::sqrt(2.0);
    const bool is_corner = std::abs(std::round(2.0f * p.x) - 2.0f * p.x) < 1e-4f;  // of the box's triangles
    if (!is_corner && p.y < 1e-4f) ++ends[std::lround(across * 1e5)];
  }
  ASSERT_GE(ends.size(), 4u);
  std::vector<long> at;
  for (const auto& [end, count] : ends) at.push_back(end);
  for (std::size_t k = 2; k < at.size(); ++k) EXPECT_NEAR(at[k] - at[k - 2], at[2] - at[0], 3);
}

TEST(Section, KeepsPointsByTheirCenters) {
  Mesh points;
  points.points = points.spheres = true;
  for (int k = 0; k < 10; ++k) points.positions.emplace_back(float(k), 0.0f, 0.0f), points.radii.push_back(0.7f);
  const Scene scene = cut(scene_of({points}), {"x<4.5"});
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].positions.size(), 5u);
  EXPECT_EQ(scene.meshes[0].radii.size(), 5u);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("spheres"), std::string::npos);
}

TEST(Section, KeepsTheViewOfTheWholeModel) {
  const Scene scene = scene_of({shapes::box(glm::vec3(0), glm::vec3(1, 2, 3))});
  const Scene half = cut(scene, {"x<0.5"});
  EXPECT_EQ(half.bounds_max, scene.bounds_max);
  ASSERT_TRUE(half.start);
  EXPECT_EQ(half.start->triangle_count(), 12u);
  const Camera whole = frame_scene(scene, {}, 64, 64), of_half = frame_scene(half, {}, 64, 64);
  EXPECT_LT(glm::length(whole.eye() - of_half.eye()), 0.02f * scene.radius());
}

TEST(Section, PlanesAreInTheCoordinatesOfTheFile) {
  Scene scene = scene_of({shapes::box(glm::vec3(0), glm::vec3(1))});
  scene.origin = glm::dvec3(500000.0, 0.0, 0.0);
  EXPECT_NEAR(volume_of(cut(scene, {"x<500000.25"})), 0.25, 1e-6);
  EXPECT_NE(refusal(scene, "x=0.5").find("extends from 500000 to 500001"), std::string::npos)
      << refusal(scene, "x=0.5");
}

TEST(Section, RefusesPlanesThatMiss) {
  const Scene scene = scene_of({shapes::box(glm::vec3(0), glm::vec3(1))});
  EXPECT_NE(refusal(scene, "x=5").find("cuts nothing"), std::string::npos);
  EXPECT_NE(refusal(scene, "x=-5").find("cuts nothing"), std::string::npos);
  EXPECT_NE(refusal(scene, "x<5").find("cuts nothing"), std::string::npos);
  EXPECT_NE(refusal(scene, "x>5").find("leaves nothing"), std::string::npos);
  EXPECT_NE(refusal(scene, "x<0").find("leaves nothing"), std::string::npos) << "a face in the plane";
  EXPECT_NE(refusal(scene, "x<0").find("from 0 to 1"), std::string::npos);
  EXPECT_NE(refusal(scene, "1,1,0,-3").find("leaves nothing"), std::string::npos);
  // A model without volume, in the plane.
  EXPECT_NE(refusal(scene_of({shapes::plane(glm::vec2(0), glm::vec2(1), 0, 1, 1)}), "y=0").find("cuts nothing"),
            std::string::npos);
  Scene pose = scene;
  pose.motion = {glm::vec3(0), glm::vec3(9)};
  EXPECT_EQ(refusal(pose, "x<5"), "") << "another pose may be cut";
}

TEST(Section, RefusesBadTexts) {
  for (const char* text : {"",       "x",   "x=",        "w=1",       "x=nan",   "x=inf",   "x=1e999",
                           "x=4cm",  "x:1", "1,2,3",     "1,2,3,4,5", "0,0,0,1", "a,b,c,d", "1,2,,3",
                           "1,2,3,", " , ", "1,x=2,3,4", "x=%",       "=1",      "x=1,2",   "1e308,1e308,0,1"}) {
    const auto plane = parse_sections(text);
    ASSERT_FALSE(plane) << text;
    EXPECT_EQ(plane.error().fields[0].field, "sections");
    EXPECT_NE(plane.error().message.find("it takes x=0.4"), std::string::npos) << plane.error().message;
  }
  EXPECT_EQ(parse_sections("Z>1e-3")->at(0).normal, glm::dvec3(0, 0, 1));
  EXPECT_EQ(parse_sections("x=1,y<20%, 1,0,0,3 z>0")->size(), 4u);
  EXPECT_DOUBLE_EQ(parse_sections("0,0,2,1")->at(0).offset, 0.5);
}

TEST(Triangulate, FillsRegionsWithHolesAndPointsOnEdges) {
  // A square with points on its sides, a square hole that touches nothing, an island in it, and a hole that touches a
  // corner of the island's hole.
  const std::vector<glm::dvec2> points = {{0, 0}, {4, 0}, {8, 0}, {8, 8}, {4, 8}, {0, 8}, {1, 1}, {1, 5}, {5, 5},
                                          {5, 1}, {2, 2}, {4, 2}, {4, 4}, {2, 4}, {5, 7}, {7, 7}, {7, 5}};
  const Loop outer = {0, 1, 2, 3, 4, 5}, hole = {6, 7, 8, 9}, island = {10, 11, 12, 13}, second = {8, 14, 15, 16};
  const double expected = 2.0 * (64.0 - 16.0 + 4.0 - 4.0);
  double sum = 0.0;
  std::map<std::pair<unsigned, unsigned>, int> edges;
  for (const auto& t : triangulate(points, {outer, island, hole, second})) {
    const double area = twice_area(points, {t[0], t[1], t[2]});
    EXPECT_GT(area, 0.0);
    sum += area;
    for (std::size_t k = 0; k < 3; ++k) {
      const unsigned a = t[k], b = t[(k + 1) % 3];
      edges[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  }
  EXPECT_NEAR(sum, expected, 1e-12);
  std::size_t border = 0;
  for (const auto& [edge, count] : edges) border += count != 0;
  EXPECT_EQ(border, 18u) << "the sides of all loops, and no others";
  EXPECT_TRUE(triangulate(points, {}).empty());
  EXPECT_TRUE(triangulate(points, {{0, 1, 2}}).empty()) << "no area";
}

}  // namespace
}  // namespace umbrage
