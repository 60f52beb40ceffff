// scene:solids - a still life of simple solids on a round table: all kinds of contacts, gaps, holes and overhangs that
// occlusion has to show, in familiar shapes. Objects that lean or lie are placed by computing their contacts.
#include <algorithm>
#include <array>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "generators/makers.h"
#include "generators/shapes.h"

namespace umbrage {

namespace {

using glm::mat4;
using glm::vec2;
using glm::vec3;
using shapes::Detail;

constexpr float kPi = std::numbers::pi_v<float>;

struct Palette {
  int table, cream, coral, mustard, teal, blue, lilac, sage, rose, brass, white;
};

Palette add_palette(Scene& scene) {
  const shapes::MaterialMaker make{scene};
  Palette p;
  p.table = make.plain("table", {0.70f, 0.66f, 0.61f});
  p.cream = make.plain("cream", {0.84f, 0.77f, 0.64f});
  p.coral = make.plain("coral", {0.80f, 0.31f, 0.22f});
  p.mustard = make.plain("mustard", {0.84f, 0.58f, 0.19f});
  p.teal = make.plain("teal", {0.11f, 0.40f, 0.41f}, 0.45f, 60.0f);
  p.blue = make.plain("blue", {0.32f, 0.47f, 0.66f});
  p.lilac = make.plain("lilac", {0.50f, 0.36f, 0.64f}, 0.40f, 48.0f);
  p.sage = make.plain("sage", {0.47f, 0.59f, 0.39f});
  p.rose = make.plain("rose", {0.80f, 0.45f, 0.47f}, 0.25f, 32.0f);
  p.brass = make.plain("brass", {0.66f, 0.45f, 0.17f}, 0.60f, 70.0f);
  p.white = make.plain("white", {0.86f, 0.85f, 0.82f}, 0.30f, 50.0f);
  return p;
}

/// Moves a mesh up or down until it stands on the table, y = 0.
Mesh grounded(Mesh mesh) {
  float low = 1e30f;
  for (const vec3& p : mesh.positions) low = std::min(low, p.y);
  return shapes::moved(std::move(mesh), {0, -low, 0});
}

/// Rotates a mesh so that `down` points to the table, and places it on the table.
Mesh on_face(Mesh mesh, vec3 down) {
  down = glm::normalize(down);
  const vec3 axis = glm::cross(down, vec3(0, -1, 0));
  if (glm::length(axis) > 1e-6f) {
    const float angle_rad = std::acos(std::clamp(-down.y, -1.0f, 1.0f));
    mesh = shapes::turned(std::move(mesh), glm::normalize(axis), glm::degrees(angle_rad));
  }
  return grounded(std::move(mesh));
}

constexpr float kGolden = 1.6180340f;

/// Returns the twelve corners of an icosahedron at distance `radius`.
std::vector<vec3> icosahedron(float radius) {
  std::vector<vec3> corners;
  for (const float a : {-1.0f, 1.0f})
    for (const float b : {-kGolden, kGolden})
      for (const vec3& p : {vec3(0, a, b), vec3(a, b, 0), vec3(b, 0, a)}) corners.push_back(radius * glm::normalize(p));
  return corners;
}

/// Returns the twenty corners of a dodecahedron at distance `radius`.
std::vector<vec3> dodecahedron(float radius) {
  std::vector<vec3> corners;
  for (const float a : {-1.0f, 1.0f})
    for (const float b : {-1.0f, 1.0f}) {
      for (const float c : {-1.0f, 1.0f}) corners.push_back(radius * glm::normalize(vec3(a, b, c)));
      const float s = a / kGolden, l = b * kGolden;
      for (const vec3& p : {vec3(0, s, l), vec3(s, l, 0), vec3(l, 0, s)}) corners.push_back(radius * glm::normalize(p));
    }
  return corners;
}

struct Table {
  Scene scene;
  Detail detail;
  Palette paint;

