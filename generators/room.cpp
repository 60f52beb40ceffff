// The room: a furnished living room, 7 by 5.5 metres, with sunlight through its window. It has contact shadows (legs,
// books, skirting), soft rounded shapes, thin objects in front of walls, and coloured walls near pale ones.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "generators/makers.h"
#include "generators/noise.h"
#include "generators/procedural_texture.h"
#include "generators/shapes.h"

namespace umbrage {

namespace {

using namespace shapes;
using glm::mat4;
using glm::vec2;
using glm::vec3;

constexpr float kPi = std::numbers::pi_v<float>;

constexpr vec3 kRoom(3.5f, 2.8f, 2.75f);  // half width, height, half depth
// The window in the wall at -x: (z, y) of two corners.
constexpr vec2 kWindowLow(-1.25f, 0.86f), kWindowHigh(1.25f, 2.36f);
constexpr float kWallDepth = 0.28f;
constexpr int kBooks = 16;  // spines in the texture

struct Materials {
  int wall, accent, ceiling, floor, paint, oak, walnut, sofa, armchair, seat, pillow_a, pillow_b, curtain, rug, canvas,
      print, gilt, black, brass, shade, ceramic, porcelain, books, leaf, stem, petal_a, petal_b, terracotta, soil,
      fruit;
};

Materials add_materials(Scene& scene) {
  using namespace procedural;
  Materials m{};
  const MaterialMaker make{scene};
  m.wall = make.textured("cream wall", plaster(256, {0.74f, 0.69f, 0.59f}, 0.035f, 1));
  m.accent = make.textured("teal wall", plaster(256, {0.13f, 0.30f, 0.31f}, 0.06f, 2));
  m.ceiling = make.plain("ceiling", {0.80f, 0.79f, 0.76f});
  m.floor = make.textured("oak floor", wood(1024, 14, {0.50f, 0.31f, 0.16f}, {0.27f, 0.14f, 0.06f}, 3), 0.12f, 40.0f);
  m.paint = make.plain("white paint", {0.78f, 0.77f, 0.73f}, 0.1f, 40.0f);
  m.oak = make.textured("oak", wood(512, 1, {0.52f, 0.34f, 0.18f}, {0.36f, 0.20f, 0.09f}, 4), 0.1f, 40.0f);
  m.walnut = make.textured("walnut", wood(512, 1, {0.24f, 0.13f, 0.07f}, {0.12f, 0.06f, 0.03f}, 5), 0.15f, 50.0f);
  m.sofa = make.textured("sofa cloth", weave(256, 64, {0.52f, 0.15f, 0.06f}, 0.18f, 6));
  m.armchair = make.textured("armchair cloth", weave(256, 64, {0.50f, 0.42f, 0.30f}, 0.22f, 7));
  m.seat = make.textured("seat pads", weave(128, 32, {0.20f, 0.27f, 0.14f}, 0.2f, 8));
  m.pillow_a = make.textured("mustard damask", damask(512, {0.55f, 0.33f, 0.05f}, {0.70f, 0.58f, 0.34f}));
  const vec3 bands[] = {{0.70f, 0.66f, 0.57f}, {0.07f, 0.16f, 0.25f}, {0.70f, 0.66f, 0.57f}, {0.12f, 0.28f, 0.30f}};
  m.pillow_b = make.textured("striped cloth", stripes(512, bands, 9));
  m.curtain = make.textured("curtain cloth", weave(256, 96, {0.66f, 0.60f, 0.48f}, 0.12f, 10));
  m.rug =
      make.textured("rug", carpet(1024, 700, {0.40f, 0.06f, 0.05f}, {0.04f, 0.07f, 0.15f}, {0.62f, 0.50f, 0.30f}, 11));
  m.canvas = make.textured("painting", landscape_painting(512, 340, 12));
  m.print = make.textured("small painting", landscape_painting(256, 320, 77));
  m.gilt = make.plain("gilt frame", {0.50f, 0.34f, 0.11f}, 0.35f, 40.0f);
  m.black = make.plain("black iron", {0.035f, 0.035f, 0.04f}, 0.25f, 40.0f);
  m.brass = make.plain("brass", {0.52f, 0.36f, 0.13f}, 0.5f, 80.0f);
  m.shade =
      add_material(scene, {.name = "lamp shade", .albedo = {0.80f, 0.70f, 0.52f}, .emission = {0.26f, 0.19f, 0.10f}});
  m.ceramic = make.plain("blue glaze", {0.05f, 0.15f, 0.36f}, 0.7f, 120.0f);
  m.porcelain = make.plain("white glaze", {0.78f, 0.77f, 0.74f}, 0.6f, 120.0f);
  m.books = make.textured("books", book_spines(1024, 256, kBooks, 13));
  m.leaf = make.cut_out("leaves", leaf(256, {0.05f, 0.17f, 0.035f}, {0.14f, 0.28f, 0.08f}));
  m.stem = make.plain("stems", {0.10f, 0.22f, 0.05f});
  m.petal_a = make.plain("yellow tulips", {0.80f, 0.48f, 0.04f});
  m.petal_b = make.plain("red tulips", {0.65f, 0.06f, 0.05f});
  m.terracotta = make.plain("terracotta", {0.46f, 0.21f, 0.11f});
  m.soil = make.plain("soil", {0.08f, 0.055f, 0.035f});
  m.fruit = make.plain("oranges", {0.78f, 0.30f, 0.03f}, 0.3f, 50.0f);
  return m;
}

/// Moves a mesh from the origin to a place on the floor, rotated about y.
Mesh stand(Mesh mesh, vec3 at, float turn_deg = 0.0f) { return moved(turned_y(std::move(mesh), turn_deg), at); }

/// Makes a box with metre uvs whose grain (u) runs along its longest side.
Mesh plank(vec3 low, vec3 high, float bevel, int n) {
  Mesh mesh = box(low, high, bevel, n);
  box_uvs(mesh);
  const vec3 size = high - low;
  if (size.y > size.x && size.y > size.z) {
    for (vec2& uv : mesh.uvs) uv = {uv.y, uv.x};
  } else if (size.z > size.x) {
    for (std::size_t i = 0; i < mesh.uvs.size(); ++i)
      if (std::abs(mesh.normals[i].y) > 0.6f) mesh.uvs[i] = {mesh.uvs[i].y, mesh.uvs[i].x};
  }
  return mesh;
}

Points3 rectangle_path(vec2 half, float y, bool outwards) {
  if (outwards) return {{-half.x, y, -half.y}, {-half.x, y, half.y}, {half.x, y, half.y}, {half.x, y, -half.y}};
  return {{-half.x, y, -half.y}, {half.x, y, -half.y}, {half.x, y, half.y}, {-half.x, y, half.y}};
}

// ------------------------------------------------------------------------------------------------------- the shell

void add_shell(Scene& scene, const Materials& m, const Detail& d) {
  const float x = kRoom.x, h = kRoom.y, z = kRoom.z;
  Mesh floor = plane({-x, -z}, {x, z}, 0.0f, 1, 1);
  scale_uvs(floor, vec2(0.5f));
  add_mesh(scene, "floor", std::move(floor), m.floor);
  add_mesh(scene, "ceiling", flipped(plane({-x, -z}, {x, z}, h, 1, 1)), m.ceiling);
  add_mesh(scene, "back wall", quad({-x, 0, -z}, {x, 0, -z}, {x, h, -z}, {-x, h, -z}, 1, 1), m.accent);
  Mesh front = quad({x, 0, z}, {-x, 0, z}, {-x, h, z}, {x, h, z}, 1, 1);
  append(front, quad({x, 0, -z}, {x, 0, z}, {x, h, z}, {x, h, -z}, 1, 1));
  add_mesh(scene, "walls", std::move(front), m.wall);
  // From inside, the window wall's x runs towards -z.
  Mesh window_wall =
      wall_with_hole({2.0f * z, h}, {z - kWindowHigh.x, kWindowLow.y}, {z - kWindowLow.x, kWindowHigh.y}, kWallDepth);
  add_mesh(scene, "window wall", moved(turned_y(std::move(window_wall), 90.0f), {-x, 0, z}), m.wall);

  const Points2 skirting =
      join({{{0.018f, 0.0f}, {0.018f, 0.09f}}, arc({0.008f, 0.09f}, 0.010f, 0.0f, 90.0f, d(4, 2)), {{0.0f, 0.105f}}});
  add_mesh(scene, "skirting", moulding(rectangle_path({x, z}, 0.0f, false), skirting, true), m.paint);
  const Points2 cornice = join({{{0.0f, -0.15f}, {0.018f, -0.15f}, {0.018f, -0.15f}, {0.018f, -0.13f}},
                                arc({0.128f, -0.13f}, 0.11f, 180.0f, 90.0f, d(8, 2)),
                                {{0.128f, -0.02f}, {0.145f, -0.02f}, {0.145f, -0.02f}, {0.145f, 0.0f}}});
  add_mesh(scene, "cornice", moulding(rectangle_path({x, z}, h, false), cornice, true), m.ceiling);

  // The window: a frame deep in the wall, two mullions and a transom, and a sill board.
  const float in = -x - 0.6f * kWallDepth, wide = 0.055f, deep = 0.035f;
  const int n = d(1, 0);
  Mesh frame;
  const auto bar = [&](vec2 low, vec2 high) {
    append(frame, box({in - deep, low.y, low.x}, {in + deep, high.y, high.x}, 0.006f, n));
  };
  bar(kWindowLow, {kWindowHigh.x, kWindowLow.y + wide});
  bar({kWindowLow.x, kWindowHigh.y - wide}, kWindowHigh);
  bar({kWindowLow.x, kWindowLow.y + wide}, {kWindowLow.x + wide, kWindowHigh.y - wide});
  bar({kWindowHigh.x - wide, kWindowLow.y + wide}, {kWindowHigh.x, kWindowHigh.y - wide});
  const float width = kWindowHigh.x - kWindowLow.x;
  for (const float fraction : {1.0f / 3.0f, 2.0f / 3.0f}) {
    const float middle = kWindowLow.x + fraction * width;
    bar({middle - 0.5f * wide, kWindowLow.y + wide}, {middle + 0.5f * wide, kWindowHigh.y - wide});
  }
  const float transom = kWindowLow.y + 0.68f * (kWindowHigh.y - kWindowLow.y);
  for (int i = 0; i < 3; ++i) {
    const float from = kWindowLow.x + width * float(i) / 3.0f, to = kWindowLow.x + width * float(i + 1) / 3.0f;
    bar({from + 0.5f * wide, transom - 0.02f}, {to - 0.5f * wide, transom + 0.02f});
  }
  const int id = add_mesh(scene, "window frame", std::move(frame), m.paint);
  add_mesh(scene, "window sill",
           box({in, kWindowLow.y - 0.03f, kWindowLow.x - 0.08f},
               {-x + 0.12f, kWindowLow.y + 0.008f, kWindowHigh.x + 0.08f}, 0.008f, n),
           m.paint, id);

  // Radiator under the window.
  Mesh radiator;
  constexpr int kFins = 16;
  constexpr float kFin = 0.085f;
  for (int i = 0; i < kFins; ++i) {
    const float at = (float(i) - 0.5f * float(kFins - 1)) * kFin;
    append(radiator, box({-x + 0.045f, 0.14f, at - 0.033f}, {-x + 0.145f, 0.70f, at + 0.033f}, 0.028f, d(3, 0)));
  }
  const float half = 0.5f * kFin * float(kFins);
  for (const float y : {0.2f, 0.64f})
    append(radiator, box({-x + 0.075f, y - 0.02f, -half}, {-x + 0.115f, y + 0.02f, half}, 0.01f, n));
  for (const float at : {-half + 0.12f, half - 0.12f})
    append(radiator, box({-x + 0.08f, 0.0f, at - 0.015f}, {-x + 0.11f, 0.15f, at + 0.015f}));
  add_mesh(scene, "radiator", std::move(radiator), m.paint);

  // A door in the wall at +x.
  Mesh door = box({x - 0.03f, 0.0f, 0.6f}, {x + 0.01f, 2.08f, 1.5f});
  for (const vec2 span : {vec2(0.2f, 0.9f), vec2(1.05f, 1.9f)})
    append(door, box({x - 0.045f, span.x, 0.74f}, {x, span.y, 1.36f}, 0.014f, n));
  for (const float at : {0.5f, 1.5f}) append(door, box({x - 0.05f, 0.0f, at}, {x + 0.01f, 2.08f, at + 0.1f}, 0.01f, n));
  append(door, box({x - 0.05f, 2.08f, 0.5f}, {x + 0.01f, 2.18f, 1.6f}, 0.01f, n));
  add_mesh(scene, "door", std::move(door), m.paint);
}

void add_curtains(Scene& scene, const Materials& m, const Detail& d) {
  constexpr float kRod = 2.52f, kWidth = 0.62f;
  const float out = -kRoom.x + 0.17f;
  Mesh cloth;
  int seed = 5;
  for (const float at : {kWindowLow.x - 0.2f, kWindowHigh.x + 0.2f})
    append(cloth,
           moved(turned_y(drape(kWidth, kRod - 0.02f, 6.0f, 0.055f, std::uint32_t(seed++), d(96, 14), d(36, 4)), 90.0f),
                 {out, kRod, at}));
  scale_uvs(cloth, vec2(2.0f));
  const int id = add_mesh(scene, "curtains", std::move(cloth), m.curtain);
  const float reach = kWindowHigh.x + 0.62f;
  const Points3 rod = {{out, kRod, -reach}, {out, kRod, reach}};
  Mesh metal = tube(rod, 0.016f, d(12, 6));
  for (const float end : {-reach, reach}) append(metal, moved(sphere(0.035f, d(16, 8), d(10, 4)), {out, kRod, end}));
  for (const float at : {-reach + 0.15f, 0.0f, reach - 0.15f})
    append(metal, box({-kRoom.x, kRod - 0.015f, at - 0.012f}, {out, kRod + 0.015f, at + 0.012f}));
  add_mesh(scene, "curtain rod", std::move(metal), m.brass, id);
}

// ------------------------------------------------------------------------------------------------------- furniture

/// Makes a soft block with a crowned top, around its own centre.
Mesh upholstery(vec3 size, int n) {
  Mesh mesh = superellipsoid(0.5f * size, 7.0f, n);
  box_uvs(mesh);
  return mesh;
}

/// A sofa or armchair facing +z at the origin, with `seats` places of 0.72 m, as cloth and legs.
struct Seating {
  Mesh cloth, wood;
};
Seating seating(int seats, const Detail& d) {
  constexpr float kSeat = 0.72f, kArm = 0.20f, kDepth = 0.92f, kLeg = 0.13f;
  const float inner = kSeat * float(seats), half = 0.5f * inner + kArm, back = -0.5f * kDepth, front = 0.5f * kDepth;
  const int n = d(18, 4), bevel = d(4, 0);
  Seating s;
  append(s.cloth, box({-half + 0.02f, kLeg, back + 0.03f}, {half - 0.02f, 0.30f, front - 0.03f}, 0.03f, bevel));
  for (const float side : {-1.0f, 1.0f}) {
    const float from = side < 0.0f ? -half : half - kArm;
    append(s.cloth, box({from, kLeg, back}, {from + kArm, 0.60f, front}, 0.075f, bevel));
  }
  append(s.cloth, moved(turned_x(box({-half + 0.03f, 0.0f, -0.11f}, {half - 0.03f, 0.70f, 0.11f}, 0.08f, bevel), -8.0f),
                        {0, kLeg + 0.02f, back + 0.14f}));
  for (int i = 0; i < seats; ++i) {
    const float x = kSeat * (float(i) - 0.5f * float(seats - 1));
    append(s.cloth, moved(upholstery({kSeat - 0.006f, 0.19f, 0.70f}, n), {x, 0.375f, 0.10f}));
    append(s.cloth, moved(turned_x(upholstery({kSeat - 0.01f, 0.46f, 0.19f}, n), -13.0f), {x, 0.655f, back + 0.33f}));
  }
  box_uvs(s.cloth);
  for (const float x : {-half + 0.09f, half - 0.09f})
    for (const float z : {back + 0.10f, front - 0.10f})
      append(s.wood, moved(cone(0.018f, 0.03f, kLeg + 0.02f, d(14, 6)), {x, 0, z}));
  return s;
}

void add_seating(Scene& scene, const Materials& m, const Detail& d) {
  const auto place = [&](const char* name, int seats, int cloth, vec3 at, float turn) {
    Seating s = seating(seats, d);
    scale_uvs(s.cloth, vec2(4.0f));
    const int id = add_mesh(scene, name, stand(std::move(s.cloth), at, turn), cloth);
    add_mesh(scene, std::string(name) + " legs", stand(std::move(s.wood), at, turn), m.walnut, id);
  };
  const vec3 sofa(-0.55f, 0.0f, -kRoom.z + 0.56f);
  place("sofa", 3, m.sofa, sofa, 0.0f);
  place("armchair", 1, m.armchair, {1.75f, 0.0f, -0.35f}, -62.0f);
  const auto pillow = [&](const char* name, int material, vec3 at, float lean, float turn, float roll) {
    Mesh mesh = cushion({0.46f, 0.17f, 0.46f}, d(28, 5));
    scale_uvs(mesh, vec2(1.6f));
    mesh = turned_y(turned_x(turned_y(std::move(mesh), roll), 90.0f - lean), turn);
    add_mesh(scene, name, moved(std::move(mesh), at), material);
  };
  pillow("mustard pillow", m.pillow_a, sofa + vec3(-0.80f, 0.665f, 0.14f), 24.0f, 16.0f, 8.0f);
  pillow("striped pillow", m.pillow_b, sofa + vec3(-0.47f, 0.645f, 0.22f), 32.0f, -8.0f, -6.0f);
  pillow("second mustard pillow", m.pillow_a, sofa + vec3(0.82f, 0.66f, 0.15f), 25.0f, -14.0f, 5.0f);
}

/// Makes a chair facing +z at the origin.
Seating chair(const Detail& d) {
  constexpr float kHalf = 0.20f, kHigh = 0.455f, kBack = 0.92f;
  const int sides = d(10, 5);
  Seating s;
  for (const float x : {-1.0f, 1.0f}) {
    const Points3 front = {{x * (kHalf - 0.01f), 0, kHalf + 0.01f},
                           {x * (kHalf - 0.03f), kHigh - 0.02f, kHalf - 0.02f}};
    const Points3 rear_bones = {{x * (kHalf - 0.02f), 0, -kHalf - 0.05f},
                                {x * (kHalf - 0.03f), 0.25f, -kHalf - 0.005f},
                                {x * (kHalf - 0.03f), kHigh, -kHalf + 0.01f},
                                {x * (kHalf - 0.015f), 0.7f, -kHalf - 0.03f},
                                {x * kHalf, kBack, -kHalf - 0.10f}};
    append(s.wood, tube(front, 0.018f, sides, false, std::vector<float>{0.75f, 1.1f}));
    const Points3 rear = smooth(rear_bones, d(4, 1));
    append(s.wood, tube(rear, 0.018f, sides));
    const Points3 stretcher = {{x * (kHalf - 0.02f), 0.20f, kHalf}, {x * (kHalf - 0.025f), 0.20f, -kHalf - 0.01f}};
    append(s.wood, tube(stretcher, 0.011f, sides));
  }
  const Points3 across = {{-kHalf + 0.02f, 0.20f, 0.0f}, {kHalf - 0.02f, 0.20f, 0.0f}};
  append(s.wood, tube(across, 0.011f, sides));
  append(s.wood, box({-kHalf - 0.01f, kHigh - 0.035f, -kHalf}, {kHalf + 0.01f, kHigh, kHalf + 0.02f}, 0.014f, d(2, 0)));
  for (const float y : {0.60f, 0.73f, 0.86f}) {
    // Slats bow backwards between the uprights.
    const float z = -kHalf - 0.02f - 0.34f * std::max(y - 0.66f, 0.0f);
    const Points3 bones = {
        {-kHalf + 0.01f, y, z}, {-0.5f * kHalf, y, z - 0.028f}, {0.5f * kHalf, y, z - 0.028f}, {kHalf - 0.01f, y, z}};
    const Points3 path = smooth(bones, d(4, 1));
    append(s.wood, sweep(path, rectangle({0.016f, 0.075f}, 0.006f, d(2, 0)), {0, 0, 1}));
  }
  append(s.cloth, moved(upholstery({2.0f * kHalf, 0.05f, 2.0f * kHalf}, d(12, 4)), {0, kHigh + 0.018f, 0.01f}));
  return s;
}

/// Adds a tulip: stem from the origin bending outwards, and a bud of closed petals.
void add_tulip(Mesh& stems, Mesh& petals, vec3 root, vec3 tip, const Detail& d) {
  const vec3 middle =
      0.5f * (root + tip) + vec3(0.0f, 0.05f, 0.0f) - 0.25f * vec3(tip.x - root.x, 0.0f, tip.z - root.z);
  const Points3 bones = {root, middle, tip};
  const Points3 path = smooth(bones, d(5, 2));
  append(stems, tube(path, 0.0042f, d(6, 4)));
  const vec3 along = glm::normalize(path.back() - path[path.size() - 2]);
  Mesh bud = surface(d(24, 8), d(10, 4),
                     [](float u, float v) {
                       const float turn = 2.0f * kPi * u, lobes = 1.0f + 0.10f * std::cos(6.0f * kPi * u);
                       const float r = 0.028f * std::pow(std::sin(kPi * (0.04f + 0.80f * v)), 0.7f) * lobes;
                       const float y = 0.075f * v * (1.0f + 0.10f * v * std::cos(6.0f * kPi * u));
                       return SurfacePoint{{r * std::sin(turn), y, r * std::cos(turn)}, {u, v}};
                     },
                     {.u = true});
  const vec3 axis = glm::cross(vec3(0, 1, 0), along);
  if (glm::length(axis) > 1e-4f)
    bud = turned(std::move(bud), glm::normalize(axis), glm::degrees(std::acos(std::clamp(along.y, -1.0f, 1.0f))));
  append(petals, moved(std::move(bud), tip - 0.006f * along));
}

/// Makes a hollow vase on y = 0.
Mesh vase(std::span<const vec2> side, const Detail& d) {
  Points2 outer = smooth(side, d(6, 2));
  Points2 inner;
  for (auto p = outer.rbegin(); p != outer.rend(); ++p)
    if (p->y > 0.3f * outer.back().y) inner.emplace_back(std::max(p->x - 0.007f, 0.004f), p->y - 0.001f);
  return lathe(join({{{0.0f, 0.0f}}, outer, inner, {{0.0f, inner.back().y}}}), d(40, 10));
}

/// Place and height of the dining table.
constexpr vec3 kDining(-1.75f, 0.0f, 1.22f);
constexpr float kDiningHigh = 0.75f;

Mesh dining_table(const Detail& d) {
  constexpr float kHigh = kDiningHigh, kRadius = 0.60f;
  Mesh table = lathe(join({{{0.0f, kHigh - 0.035f}, {kRadius - 0.02f, kHigh - 0.035f}},
                           arc({kRadius - 0.012f, kHigh - 0.015f}, 0.015f, -80.0f, 90.0f, d(5, 2)),
                           {{0.0f, kHigh}}}),
                     d(72, 16));
  box_uvs(table);
  const Points2 pillar = {{0.05f, 0.16f},  {0.075f, 0.22f}, {0.05f, 0.30f},         {0.04f, 0.45f},
                          {0.045f, 0.62f}, {0.09f, 0.70f},  {0.16f, kHigh - 0.035f}};
  append(table, lathe(smooth(pillar, d(4, 1)), d(24, 8)));
  for (int i = 0; i < 4; ++i) {
    const Points3 bones = {{0.0f, 0.25f, 0.03f}, {0.0f, 0.22f, 0.14f}, {0.0f, 0.09f, 0.27f}, {0.0f, 0.018f, 0.40f}};
    const Points3 path = smooth(bones, d(4, 1));
    std::vector<float> scale;
    for (std::size_t k = 0; k < path.size(); ++k) scale.push_back(1.0f - 0.45f * float(k) / float(path.size() - 1));
    Mesh foot = sweep(path, rectangle({0.05f, 0.064f}, 0.015f, d(2, 0)), {1, 0, 0}, false, scale);
    append(foot, moved(sphere(0.022f, d(12, 6), d(8, 4)), {0, 0.021f, 0.40f}));
    append(table, turned_y(std::move(foot), 45.0f + 90.0f * float(i)));
  }
  return table;
}

/// Adds the table by the window, with three chairs. Returns the table's object id.
int add_dining_table(Scene& scene, const Materials& m, const Detail& d) {
  const int table_id = add_mesh(scene, "dining table", stand(dining_table(d), kDining), m.oak);
  const auto seat = [&](float turn, float away) {
    const vec3 place = kDining + vec3(away * std::sin(glm::radians(turn)), 0.0f, away * std::cos(glm::radians(turn)));
    Seating s = chair(d);
    scale_uvs(s.cloth, vec2(6.0f));
    const int id = add_mesh(scene, "chair", stand(std::move(s.wood), place, turn + 180.0f), m.walnut);
    add_mesh(scene, "chair pad", stand(std::move(s.cloth), place, turn + 180.0f), m.seat, id);
  };
  seat(68.0f, 0.78f);
  seat(185.0f, 0.72f);
  seat(-62.0f, 0.70f);
  return table_id;
}

void add_vase(Scene& scene, const Materials& m, const Detail& d) {
  const Points2 jug = {{0.045f, 0.0f}, {0.075f, 0.05f},  {0.085f, 0.10f},
                       {0.06f, 0.17f}, {0.038f, 0.215f}, {0.048f, 0.25f}};
  const vec3 vase_at = kDining + vec3(-0.06f, kDiningHigh, -0.05f);
  const int vase_id = add_mesh(scene, "vase", moved(vase(jug, d), vase_at), m.ceramic);
  Mesh stems, petals[2];
  noise::Random random{noise::hash(21u)};
  for (int i = 0; i < 11; ++i) {
    const float turn = 2.4f * float(i), lean = i == 0 ? 0.0f : random.between(0.06f, 0.19f),
                high = random.between(0.40f, 0.52f);
    const vec3 tip(lean * std::sin(turn), high - 0.5f * lean, lean * std::cos(turn));
    add_tulip(stems, petals[i % 2], vase_at + vec3(0.12f * tip.x, 0.12f, 0.12f * tip.z), vase_at + tip, d);
  }
  add_mesh(scene, "tulip stems", std::move(stems), m.stem, vase_id);
  add_mesh(scene, "yellow tulips", std::move(petals[0]), m.petal_a, vase_id);
  add_mesh(scene, "red tulips", std::move(petals[1]), m.petal_b, vase_id);
}

void add_cup_and_plate(Scene& scene, const Materials& m, const Detail& d, int table_id) {
  const vec3 plate_at = kDining + vec3(0.33f, kDiningHigh, 0.05f);
  const vec3 cup_at = kDining + vec3(0.33f, kDiningHigh + 0.011f, 0.05f);
  Mesh china;
  const Points2 plate = {{0.055f, 0.0f},   {0.075f, 0.006f}, {0.125f, 0.020f},
                         {0.127f, 0.024f}, {0.075f, 0.012f}, {0.0f, 0.010f}};
  append(china, moved(lathe(plate, d(36, 10)), plate_at));
  const Points2 cup = {{0.022f, 0.0f},   {0.026f, 0.004f}, {0.036f, 0.03f}, {0.042f, 0.07f},
                       {0.040f, 0.072f}, {0.033f, 0.03f},  {0.0f, 0.012f}};
  append(china, moved(lathe(join({{{0.0f, 0.0f}}, smooth(cup, d(3, 1))}), d(28, 8)), cup_at));
  const Points3 handle_bones = {{0.036f, 0.055f, 0}, {0.062f, 0.058f, 0}, {0.060f, 0.028f, 0}, {0.034f, 0.022f, 0}};
  const Points3 handle = smooth(handle_bones, d(4, 2));
  append(china, moved(turned_y(tube(handle, 0.0045f, d(8, 4)), 40.0f), cup_at));
  add_mesh(scene, "cup and plate", std::move(china), m.porcelain, table_id);
}

/// Adds the low table in front of the sofa on the rug, with a bowl of oranges.
void add_low_table(Scene& scene, const Materials& m, const Detail& d) {
  const vec3 low(-0.35f, 0.0f, -0.78f);
  constexpr float kLow = 0.40f;
  constexpr vec2 kHalf(0.58f, 0.31f);
  Mesh coffee = plank({-kHalf.x, kLow - 0.035f, -kHalf.y}, {kHalf.x, kLow, kHalf.y}, 0.008f, d(2, 0));
  append(coffee, plank({-kHalf.x + 0.07f, 0.14f, -kHalf.y + 0.05f}, {kHalf.x - 0.07f, 0.16f, kHalf.y - 0.05f}, 0.005f,
                       d(1, 0)));
  for (const float x : {-1.0f, 1.0f})
    for (const float z : {-1.0f, 1.0f})
      append(coffee, moved(turned_z(turned_x(cone(0.014f, 0.024f, kLow - 0.02f, d(12, 6)), z * -5.0f), x * 5.0f),
                           {x * (kHalf.x - 0.05f), 0.012f, z * (kHalf.y - 0.04f)}));
  add_mesh(scene, "low table", moved(std::move(coffee), low), m.walnut);
  const vec3 bowl_at = low + vec3(0.26f, kLow, 0.0f);
  const Points2 bowl = {{0.05f, 0.0f},    {0.06f, 0.008f}, {0.12f, 0.04f},  {0.155f, 0.09f},
                        {0.150f, 0.092f}, {0.11f, 0.045f}, {0.05f, 0.018f}, {0.0f, 0.016f}};
  const int bowl_id = add_mesh(
      scene, "bowl", moved(lathe(join({{{0.0f, 0.0f}}, smooth(bowl, d(3, 1))}), d(40, 10)), bowl_at), m.porcelain);
  Mesh fruit;
  for (const vec3 f : {vec3(-0.045f, 0.060f, 0.03f), vec3(0.045f, 0.060f, 0.03f), vec3(0.0f, 0.060f, -0.05f),
                       vec3(0.0f, 0.118f, 0.005f)})
    append(fruit, moved(sphere(0.040f, d(24, 8), d(16, 6)), bowl_at + f));
  add_mesh(scene, "oranges", std::move(fruit), m.fruit, bowl_id);
}

void add_rug(Scene& scene, const Materials& m, const Detail& d) {
  constexpr vec2 kHalf(1.45f, 1.0f);
  constexpr float kThick = 0.014f;
  constexpr float kAbove = 3e-4f;  // above the floor, in whose plane rounding would decide which of them is visible
  Mesh rug = box({-kHalf.x, 0.0f, -kHalf.y}, {kHalf.x, kThick, kHalf.y}, 0.007f, d(2, 0));
  for (std::size_t i = 0; i < rug.uvs.size(); ++i)
    rug.uvs[i] = {0.5f + 0.4995f * rug.positions[i].x / kHalf.x, 0.5f - 0.4995f * rug.positions[i].z / kHalf.y};
  add_mesh(scene, "rug", stand(std::move(rug), {-0.25f, kAbove, -0.62f}, 3.0f), m.rug);
}

// ----------------------------------------------------------------------------------------------------- small things

/// Appends books in a row from x = 0 until `width` is full, spines at +z, standing on y = 0.
void add_book_row(Mesh& books, vec3 at, float width, float space_above, noise::Random& random, const Detail& d) {
  float x = 0.0f;
  while (true) {
    const float thick = random.between(0.018f, 0.05f), high = std::min(random.between(0.19f, 0.29f), space_above),
                deep = random.between(0.15f, 0.21f);
    const int spine = int(random.next() * kBooks) % kBooks;
    const bool leans = x > 0.5f * width && random.next() < 0.12f;
    const float lean = leans ? random.between(6.0f, 11.0f) : 0.0f;
    const float need = thick + (leans ? high * std::sin(glm::radians(lean)) + 0.004f : 0.0f);
    if (x + need > width) return;
    Mesh book = box({0, 0, -deep}, {thick, high, 0}, 0.004f, d(1, 0));
    for (std::size_t i = 0; i < book.uvs.size(); ++i) {
      const vec3 p = book.positions[i];
      book.uvs[i] = {(float(spine) + std::clamp(p.x / thick, 0.04f, 0.96f)) / float(kBooks),
                     std::clamp(p.y / high, 0.01f, 0.99f)};
    }
    if (leans) book = moved(turned_z(std::move(book), lean), {high * std::sin(glm::radians(lean)), 0, 0});
    append(books, moved(std::move(book), at + vec3(x, 0, random.between(-0.02f, 0.0f))));
    x += need + 0.0015f;
  }
}

void add_shelf(Scene& scene, const Materials& m, const Detail& d) {
  constexpr float kHalf = 0.62f, kHigh = 2.05f, kDeep = 0.30f, kBoard = 0.024f, kFoot = 0.08f;
  constexpr int kShelves = 5;
  const vec3 at(1.72f, 0.0f, -kRoom.z + 0.02f);
  const int n = d(1, 0);
  Mesh frame;
  for (const float x : {-kHalf, kHalf - kBoard})
    append(frame, plank({x, 0.0f, 0.0f}, {x + kBoard, kHigh, kDeep}, 0.003f, n));
  append(frame, plank({-kHalf + kBoard, kFoot, 0.0f}, {kHalf - kBoard, kHigh - 0.01f, 0.008f}, 0.0f, 1));
  append(frame, plank({-kHalf - 0.02f, kHigh, -0.01f}, {kHalf + 0.02f, kHigh + 0.03f, kDeep + 0.02f}, 0.006f, n));
  append(frame, plank({-kHalf + kBoard, 0.0f, kDeep - 0.04f}, {kHalf - kBoard, kFoot, kDeep - 0.02f}, 0.0f, 1));
  const float pitch = (kHigh - kFoot) / float(kShelves);
  for (int i = 0; i < kShelves; ++i) {
    const float y = kFoot + pitch * float(i);
    append(frame, plank({-kHalf + kBoard, y, 0.008f}, {kHalf - kBoard, y + kBoard, kDeep - 0.005f}, 0.003f, n));
  }
  const int id = add_mesh(scene, "bookshelf", moved(std::move(frame), at), m.oak);
  Mesh books;
  noise::Random random{noise::hash(31u)};
  const float inside = 2.0f * (kHalf - kBoard) - 0.01f;
  // Part of each shelf that is filled with books, from the left or from the right; other objects fill the rest.
  constexpr struct {
    float from, fraction;
  } kRows[kShelves] = {{0.0f, 1.0f}, {0.0f, 0.62f}, {0.36f, 0.64f}, {0.0f, 0.86f}, {0.30f, 0.44f}};
  for (int i = 0; i < kShelves; ++i) {
    const float y = kFoot + pitch * float(i) + kBoard;
    add_book_row(books, at + vec3(-kHalf + kBoard + 0.005f + kRows[i].from * inside, y, kDeep - 0.035f),
                 kRows[i].fraction * inside, pitch - kBoard - 0.03f, random, d);
  }
  // A horizontal pile.
  float pile = kFoot + pitch + kBoard;
  for (int i = 0; i < 3; ++i) {
    const float thick = 0.028f + 0.008f * float(i % 2);
    Mesh book = box({-0.13f + 0.01f * float(i), 0, -0.085f}, {0.13f - 0.012f * float(i), thick, 0.085f}, 0.004f, n);
    for (vec2& uv : book.uvs) uv = {(float((i * 5 + 2) % kBooks) + 0.5f) / float(kBooks), 0.4f};
    append(books, moved(turned_y(std::move(book), 6.0f * float(i) - 5.0f), at + vec3(0.36f, pile, 0.16f)));
    pile += thick;
  }
  add_mesh(scene, "books", std::move(books), m.books, id);
  const Points2 urn = {{0.03f, 0.0f},   {0.05f, 0.02f}, {0.085f, 0.10f},
                       {0.075f, 0.17f}, {0.03f, 0.21f}, {0.042f, 0.235f}};
  add_mesh(scene, "urn", moved(vase(urn, d), at + vec3(-0.40f, kFoot + 2.0f * pitch + kBoard, 0.16f)), m.ceramic);
  const Points2 white = {{0.04f, 0.0f},   {0.06f, 0.03f}, {0.05f, 0.11f},
                         {0.022f, 0.17f}, {0.02f, 0.24f}, {0.03f, 0.26f}};
  add_mesh(scene, "white vase", moved(vase(white, d), at + vec3(-0.42f, kFoot + 4.0f * pitch + kBoard, 0.16f)),
           m.porcelain);
  Mesh globe = moved(sphere(0.085f, d(32, 10), d(20, 6)), {0, 0.155f, 0});
  Mesh stand_mesh = lathe(join({{{0.0f, 0.0f}, {0.06f, 0.0f}},
                                arc({0.055f, 0.006f}, 0.006f, 0.0f, 90.0f, d(3, 1)),
                                {{0.012f, 0.02f}, {0.010f, 0.07f}}}),
                          d(24, 8));
  append(stand_mesh,
         moved(turned_z(turned_x(torus(0.097f, 0.006f, d(40, 12), d(8, 4)), 90.0f), 20.0f), {0, 0.155f, 0}));
  const vec3 globe_at = at + vec3(0.40f, kFoot + 4.0f * pitch + kBoard, 0.16f);
  const int globe_id = add_mesh(scene, "globe", moved(std::move(globe), globe_at), m.ceramic);
  add_mesh(scene, "globe stand", moved(std::move(stand_mesh), globe_at), m.brass, globe_id);
}

/// Adds a framed picture in the plane z = 0, facing +z, around its centre.
void add_picture(Scene& scene, const char* name, vec2 half, vec3 at, int picture, int frame_material, const Detail& d) {
  const float w = 0.055f, t = 0.03f;
  const Points2 section =
      join({{{0.0f, 0.0f}, {0.0f, 0.6f * t}},
            arc({-0.4f * t, 0.6f * t}, 0.4f * t, 0.0f, 90.0f, d(4, 1)),
            smooth(Points2{{-0.014f, t}, {-0.024f, 0.7f * t}, {-0.04f, 0.75f * t}, {-w, 0.4f * t}}, d(3, 1)),
            {{-w, 0.1f * t}}});
  Mesh frame = turned_x(moulding(rectangle_path(half + vec2(w), 0.0f, true), section, true), 90.0f);
  const int id = add_mesh(scene, name, moved(std::move(frame), at), frame_material);
  Mesh canvas = quad({-half.x, -half.y, 0.008f}, {half.x, -half.y, 0.008f}, {half.x, half.y, 0.008f},
                     {-half.x, half.y, 0.008f}, 1, 1);
  scale_uvs(canvas, vec2(0.998f) / (2.0f * half));
  add_mesh(scene, std::string(name) + " canvas", moved(std::move(canvas), at), picture, id);
}

void add_lamps(Scene& scene, const Materials& m, vec3 floor_lamp, const Detail& d) {
  Mesh metal = lathe(join({{{0.0f, 0.0f}, {0.15f, 0.0f}, {0.15f, 0.0f}, {0.15f, 0.012f}},
                           arc({0.142f, 0.012f}, 0.008f, 0.0f, 90.0f, d(3, 1)),
                           smooth(Points2{{0.05f, 0.026f}, {0.018f, 0.045f}, {0.012f, 0.09f}}, d(4, 1)),
                           {{0.012f, 1.42f}, {0.012f, 1.42f}, {0.0f, 1.42f}}}),
                     d(32, 8));
  append(metal, moved(sphere(0.03f, d(16, 8), d(10, 4)), {0, 0.75f, 0}));
  const int id = add_mesh(scene, "floor lamp", moved(std::move(metal), floor_lamp), m.brass);
  const auto shade = [&d](float low_radius, float high_radius, float low, float high) {
    constexpr float kThick = 0.004f;
    return lathe(sharp(Points2{{low_radius - kThick, low},
                               {low_radius, low},
                               {high_radius, high},
                               {high_radius - kThick, high},
                               {low_radius - kThick, low}}),
                 d(48, 12));
  };
  add_mesh(scene, "floor lamp shade", moved(shade(0.23f, 0.155f, 1.36f, 1.64f), floor_lamp), m.shade, id);
  Mesh spider;
  for (int i = 0; i < 3; ++i)
    append(spider, turned_y(moved(turned_z(cylinder(0.003f, 0.208f, d(6, 4)), -90.0f), {0.0f, 1.415f, 0.0f}),
                            120.0f * float(i)));
  add_mesh(scene, "floor lamp arms", moved(std::move(spider), floor_lamp), m.brass, id);

  const vec3 over(-1.75f, 0.0f, 1.22f);
  constexpr float kLow = 1.62f;
  const Points2 bell = {
      {0.24f, kLow}, {0.225f, kLow + 0.05f}, {0.15f, kLow + 0.13f}, {0.05f, kLow + 0.18f}, {0.03f, kLow + 0.24f}};
  Points2 outer = smooth(bell, d(5, 2)), inner;
  for (auto p = outer.rbegin(); p != outer.rend(); ++p)
    inner.emplace_back(std::max(p->x - 0.006f, 0.002f), p->y - 0.003f);
  Mesh pendant = lathe(join({outer, {{0.0f, kLow + 0.245f}}}), d(40, 10));
  append(pendant, moved(cylinder(0.004f, kRoom.y - kLow - 0.24f, d(6, 4)), {0, kLow + 0.24f, 0}));
  append(pendant, moved(cone(0.05f, 0.05f, 0.025f, d(20, 8)), {0, kRoom.y - 0.025f, 0}));
  const int pendant_id = add_mesh(scene, "pendant lamp", moved(std::move(pendant), over), m.black);
  add_mesh(scene, "pendant lamp inside", moved(lathe(join({inner, {{0.24f, kLow}}}), d(40, 10)), over), m.porcelain,
           pendant_id);
  add_mesh(scene, "pendant bulb", moved(sphere(0.05f, d(20, 8), d(12, 6)), over + vec3(0, kLow + 0.08f, 0)), m.shade,
           pendant_id);
}

/// Adds a rubber plant in a pot: upright stems with broad leaves.
void add_plant(Scene& scene, const Materials& m, vec3 at, const Detail& d) {
  const Points2 side = {{0.15f, 0.0f}, {0.17f, 0.12f}, {0.205f, 0.30f}};
  const int s = d(3, 1);
  Mesh pot = lathe(
      join({{{0.0f, 0.0f}},
            smooth(side, s),
            {{0.222f, 0.30f}, {0.226f, 0.37f}, {0.226f, 0.37f}, {0.205f, 0.372f}, {0.205f, 0.372f}, {0.195f, 0.33f}}}),
      d(36, 10));
  const int id = add_mesh(scene, "plant pot", moved(std::move(pot), at), m.terracotta);
  add_mesh(scene, "plant soil", moved(lathe(Points2{{0.2f, 0.335f}, {0.0f, 0.345f}}, d(24, 8)), at), m.soil, id);
  Mesh stems, leaves;
  noise::Random random{noise::hash(51u)};
  constexpr int kStems = 5, kLeaves = 9;
  for (int k = 0; k < kStems; ++k) {
    const float turn = 2.0f * kPi * (float(k) + 0.4f * random.next()) / kStems, lean = random.between(0.10f, 0.30f),
                high = random.between(0.85f, 1.45f);
    const vec3 root(0.05f * std::sin(turn), 0.33f, 0.05f * std::cos(turn)),
        tip(lean * std::sin(turn), 0.33f + high, lean * std::cos(turn));
    const Points3 bones = {root, 0.5f * (root + tip) - vec3(0.2f * tip.x, 0.0f, 0.2f * tip.z), tip};
    const Points3 path = smooth(bones, d(6, 2));
    append(stems, tube(path, 0.008f, d(8, 4)));
    for (int i = 0; i < kLeaves; ++i) {
      const float fraction = 0.22f + 0.78f * float(i) / float(kLeaves - 1);
      const vec3 from = path[std::size_t(fraction * float(path.size() - 1) + 0.5f)];
      const float direction = glm::degrees(turn) + 137.5f * float(i) + random.between(-25.0f, 25.0f);
      const float size = random.between(0.20f, 0.30f) * (1.1f - 0.3f * fraction),
                  steep = glm::radians(random.between(25.0f, 70.0f)), bow = random.between(0.9f, 1.7f);
      Mesh blade = surface(d(4), d(8, 3), [&](float u, float v) {
        const float end = steep - bow * v;
        const float out = size * (std::sin(steep) - std::sin(end)) / bow,
                    up = size * (std::cos(end) - std::cos(steep)) / bow;
        const float across = (0.5f - u) * 0.6f * size, cup = 0.35f * std::abs(across);
        return SurfacePoint{{across, up + cup * std::cos(end), out - cup * std::sin(end)}, {u, v}};
      });
      append(leaves, moved(turned_y(std::move(blade), direction), from));
    }
  }
  add_mesh(scene, "plant stems", moved(std::move(stems), at), m.stem, id);
  add_mesh(scene, "plant leaves", moved(std::move(leaves), at), m.leaf, id);
}

constexpr vec3 kFloorLamp(-2.28f, 0.0f, -2.2f);

Scene build(const Materials& m, const Detail& d) {
  Scene scene;
  add_shell(scene, m, d);
  add_curtains(scene, m, d);
  add_rug(scene, m, d);
  add_seating(scene, m, d);
  const int table_id = add_dining_table(scene, m, d);
  add_vase(scene, m, d);
  add_cup_and_plate(scene, m, d, table_id);
  add_low_table(scene, m, d);
  add_shelf(scene, m, d);
  add_picture(scene, "painting", {0.60f, 0.40f}, {-0.85f, 1.62f, -kRoom.z + 0.004f}, m.canvas, m.gilt, d);
  add_picture(scene, "small painting", {0.20f, 0.25f}, {0.35f, 1.62f, -kRoom.z + 0.004f}, m.print, m.walnut, d);
  add_lamps(scene, m, kFloorLamp, d);
  add_plant(scene, m, {-3.05f, 0.0f, -2.25f}, d);
  return scene;
}

}  // namespace

Scene make_room(int triangles) {
  Scene scene = build_with_materials("room", triangles, add_materials, build);
  // The sun through the window, and lights without shadows for indirect light of the window and the lamp. The latter is
  // as far from the walls as its reach: closer, it would be a bright disc on a wall.
  constexpr float kGlow = 0.18f;  // metres: radius of the lamp's shade, which glows as a whole
  scene.lights = {{.direction = glm::normalize(vec3(-0.80f, 0.47f, 0.07f)),
                   .color = {1.60f, 1.38f, 1.08f},
                   .angle_deg = kSunAngleDeg,
                   .casts_shadow = true},
                  {.direction = glm::normalize(vec3(-0.80f, 0.45f, 0.40f)),
                   .color = {0.24f, 0.25f, 0.27f},
                   .angle_deg = kFillAngleDeg},
                  {.kind = LightKind::kPoint,
                   .position = kFloorLamp + vec3(0.5f, 1.55f, 0.65f),
                   .color = {0.13f, 0.095f, 0.05f},
                   .reach = 1.2f,
                   .radius = kGlow}};
  scene.ambient = {0.54f, 0.52f, 0.50f};
  scene.views = {{.eye = {3.15f, 1.62f, 2.45f}, .target = {-0.95f, 0.92f, -1.15f}, .angle_deg = 52.0f},
                 {.eye = {1.6f, 1.3f, 2.0f}, .target = {-2.4f, 0.7f, 0.3f}, .angle_deg = 50.0f}};
  return scene;
}

}  // namespace umbrage
