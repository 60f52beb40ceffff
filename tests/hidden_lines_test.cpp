// Compares the lines of technical drawings with exact ones (exact_lines.h): the fraction of the exact length that is
// drawn, and the fraction of what is drawn where there is no exact line. The parts are single solids.
#include <gtest/gtest.h>

#include <ctime>
#include <numbers>
#include <vector>

#include "devices/cpu/cpu_device.h"
#include "exact_lines.h"
#include "generators/shapes.h"
#include "io/drawing_of_strokes.h"
#include "renderer/draw.h"
#include "renderer/strokes.h"
#include "scene/finish.h"
#include "scene/triangulate.h"

namespace umbrage::test {
namespace {

using glm::vec2, glm::vec3;
using shapes::Points2;

constexpr double kReach = 0.5;  // pixels
constexpr int kSize = 1024;     // of pictures, pixels
constexpr double kCreaseDeg = 30.0;
constexpr double kMaxSeconds = 10.0;  // of a processor: 5 s on two cores

/// Builds a solid from flat faces across z, and walls between outlines. Outlines are counterclockwise.
class SolidMaker {
 public:
  Mesh mesh;

  /// Adds a face that points along +z, or -z, with holes.
  void face(float z, bool up, std::vector<Points2> outlines) {
    std::vector<glm::dvec2> points;
    std::vector<Loop> loops;
    for (Points2& outline : outlines) {
      loops.emplace_back();
      for (const vec2& p : outline) loops.back().push_back(std::uint32_t(points.size())), points.emplace_back(p);
    }
    const auto first = std::uint32_t(mesh.positions.size());
    for (const glm::dvec2& p : points) mesh.positions.push_back({float(p.x), float(p.y), z});
    for (const auto& [a, b, c] : triangulate(points, loops))
      mesh.indices.insert(mesh.indices.end(), {first + a, first + (up ? b : c), first + (up ? c : b)});
  }
  /// Adds walls from an outline at z0 to one with as many points at z1 > z0, seen from outside or from inside.
  void walls(const Points2& low, float z0, const Points2& high, float z1, bool from_inside = false) {
    for (std::size_t k = 0; k < low.size(); ++k) {
      const std::size_t j = (k + 1) % low.size();
      const auto n = std::uint32_t(mesh.positions.size());
      for (const auto& [p, z] : {std::pair(low[k], z0), {low[j], z0}, {high[j], z1}, {high[k], z1}})
        mesh.positions.push_back({p.x, p.y, z});
      for (const int i : {0, 1, 2, 0, 2, 3}) mesh.indices.push_back(n + std::uint32_t(from_inside ? (4 - i) % 4 : i));
    }
  }
  /// Adds a prism with holes through it.
  void prism(const std::vector<Points2>& outlines, float z0, float z1) {
    face(z0, false, outlines), face(z1, true, outlines);
    for (const Points2& outline : outlines) walls(outline, z0, outline, z1, &outline != &outlines.front());
  }
};

Points2 circle_at(vec2 center, float radius, int count) {
  Points2 points;
  for (const vec2& p : shapes::circle(radius, count)) points.push_back(center + p);
  return points;
}

Points2 joined_points(std::initializer_list<Points2> parts) {
  Points2 all;
  for (const Points2& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

Mesh bracket() {
  const Points2 slot =
      joined_points({shapes::arc({0.5f, 0}, 0.15f, -90, 90, 16), shapes::arc({-0.1f, 0}, 0.15f, 90, 270, 16)});
  const Points2 outline = joined_points({{{-1.6f, -0.6f}, {0.9f, -0.6f}},
                                         shapes::arc({0.9f, 0}, 0.6f, -75, 75, 20),
                                         {{0.9f, 0.6f}, {-0.7f, 0.6f}},
                                         shapes::arc({-0.7f, 1.1f}, 0.5f, 255, 195, 8),
                                         {{-1.2f, 1.1f}, {-1.2f, 1.8f}, {-1.6f, 1.8f}}});
  SolidMaker solid;
  solid.prism({outline, slot, circle_at({-0.9f, 0}, 0.3f, 40), circle_at({1.1f, 0}, 0.16f, 32)}, 0, 0.4f);
  return solid.mesh;
}

Mesh gear() {
  constexpr int kTeeth = 20;
  Points2 outline;
  for (int k = 0; k < kTeeth; ++k)
    for (const auto& [radius, at] :
         {std::pair(0.84f, -0.5f), {0.84f, -0.32f}, {1.0f, -0.14f}, {1.0f, 0.14f}, {0.84f, 0.32f}}) {
      const float angle = 2.0f * std::numbers::pi_v<float> * (float(k) + at) / kTeeth;
      outline.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
  SolidMaker solid;
  const Points2 hub = circle_at({0, 0}, 0.4f, 48), bore = circle_at({0, 0}, 0.2f, 36);
  solid.face(-0.15f, false, {outline, bore});
  solid.walls(outline, -0.15f, outline, 0.15f);
  solid.face(0.15f, true, {outline, hub});
  solid.walls(hub, 0.15f, hub, 0.35f);
  solid.face(0.35f, true, {hub, bore});
  solid.walls(bore, -0.15f, bore, 0.35f, true);
  return solid.mesh;
}

/// A block with a round-cornered pocket and a step.
Mesh pocket() {
  const Points2 block = {{-1, -0.7f}, {1, -0.7f}, {1, 0.7f}, {-1, 0.7f}};
  const Points2 hole =
      joined_points({shapes::arc({0.5f, -0.2f}, 0.2f, -90, 0, 8), shapes::arc({0.5f, 0.2f}, 0.2f, 0, 90, 8),
                     shapes::arc({-0.5f, 0.2f}, 0.2f, 90, 180, 8), shapes::arc({-0.5f, -0.2f}, 0.2f, 180, 270, 8)});
  SolidMaker solid;
  solid.face(-0.4f, false, {block});
  solid.walls(block, -0.4f, block, 0.4f);
  solid.face(0.4f, true, {block, hole});
  solid.walls(hole, -0.1f, hole, 0.4f, true);
  solid.face(-0.1f, true, {hole});
  return solid.mesh;
}

Mesh bolt() {
  const Points2 head = {{0.6f, 0.1f},   {0.2134f, 0.5696f},   {-0.3866f, 0.4696f},
                        {-0.6f, -0.1f}, {-0.2134f, -0.5696f}, {0.3866f, -0.4696f}},
                shank = shapes::circle(0.3f, 40), tip = shapes::circle(0.22f, 40);
  SolidMaker solid;
  solid.face(0.4f, true, {head});
  solid.walls(head, 0, head, 0.4f);
  solid.face(0, false, {head, shank});
  solid.walls(shank, -1.4f, shank, 0);
  solid.walls(tip, -1.5f, shank, -1.4f);
  solid.face(-1.5f, false, {tip});
  return solid.mesh;
}

/// A sector with a rim, thicker at its hub.
Mesh fan() {
  const Points2 outline = joined_points({{{0, 0}}, shapes::arc({0, 0}, 1.6f, 10, 80, 40), {}});
  const Points2 inner = joined_points({{{0.45f, 0.45f}}, shapes::arc({0, 0}, 1.25f, 22, 68, 26)});
  Points2 top, inner_top;
  for (const vec2& p : outline) top.push_back(vec2(0.1f) + 0.85f * p);
  for (const vec2& p : inner) inner_top.push_back(vec2(0.06f) + 0.92f * p);
  SolidMaker solid;
  solid.face(0, false, {outline});
  solid.walls(outline, 0, outline, 0.2f);
  solid.walls(outline, 0.2f, top, 0.5f);
  solid.face(0.5f, true, {top, inner_top});
  solid.walls(inner, 0.25f, inner_top, 0.5f, true);
  solid.face(0.25f, true, {inner});
  return solid.mesh;
}

Mesh shaft() {
  const Points2 profile = {{0, -1.5f},    {0.22f, -1.5f}, {0.27f, -1.45f}, {0.27f, -0.7f}, {0.5f, -0.7f},
                           {0.5f, -0.1f}, {0.42f, -0.1f}, {0.42f, 0.05f},  {0.5f, 0.05f},  {0.5f, 0.4f},
                           {0.35f, 0.6f}, {0.35f, 1.1f},  {0.18f, 1.1f},   {0.18f, 1.5f},  {0, 1.5f}};
  return shapes::lathe(shapes::sharp(profile), 48);
}

/// A pipe with flanges.
Mesh pipe() {
  const Points2 profile = {{0.3f, -1.2f}, {0.75f, -1.2f}, {0.75f, -0.95f}, {0.42f, -0.95f}, {0.42f, 0.9f},
                           {0.75f, 0.9f}, {0.75f, 1.2f},  {0.3f, 1.2f},    {0.3f, -1.2f}};
  return shapes::lathe(shapes::sharp(profile), 48);
}

Mesh spring() {
  shapes::Points3 path;
  for (int k = 0; k <= 160; ++k) {
    const float turns = 4.0f * float(k) / 160.0f, angle = 2.0f * std::numbers::pi_v<float> * turns;
    path.push_back({0.7f * std::cos(angle), 0.42f * turns, 0.7f * std::sin(angle)});
  }
  return shapes::tube(path, 0.13f, 24);
}

struct Part {
  const char* name;
  Mesh mesh;
  double min_hidden = 0.0;  ///< fraction of its hidden lines to be found; 0: they are not drawn, which takes seconds
};

std::vector<Part> all_parts() {
  return {{"cube", shapes::box({-1, -1, -1}, {1, 1, 1})},
          {"fan", fan(), 0.98},
          {"bracket", bracket(), 0.98},
          {"gear", gear(), 0.96},  // edges of its teeth are near each other: of lines that coincide only one is drawn
          {"block with a pocket", pocket()},
          {"bolt", bolt()},
          {"shaft", shaft()},
          {"pipe", pipe()},
          {"ring", shapes::torus(1.0f, 0.35f, 72, 40)},
          {"spring", spring()}};
}

Scene scene_of(std::vector<Mesh> meshes) {
  Scene scene;
  scene.materials.emplace_back();
  for (Mesh& mesh : meshes) {
    mesh.normals.clear(), mesh.uvs.clear();
    mesh.object = int(&mesh - meshes.data());
  }
  scene.meshes = std::move(meshes);
  finish_scene(scene);
  return scene;
}

/// Appends the straight pieces of a path.
void flatten(const DrawnPath& path, Segments& lines) {
  glm::dvec2 from(path.x, path.y);
  for (const DrawnSegment& s : path.segments) {
    const glm::dvec2 to(s.x, s.y), half = 0.5 * (to - from);
    const double radius = s.radius, chord = glm::length(half);
    if (radius > 0.0 && chord > 0.0) {
      // On the page y points down: the centre of a short clockwise arc is to the right of the way.
      const double rise = std::sqrt(std::max(radius * radius - chord * chord, 0.0)) / chord;
      const double side = s.clockwise != s.large_arc ? 1.0 : -1.0;
      const glm::dvec2 center = from + half + side * rise * glm::dvec2(-half.y, half.x), arm = from - center;
      double turn = 2.0 * std::asin(std::min(chord / radius, 1.0));
      if (s.large_arc) turn = 2.0 * std::numbers::pi - turn;
      if (!s.clockwise) turn = -turn;
      const int count = int(std::abs(turn) * radius) + 1;
      for (int k = 1; k <= count; ++k) {
        const double c = std::cos(turn * k / count), d = std::sin(turn * k / count);
        const glm::dvec2 next = center + glm::dvec2(c * arm.x - d * arm.y, d * arm.x + c * arm.y);
        lines.push_back({from, next}), from = next;
      }
    }
    lines.push_back({from, to}), from = to;
  }
}

struct Drawn {
  Segments visible, hidden;
  PictureInfo info;
};

/// Draws a scene as `umbrage -o FILE.dxf` does: lines are strokes of one width.
Drawn drawn_lines(Scene& scene, const Request& request) {
  const auto recipe = make_recipe(request);
  EXPECT_TRUE(recipe && complete_scene(scene, *recipe));
  const auto device = make_cpu_device();
  EXPECT_TRUE(device->prepare(scene));
  StageTimes times;
  const auto frame = draw(*device, scene, *recipe, times);
  EXPECT_TRUE(frame) << (frame ? "" : frame.error().message);
  const auto traced = traced_strokes(*device, *frame, *stroke_parameters(*recipe));
  Drawn drawn{{}, {}, frame->info};
  const auto drawing = drawing_of(*traced, {.varies = false});
  for (const DrawnLayer& layer : drawing->layers)
    for (const DrawnShape& shape : layer.shapes)
      flatten(std::get<DrawnPath>(shape), layer.name == "hidden" ? drawn.hidden : drawn.visible);
  return drawn;
}

/// Lengths of lines, pixels.
struct Compared {
  double exact = 0.0, missed = 0.0, drawn = 0.0, wrong = 0.0;

  void add(const Segments& exact_lines, const Segments& drawn_lines, const Segments& right) {
    exact += length_of(exact_lines), missed += length_of(far_pieces(exact_lines, drawn_lines, kReach, kSize, kSize));
    drawn += length_of(drawn_lines), wrong += length_of(far_pieces(drawn_lines, right, kReach, kSize, kSize));
  }
  double found_share() const { return 1.0 - missed / exact; }
  double wrong_share() const { return wrong / drawn; }
  std::string text() const {
    return fmt::format("{:.2f} % found, {:.2f} % false", 100.0 * found_share(), 100.0 * wrong_share());
  }
};

struct TestCamera {
  std::array<float, 3> direction;
  bool parallel;
};
constexpr TestCamera kPerspective = {{0.5f, -0.6f, -1}, false};
constexpr TestCamera kCameras[] = {kPerspective, {{-1, -1, -1}, true}, {{0, 0, -1}, true}, {{-1, 0, 0}, true}};

Request request_of(const TestCamera& camera, bool with_hidden = false) {
  Request request;
  request.look = "technical";
  request.width = request.height = kSize;
  request.anti_aliasing = 1;
  request.camera.direction = camera.direction;
  request.camera.orthographic = camera.parallel;
  if (with_hidden) request.settings = {"hidden.draw=on"};
  return request;
}

TEST(HiddenLines, OfTenPartsAreExact) {
  for (const Part& part : all_parts()) {
    Compared visible, hidden;
    for (const TestCamera& camera : kCameras) {
      Scene scene = scene_of({part.mesh});
      const bool with_hidden = part.min_hidden > 0.0 && !camera.parallel;
      const Drawn drawn = drawn_lines(scene, request_of(camera, with_hidden));
      const ExactLines exact(scene, drawn.info, kCreaseDeg);
      ASSERT_EQ(exact.borders, 0) << part.name << " is closed";
      visible.add(exact.visible, drawn.visible, exact.visible);
      if (!with_hidden) continue;
      // Hidden lines beside visible ones are left out.
      Segments any = exact.visible;
      any.insert(any.end(), exact.hidden.begin(), exact.hidden.end());
      hidden.add(far_pieces(exact.hidden, exact.visible, 3.0, kSize, kSize), drawn.hidden, any);
    }
    fmt::print("{}: {}\n", part.name, visible.text());
    EXPECT_GE(visible.found_share(), 0.98) << part.name << ": " << visible.text();
    EXPECT_LE(visible.wrong_share(), 0.02) << part.name << ": " << visible.text();
    if (part.min_hidden == 0.0) continue;
    fmt::print("{}, hidden: {}\n", part.name, hidden.text());
    EXPECT_GE(hidden.found_share(), part.min_hidden) << part.name << ": " << hidden.text();
    EXPECT_LE(hidden.wrong_share(), 0.02) << part.name << ": " << hidden.text();
  }
}

void add_box(std::vector<Mesh>& all, vec3 low, vec3 high) { all.push_back(shapes::box(low, high)); }

/// Twelve storeys of slabs and columns with frames in between.
Scene building() {
  std::vector<Mesh> all;
  for (int z = 0; z < 12; ++z) {
    const float y = 3.0f * float(z);
    add_box(all, {-16, y, -8}, {16, y + 0.4f, 8});
    for (int side = 0; side < 2; ++side)
      for (int k = 0; k < 16; ++k) {
        const float x = -16.0f + 2.0f * float(k), far = side ? 7.7f : -8.0f;
        add_box(all, {x, y + 0.4f, far}, {x + 0.5f, y + 3, far + 0.3f});
        add_box(all, {x + 0.5f, y + 0.4f, far}, {x + 2, y + 1.3f, far + 0.3f});
        add_box(all, {x + 0.6f, y + 1.4f, far + 0.1f}, {x + 1.9f, y + 2.9f, far + 0.2f});
      }
  }
  return scene_of(std::move(all));
}

/// 732 bolts, rings and blocks on a plate.
Scene assembly() {
  std::vector<Mesh> all;
  const Mesh kinds[] = {bolt(), shapes::torus(0.5f, 0.15f, 40, 20), pocket(), gear()};
  for (int k = 0; k < 731; ++k)
    all.push_back(shapes::moved(kinds[k % 4], {2.2f * float(k % 27), 2.0f * float(k % 5), 2.2f * float(k / 27)}));
  add_box(all, {-2, -3, -2}, {60, -2, 62});
  return scene_of(std::move(all));
}

TEST(HiddenLines, OfManyPartsTakeSeconds) {
  const auto drawn_in_time = [](Scene& scene) {
    const std::clock_t start = std::clock();
    Drawn drawn = drawn_lines(scene, request_of(kPerspective));
    EXPECT_LE(double(std::clock() - start) / CLOCKS_PER_SEC, kMaxSeconds) << scene.meshes.size() << " parts";
    return drawn;
  };
  Scene many = assembly(), storeys = building();
  ASSERT_EQ(many.meshes.size(), 732u);
  EXPECT_GT(drawn_in_time(many).visible.size(), 10000u);
  const Drawn drawn = drawn_in_time(storeys);
  const ExactLines exact(storeys, drawn.info, kCreaseDeg);
  Compared visible;
  visible.add(exact.visible, drawn.visible, exact.visible);
  fmt::print("building: {}\n", visible.text());
  // Frames of windows are 1 to 3 pixels wide: parallel lines so close are one.
  EXPECT_GE(visible.found_share(), 0.92) << visible.text();
  EXPECT_LE(visible.wrong_share(), 0.02) << visible.text();
}

}  // namespace
}  // namespace umbrage::test