  int add(const char* name, Mesh mesh, int material, int part_of = -1) {
    mesh.uvs.clear();  // nothing here has a texture, and rounded hulls have no texture coordinates
    return shapes::add_mesh(scene, name, std::move(mesh), material, part_of);
  }
  Mesh ball(float radius, vec3 centre, float base = 14.0f) const {
    return shapes::moved(shapes::cube_sphere(detail(base, 4), [=](vec3) { return radius; }), centre);
  }
  Mesh block(vec3 low, vec3 high, float bevel) const { return shapes::box(low, high, bevel, detail(2.0f, 1)); }
  Mesh torus(float ring, float tube) const { return shapes::torus(ring, tube, detail(56.0f, 12), detail(22.0f, 8)); }
  /// Makes a cylinder or cone on the table with rounded edges.
  Mesh turned_solid(float bottom, float top, float height, float bevel, float slices = 48.0f) const {
    const int steps = detail(3.0f, 1);
    const vec2 side = glm::normalize(vec2(top - bottom, height));
    const float lean_deg = glm::degrees(std::atan2(-side.x, side.y));  // how far the flank's normal points up
    const auto rim = [&](float radius, float y, bool upper) {
      // The sphere that rounds the edge touches both the cap and the flank.
      const float turn_deg = upper ? 90.0f - lean_deg : 90.0f + lean_deg;
      const vec2 centre(radius - bevel * std::tan(glm::radians(0.5f * turn_deg)), upper ? y - bevel : y + bevel);
      return upper ? shapes::arc(centre, bevel, lean_deg, 90.0f, steps)
                   : shapes::arc(centre, bevel, -90.0f, lean_deg, steps);
    };
    const shapes::Points2 low = rim(bottom, 0.0f, false);
    if (top <= bevel) {
      // A cone ends in a small sphere.
      const shapes::Points2 round =
          shapes::arc({0.0f, (bevel - bottom * side.y) / side.x}, bevel, lean_deg, 90.0f, steps);
      return shapes::lathe(shapes::join({{{0.0f, 0.0f}, low.front()}, low, {low.back(), round.front()}, round}),
                           detail(slices, 10));
    }
    const shapes::Points2 high = rim(top, height, true);
    return shapes::lathe(
        shapes::join(
            {{{0.0f, 0.0f}, low.front()}, low, {low.back(), high.front()}, high, {high.back(), {0.0f, height}}}),
        detail(slices, 10));
  }
};

void add_stairs(Table& t) {
  constexpr int kSteps = 5;
  constexpr float kRise = 0.19f, kTread = 0.27f, kHalfWidth = 0.52f;
  const auto place = [](Mesh mesh) {
    return shapes::moved(shapes::turned_y(std::move(mesh), 32.0f), {-1.62f, 0.0f, -0.30f});
  };
  Mesh stairs;
  for (int i = 0; i < kSteps; ++i)
    shapes::append(stairs, t.block({-kHalfWidth, 0.0f, -kTread * kSteps},
                                   {kHalfWidth, kRise * float(i + 1), -kTread * float(i)}, 0.018f));
  t.add("stairs", place(std::move(stairs)), t.paint.cream);
  t.add("ball on the stairs", place(t.ball(0.125f, {0.22f, 2 * kRise + 0.125f, -1.45f * kTread})), t.paint.coral);
  const float radius = 0.34f;
  const std::vector<vec3> corners = icosahedron(radius);
  // A face of this icosahedron points along (1, 1, 1).
  const Mesh gem = shapes::turned_y(on_face(rounded_hull(corners, 0.015f, t.detail(2.0f, 1)), vec3(1.0f)), 12.0f);
  t.add("icosahedron", place(shapes::moved(gem, {-0.08f, kSteps * kRise, -4.25f * kTread})), t.paint.blue);
}

/// Adds two columns that carry a slab, and the objects on it.
void add_portal(Table& t) {
  constexpr float kHeight = 1.18f, kSlab = 0.16f, kBack = -1.18f;
  const shapes::Points2 column = {{0.0f, 0.0f},    {0.20f, 0.0f},    {0.20f, 0.0f},    {0.205f, 0.02f},
                                  {0.205f, 0.06f}, {0.19f, 0.09f},   {0.165f, 0.10f},  {0.165f, 0.10f},
                                  {0.155f, 0.14f}, {0.150f, 0.30f},  {0.140f, 0.80f},  {0.135f, 1.02f},
                                  {0.135f, 1.02f}, {0.165f, 1.05f},  {0.185f, 1.09f},  {0.185f, 1.09f},
                                  {0.20f, 1.10f},  {0.20f, kHeight}, {0.20f, kHeight}, {0.0f, kHeight}};
  for (const float x : {-0.48f, 0.48f})
    t.add("column", shapes::moved(shapes::lathe(column, t.detail(36.0f, 10)), {x, 0.0f, kBack}), t.paint.white);
  t.add("slab", t.block({-0.86f, kHeight, kBack - 0.28f}, {0.86f, kHeight + kSlab, kBack + 0.28f}, 0.02f),
        t.paint.sage);
  const float top = kHeight + kSlab;
  t.add("cone on the slab", shapes::moved(t.turned_solid(0.22f, 0.0f, 0.52f, 0.018f), {-0.38f, top, kBack}),
        t.paint.mustard);
  t.add("cube on the slab",
        shapes::moved(shapes::turned_y(t.block({-0.15f, 0.0f, -0.15f}, {0.15f, 0.30f, 0.15f}, 0.02f), 24.0f),
                      {0.44f, top, kBack + 0.02f}),
        t.paint.rose);
  t.add("ball on the slab", t.ball(0.12f, {0.07f, top + 0.12f, kBack + 0.05f}), t.paint.teal);
  t.add("ball behind", t.ball(0.30f, {0.02f, 0.30f, kBack - 0.12f}, 18.0f), t.paint.rose);
}

/// Adds a tall cylinder, and a torus that stands on the table and leans against it.
void add_leaning_torus(Table& t) {
  const vec2 axis(1.62f, -0.72f);
  constexpr float kRadius = 0.33f, kRing = 0.40f, kTube = 0.115f, kLeanDeg = 19.0f;
  t.add("cylinder", shapes::moved(t.turned_solid(kRadius, kRadius, 1.30f, 0.025f), {axis.x, 0.0f, axis.y}),
        t.paint.mustard);
  const float lean = glm::radians(kLeanDeg);
  const float y = kRing * std::cos(lean) + kTube, out = kRadius + kTube + kRing * std::sin(lean);
  // The torus leans towards the cylinder's axis, from the right of the camera.
  const Mesh ring = shapes::moved(shapes::turned_x(t.torus(kRing, kTube), 90.0f - kLeanDeg), {0.0f, y, out});
  t.add("leaning torus", shapes::moved(shapes::turned_y(ring, -14.0f), {axis.x, 0.0f, axis.y}), t.paint.lilac);
}

/// Adds the large sphere, a cube that touches it, a cone in front of both.
void add_middle(Table& t) {
  constexpr float kBall = 0.56f, kHalf = 0.36f;
  const vec3 centre(-0.10f, kBall, -0.05f);
  t.add("sphere", t.ball(kBall, centre, 26.0f), t.paint.teal);
  const float turn_deg = 24.0f;
  const vec3 direction(std::cos(glm::radians(turn_deg)), 0.0f, std::sin(glm::radians(turn_deg)));
  const vec3 at = vec3(centre.x, 0.0f, centre.z) + (kBall + kHalf) * direction;
  t.add("cube",
        shapes::moved(
            shapes::turned_y(t.block({-kHalf, 0.0f, -kHalf}, {kHalf, 2.0f * kHalf, kHalf}, 0.035f), -turn_deg), at),
        t.paint.coral);
  const vec3 octahedron_at = at + vec3(0.02f, 2.0f * kHalf, 0.0f);
  const float r = 0.24f;
  const Mesh octahedron = on_face(
      rounded_hull({{r, 0, 0}, {-r, 0, 0}, {0, r, 0}, {0, -r, 0}, {0, 0, r}, {0, 0, -r}}, 0.012f, t.detail(2.0f, 1)),
      vec3(1.0f));
  t.add("octahedron", shapes::moved(shapes::turned_y(octahedron, 20.0f), octahedron_at), t.paint.mustard);
  t.add("cone", shapes::moved(t.turned_solid(0.36f, 0.0f, 0.92f, 0.022f), {-1.06f, 0.0f, 0.52f}), t.paint.coral);
}

/// Adds a trefoil knot that lies on the table.
void add_knot(Table& t) {
  shapes::Points3 path;
  const int steps = t.detail(170.0f, 40);
  for (int i = 0; i < steps; ++i) {
    const float a = 2.0f * kPi * float(i) / float(steps);
    const float ring = 0.34f + 0.15f * std::cos(3.0f * a);
    path.push_back({ring * std::cos(2.0f * a), 0.17f * std::sin(3.0f * a), ring * std::sin(2.0f * a)});
  }
  const Mesh knot = shapes::turned_y(shapes::tube(path, 0.082f, t.detail(18.0f, 8), true), 20.0f);
  t.add("torus knot", shapes::moved(grounded(knot), {-1.62f, 0.0f, 1.18f}), t.paint.lilac);
}

/// Adds two linked rings: one stands, the other lies with one side on the table and one side on the standing ring.
void add_rings(Table& t) {
  constexpr float kRing = 0.37f, kTube = 0.075f;
  const auto place = [](Mesh mesh) {
    return shapes::moved(shapes::turned_y(std::move(mesh), 32.0f), {1.26f, 0.0f, 1.18f});
  };
  t.add("standing ring",
        place(shapes::moved(shapes::turned_x(t.torus(kRing, kTube), 90.0f), {0.0f, kRing + kTube, 0.0f})),
        t.paint.brass);
  // At their contact, the lying ring's tube crosses on top of the standing one's.
  const float tilt = std::asin(kTube * 2.0f / (2.0f * kRing));
  const Mesh lying = shapes::turned_x(t.torus(kRing, kTube), glm::degrees(tilt));
  t.add("lying ring", place(shapes::moved(lying, {0.0f, kTube + kRing * std::sin(tilt), kRing * std::cos(tilt)})),
        t.paint.teal);
}

/// Adds a bowl with four spheres: three that touch each other and the bowl, and one on top.
void add_bowl(Table& t) {
  constexpr float kInner = 0.42f, kWall = 0.035f, kBall = 0.135f;
  const float middle = kInner + kWall + 0.03f;
  const int steps = t.detail(16.0f, 5), rim = t.detail(4.0f, 2);
  const float outer = kInner + kWall, cut_deg = -6.0f, foot_deg = -64.0f;
  const vec2 end(std::cos(glm::radians(cut_deg)), std::sin(glm::radians(cut_deg)));
  const vec2 foot =
      vec2(0.0f, middle) + outer * vec2(std::cos(glm::radians(foot_deg)), std::sin(glm::radians(foot_deg)));
  shapes::Points2 inside = shapes::arc({0.0f, middle}, kInner, -90.0f, cut_deg, steps);
  std::reverse(inside.begin(), inside.end());
  shapes::Points2 profile = shapes::join({{{0.0f, 0.0f}, {foot.x + 0.01f, 0.0f}},
                                          {{foot.x + 0.01f, 0.0f}, foot},
                                          shapes::arc({0.0f, middle}, outer, foot_deg, cut_deg, steps)});
  const shapes::Points2 lip =
      shapes::arc(vec2(0.0f, middle) + (kInner + 0.5f * kWall) * end, 0.5f * kWall, cut_deg, cut_deg + 180.0f, rim);
  profile.insert(profile.end(), lip.begin() + 1, lip.end());
  profile.insert(profile.end(), inside.begin() + 1, inside.end());
  const vec3 at(-0.32f, 0.0f, 1.38f);
  t.add("bowl", shapes::moved(shapes::lathe(profile, t.detail(56.0f, 12)), at), t.paint.cream);
  const float ring = 2.0f * kBall / std::sqrt(3.0f), reach = kInner - kBall;
  const float low = middle - std::sqrt(reach * reach - ring * ring),
              high = low + std::sqrt(4.0f * kBall * kBall - ring * ring);
  const std::array<int, 3> colours = {t.paint.coral, t.paint.mustard, t.paint.blue};
  for (int i = 0; i < 3; ++i) {
    const float a = 2.0f * kPi * float(i) / 3.0f + 0.4f;
    t.add("ball in the bowl", t.ball(kBall, at + vec3(ring * std::cos(a), low, ring * std::sin(a))), colours[i]);
  }
  t.add("ball in the bowl", t.ball(kBall, at + vec3(0.0f, high, 0.0f)), t.paint.rose);
}

void add_small_things(Table& t) {
  const Mesh dodecahedron_mesh = rounded_hull(dodecahedron(0.27f), 0.015f, t.detail(2.0f, 1));
  // A face of this dodecahedron points along (0, 1, golden ratio).
  t.add("dodecahedron",
        shapes::moved(shapes::turned_y(on_face(dodecahedron_mesh, {0.0f, 1.0f, kGolden}), 14.0f), {0.46f, 0.0f, 1.02f}),
        t.paint.sage);
  const float r = 0.105f;
  const int steps = t.detail(10.0f, 3);
  shapes::Points2 profile = shapes::arc({0.0f, r}, r, -90.0f, 0.0f, steps);
  const shapes::Points2 cap = shapes::arc({0.0f, r + 0.30f}, r, 0.0f, 90.0f, steps);
  profile.insert(profile.end(), cap.begin(), cap.end());
  const Mesh capsule = shapes::lathe(profile, t.detail(30.0f, 10));
  t.add("capsule",
        shapes::moved(shapes::turned_y(shapes::turned_z(shapes::moved(capsule, {0.0f, -0.25f, 0.0f}), 90.0f), 28.0f),
                      {0.60f, r, 1.92f}),
        t.paint.rose);
  t.add("pyramid",
        shapes::moved(
            shapes::turned_y(
                rounded_hull(
                    {{-0.26f, 0, -0.26f}, {0.26f, 0, -0.26f}, {-0.26f, 0, 0.26f}, {0.26f, 0, 0.26f}, {0, 0.46f, 0}},
                    0.014f, t.detail(2.0f, 1)),
                32.0f),
            {2.28f, 0.0f, 0.42f}),
        t.paint.blue);
  // A spring.
  shapes::Points3 path;
  constexpr float kTurns = 5.0f, kRadius = 0.20f, kWire = 0.036f, kPitch = 0.105f;
  const int count = t.detail(150.0f, 50);
  for (int i = 0; i <= count; ++i) {
    const float u = float(i) / float(count), a = 2.0f * kPi * kTurns * u;
    // The ends are flat, like those of a ground spring.
    const float rise = kPitch * kTurns * std::clamp((u - 0.1f) / 0.8f, 0.0f, 1.0f);
    path.push_back({kRadius * std::cos(a), rise, kRadius * std::sin(a)});
  }
  t.add("spring", shapes::moved(grounded(shapes::tube(path, kWire, t.detail(12.0f, 6))), {-2.30f, 0.0f, 0.42f}),
        t.paint.brass);
  // Marbles on the table.
  struct Marble {
    vec2 at;
    float radius;
    int colour;
  };
  for (const Marble& marble :
       {Marble{{-0.98f, 1.66f}, 0.085f, t.paint.teal}, Marble{{-0.86f, 1.84f}, 0.065f, t.paint.coral},
        Marble{{2.02f, 1.12f}, 0.10f, t.paint.coral}, Marble{{0.10f, 2.06f}, 0.07f, t.paint.blue},
        Marble{{1.30f, 1.98f}, 0.075f, t.paint.sage}, Marble{{-0.62f, 0.86f}, 0.11f, t.paint.white}})
    t.add("marble", t.ball(marble.radius, {marble.at.x, marble.radius, marble.at.y}, 9.0f), marble.colour);
}

void add_table(Table& t) {
  const shapes::Points2 top = shapes::join({{{0.0f, -0.20f}, {2.95f, -0.20f}},
                                            shapes::arc({2.95f, -0.10f}, 0.10f, -90.0f, 90.0f, t.detail(8.0f, 3)),
                                            {{2.95f, 0.0f}, {0.0f, 0.0f}}});
  t.add("table", shapes::lathe(top, t.detail(96.0f, 24)), t.paint.table);
}

Scene build(const Detail& detail) {
  Table t{.scene = {}, .detail = detail, .paint = {}};
  t.paint = add_palette(t.scene);
  add_table(t);
  add_stairs(t);
  add_portal(t);
  add_leaning_torus(t);
  add_middle(t);
  add_knot(t);
  add_rings(t);
  add_bowl(t);
  add_small_things(t);
  t.scene.views = {{.eye = {0.65f, 3.9f, 8.7f}, .target = {0.0f, 0.42f, 0.2f}, .angle_deg = 33.0f},
                   {.eye = {3.2f, 1.7f, 4.6f}, .target = {0.25f, 0.45f, 0.45f}, .angle_deg = 30.0f}};
  return std::move(t.scene);
}

}  // namespace

Scene make_solids(int triangles) { return shapes::build_to_count(triangles, build); }

}  // namespace umbrage
