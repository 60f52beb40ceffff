// scene:tank - a siege tank on a round pad, with its two rear legs lowered: hard surfaces with rounded edges, deep gaps
// and many small parts that touch. It replaces figures 1 and 6 of the unsharp masking paper, which show such a tank
// from behind; the design is our own. The tank faces +z, x is to its left.
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

// Heights above the ground and half widths, metres.
constexpr float kGrouser = 0.085f;  // from the links' inner side, on which the wheels roll, to the ground
constexpr float kWheelRadius = 0.34f;
constexpr float kTrackCentre = 1.42f, kTrackHalfWidth = 0.31f;
constexpr float kTubHalfWidth = 1.02f;  // leaves 9 cm between tub and track
constexpr float kFender = 1.25f, kDeck = 1.72f, kTurretFloor = 1.80f, kRoof = 2.42f;
constexpr float kRear = -2.86f;  // the rear plate

/// Below these scales, small blocks and then all plates have sharp edges, and screws are left out, since they would be
/// most of the triangles of a coarse scene.
constexpr float kSharpBlocksBelow = 0.60f, kNoScrewsBelow = 0.50f, kSharpPlatesBelow = 0.40f;

struct Paint {
  int armour, plate, steel, track, rubber, dark, canvas, red, glass, brass, wood, pad, line;
};

struct Workshop {
  Scene scene;
  Detail detail;
  Paint paint;

  int add(const char* name, Mesh mesh, int material, int part_of = -1) {
    mesh.uvs.clear();  // nothing here has a texture, and rounded hulls have no texture coordinates
    return shapes::add_mesh(scene, name, std::move(mesh), material, part_of);
  }
  /// Adds the mesh and its mirror image as two objects.
  void add_pair(const char* name, const Mesh& mesh, int material) {
    add(name, mesh, material);
    add(name, shapes::scaled(mesh, {-1, 1, 1}), material);
  }
  /// Returns the number of steps around a plate's edge.
  int steps(float base) const { return detail.scale < kSharpPlatesBelow ? 0 : detail(base, 1); }
  Mesh block(vec3 low, vec3 high, float bevel = 0.012f) const {
    return rounded_hull({low,
                         {high.x, low.y, low.z},
                         {low.x, high.y, low.z},
                         {low.x, low.y, high.z},
                         {high.x, high.y, low.z},
                         {high.x, low.y, high.z},
                         {low.x, high.y, high.z},
                         high},
                        bevel, detail.scale < kSharpBlocksBelow ? 0 : detail(1.0f, 1));
  }
  Mesh hull(std::initializer_list<vec3> points, float bevel = 0.02f) const {
    return rounded_hull(points, bevel, steps(2.0f));
  }
  /// The floor or roof of a block.
  struct Face {
    float half_width, rear, front;  ///< metres along x and z
  };
  Mesh tapered(vec3 at, Face floor, float height, Face roof, float bevel = 0.02f) const {
    return hull({at + vec3(-floor.half_width, 0, floor.rear), at + vec3(floor.half_width, 0, floor.rear),
                 at + vec3(-floor.half_width, 0, floor.front), at + vec3(floor.half_width, 0, floor.front),
                 at + vec3(-roof.half_width, height, roof.rear), at + vec3(roof.half_width, height, roof.rear),
                 at + vec3(-roof.half_width, height, roof.front), at + vec3(roof.half_width, height, roof.front)},
                bevel);
  }
  /// Makes the hull of points and their mirror images.
  Mesh symmetric_hull(std::initializer_list<vec3> half, float bevel = 0.02f) const {
    std::vector<vec3> points(half);
    for (const vec3& p : half) points.push_back(p * vec3(-1, 1, 1));
    return rounded_hull(points, bevel, steps(2.0f));
  }
  /// Makes a round part between two points, with rounded edges.
  Mesh drum(vec3 from, vec3 to, float radius, float bevel = 0.012f, float slices = 20.0f) const {
    const float length = glm::distance(from, to);
    bevel = std::min({bevel, 0.5f * length, 0.9f * radius});
    const int steps = detail(2.0f, 1);
    const shapes::Points2 floor = {{0.0f, 0.0f}, {radius - bevel, 0.0f}},
                          roof = {{radius - bevel, length}, {0.0f, length}};
    return between(
        shapes::lathe(shapes::join({floor, shapes::arc({radius - bevel, bevel}, bevel, -90, 0, steps),
                                    shapes::arc({radius - bevel, length - bevel}, bevel, 0, 90, steps), roof}),
                      detail(slices, 8)),
        from, to);
  }
  /// Places a lathe profile with its axis from one point towards another.
  Mesh between(Mesh mesh, vec3 from, vec3 to) const {
    const vec3 y = glm::normalize(to - from);
    const vec3 x = glm::normalize(glm::cross(std::abs(y.z) < 0.9f ? vec3(0, 0, 1) : vec3(1, 0, 0), y));
    return shapes::transformed(
        std::move(mesh), mat4(glm::vec4(x, 0), glm::vec4(y, 0), glm::vec4(glm::cross(x, y), 0), glm::vec4(from, 1)));
  }
  Mesh pipe(std::initializer_list<vec3> through, float radius, float sides = 10.0f) const {
    const std::vector<vec3> points(through);
    return shapes::tube(shapes::smooth(points, detail(5.0f, 2)), radius, detail(sides, 5));
  }
  /// Makes a hexagonal screw head that projects from a face at `at`.
  Mesh bolt(vec3 at, vec3 out, float radius = 0.022f) const {
    if (detail.scale < kNoScrewsBelow) return {};
    const shapes::Points2 profile = {{radius, -0.01f},
                                     {radius, -0.01f},
                                     {radius, 0.4f * radius},
                                     {radius, 0.4f * radius},
                                     {0.72f * radius, 0.7f * radius},
                                     {0.72f * radius, 0.7f * radius},
                                     {0.0f, 0.7f * radius}};
    return between(shapes::lathe(profile, 6), at, at + out);
  }
  /// Appends a row of `count` bolts from a to b.
  void bolt_row(Mesh& mesh, vec3 a, vec3 b, int count, vec3 out, float radius = 0.022f) const {
    for (int i = 0; i < count; ++i)
      shapes::append(mesh, bolt(glm::mix(a, b, count > 1 ? float(i) / float(count - 1) : 0.5f), out, radius));
  }
};

Paint add_paint(Scene& scene) {
  const shapes::MaterialMaker make{scene};
  Paint p;
  p.armour = make.plain("armour", {0.37f, 0.36f, 0.25f}, 0.06f, 18.0f);
  p.plate = make.plain("plate", {0.225f, 0.24f, 0.165f}, 0.06f, 18.0f);
  p.steel = make.plain("steel", {0.34f, 0.34f, 0.35f}, 0.30f, 50.0f);
  p.track = make.plain("track", {0.19f, 0.18f, 0.17f}, 0.14f, 24.0f);
  p.rubber = make.plain("rubber", {0.075f, 0.075f, 0.08f}, 0.05f, 10.0f);
  p.dark = make.plain("dark steel", {0.12f, 0.12f, 0.13f}, 0.14f, 30.0f);
  p.canvas = make.plain("canvas", {0.46f, 0.38f, 0.24f}, 0.0f, 1.0f);
  p.red = make.plain("lamp red", {0.60f, 0.04f, 0.03f}, 0.40f, 60.0f);
  p.glass = make.plain("glass", {0.10f, 0.20f, 0.24f}, 0.60f, 90.0f);
  p.brass = make.plain("cable", {0.30f, 0.25f, 0.18f}, 0.15f, 30.0f);
  p.wood = make.plain("wood", {0.40f, 0.24f, 0.11f}, 0.05f, 16.0f);
  p.pad = make.plain("concrete", {0.50f, 0.49f, 0.47f}, 0.0f, 1.0f);
  p.line = make.plain("marking", {0.66f, 0.47f, 0.13f}, 0.0f, 1.0f);
  return p;
}

// ------------------------------------------------------------------------------------------------------ running gear

/// A wheel that the track runs around; `centre` is (z, y).
struct Roller {
  vec2 centre;
  float radius;
};

constexpr Roller kSprocket{{2.56f, 0.80f}, 0.355f}, kIdler{{-2.60f, 0.76f}, 0.335f};
constexpr int kRoadWheels = 6;
constexpr float kRoadFirst = -1.86f, kRoadPitch = 0.742f;

/// A point on the track's inner side, with the outward and forward directions, in (z, y).
struct BeltPoint {
  vec2 position, out, along;
};

/// Returns the track as a belt around its rollers, in `count` evenly spaced points.
std::vector<BeltPoint> belt(int count) {
  const float ground = kGrouser + kWheelRadius;
  const std::array<Roller, 4> rollers = {Roller{{kRoadFirst, ground}, kWheelRadius},
                                         Roller{{kRoadFirst + kRoadPitch * (kRoadWheels - 1), ground}, kWheelRadius},
                                         kSprocket, kIdler};
  struct Piece {
    Roller roller;
    float from_rad, to_rad;  // the arc
    vec2 start, end;         // the straight after it
  };
  std::vector<vec2> normals;
  for (std::size_t i = 0; i < rollers.size(); ++i) {
    const Roller &a = rollers[i], &b = rollers[(i + 1) % rollers.size()];
    const vec2 direction = b.centre - a.centre;
    const float length = glm::length(direction), along = (a.radius - b.radius) / length;
    const vec2 d = direction / length;
    normals.push_back(d * along + vec2(d.y, -d.x) * std::sqrt(1.0f - along * along));
  }
  std::vector<Piece> pieces;
  float total = 0.0f;
  for (std::size_t i = 0; i < rollers.size(); ++i) {
    const vec2 in = normals[(i + 3) % 4], out = normals[i];
    const float from = std::atan2(in.y, in.x);
    float to = std::atan2(out.y, out.x);
    if (to < from) to += 2.0f * kPi;
    const Roller &a = rollers[i], &b = rollers[(i + 1) % 4];
    pieces.push_back({a, from, to, a.centre + a.radius * out, b.centre + b.radius * out});
    total += a.radius * (to - from) + glm::distance(pieces.back().start, pieces.back().end);
  }
  std::vector<BeltPoint> points;
  for (int i = 0; i < count; ++i) {
    float s = total * float(i) / float(count);
    for (const Piece& piece : pieces) {
      const float arc = piece.roller.radius * (piece.to_rad - piece.from_rad);
      const float straight = glm::distance(piece.start, piece.end);
      if (s < arc) {
        const float a = piece.from_rad + s / piece.roller.radius;
        const vec2 out(std::cos(a), std::sin(a));
        points.push_back({piece.roller.centre + piece.roller.radius * out, out, {-out.y, out.x}});
        break;
      }
      s -= arc;
      if (s < straight) {
        const vec2 along = (piece.end - piece.start) / straight;
        points.push_back({piece.start + s * along, {along.y, -along.x}, along});
        break;
      }
      s -= straight;
    }
  }
  return points;
}

/// Makes one link, its inner side in y = 0, running along z.
Mesh track_link(const Workshop& w) {
  const float half = kTrackHalfWidth;
  Mesh link = w.block({-half, 0.004f, -0.066f}, {half, 0.048f, 0.066f}, 0.012f);
  shapes::append(link, w.block({-half + 0.02f, 0.03f, -0.024f}, {half - 0.02f, kGrouser, 0.024f}, 0.010f));
  for (const float side : {-1.0f, 1.0f}) {
    // The pins' ends, and the pads between them that close the gap to the next link.
    const float x = side * (half - 0.03f);
    shapes::append(link, w.block({x - 0.05f, 0.010f, 0.05f}, {x + 0.05f, 0.042f, 0.094f}, 0.008f));
  }
  shapes::append(link, w.block({-0.10f, 0.010f, 0.05f}, {0.10f, 0.042f, 0.094f}, 0.008f));
  shapes::append(link, w.hull({{-0.03f, 0.01f, -0.05f},
                               {0.03f, 0.01f, -0.05f},
                               {-0.03f, 0.01f, 0.05f},
                               {0.03f, 0.01f, 0.05f},
                               {-0.012f, -0.075f, -0.018f},
                               {0.012f, -0.075f, -0.018f},
                               {-0.012f, -0.075f, 0.018f},
                               {0.012f, -0.075f, 0.018f}},
                              0.006f));
  return link;
}

/// Adds a wheel of two discs around the x axis, with bolts and hub cap on its outside. `side`: 1 or -1, x of the
/// outside.
void add_wheel(Workshop& w, const char* name, vec3 centre, float radius, float side) {
  const vec3 out(side, 0, 0);
  const int slices = w.detail(26.0f, 10);
  for (const float offset : {-0.115f, 0.115f}) {
    const vec3 from = centre + out * (offset - 0.085f), to = centre + out * (offset + 0.085f);
    const shapes::Points2 tyre = {{radius - 0.07f, 0.012f},  {radius - 0.07f, 0.012f}, {radius - 0.015f, 0.0f},
                                  {radius - 0.004f, 0.012f}, {radius, 0.03f},          {radius, 0.14f},
                                  {radius - 0.004f, 0.158f}, {radius - 0.015f, 0.17f}, {radius - 0.07f, 0.158f},
                                  {radius - 0.07f, 0.158f},  {radius - 0.07f, 0.012f}};
    w.add("tyre", w.between(shapes::lathe(tyre, slices), from, to), w.paint.rubber);
    const float r = radius - 0.065f;
    const shapes::Points2 disc = {{0.0f, 0.03f},       {r, 0.03f},          {r, 0.03f},          {r, 0.148f},
                                  {r, 0.148f},         {r - 0.03f, 0.148f}, {r - 0.03f, 0.148f}, {r - 0.05f, 0.105f},
                                  {r - 0.05f, 0.105f}, {0.13f, 0.085f},     {0.11f, 0.10f},      {0.10f, 0.135f},
                                  {0.10f, 0.135f},     {0.0f, 0.135f}};
    Mesh wheel = w.between(shapes::lathe(disc, slices), from, to);
    if (offset > 0.0f) {
      const vec3 face = from + out * 0.088f;
      for (int i = 0; i < 8; ++i) {
        const float a = 2.0f * kPi * (float(i) + 0.5f) / 8.0f;
        shapes::append(
            wheel, w.bolt(face + 0.165f * vec3(0, std::cos(a), std::sin(a)) * (radius / kWheelRadius), out, 0.020f));
      }
      shapes::append(wheel, w.drum(from + out * 0.12f, from + out * 0.185f, 0.062f, 0.02f, 14.0f));
      for (int i = 0; i < 5; ++i) {
        const float a = 2.0f * kPi * float(i) / 5.0f;
        shapes::append(wheel, w.bolt(from + out * 0.135f + 0.08f * vec3(0, std::cos(a), std::sin(a)), out, 0.012f));
      }
    }
    w.add(name, std::move(wheel), w.paint.armour);
  }
}

/// Adds the toothed wheel that drives the track.
void add_sprocket(Workshop& w, float side) {
  const vec3 centre(side * kTrackCentre, kSprocket.centre.y, kSprocket.centre.x), out(side, 0, 0);
  constexpr int kTeeth = 15;
  shapes::Points2 gear;
  const float root = kSprocket.radius - 0.05f, tip = kSprocket.radius + 0.025f, step = 2.0f * kPi / float(kTeeth);
  for (int i = 0; i < kTeeth; ++i) {
    const float at[4] = {-0.30f, -0.13f, 0.13f, 0.30f};
    for (int k = 0; k < 4; ++k) {
      const float a = step * (float(i) + at[k]), r = k == 1 || k == 2 ? tip : root;
      gear.push_back({r * std::cos(a), r * std::sin(a)});
    }
  }
  for (const float offset : {-0.21f, 0.15f}) {
    const vec3 from = centre + out * offset;
    // An extrusion runs along z; rotated to y, it is placed like the lathed parts.
    w.add("sprocket",
          w.between(shapes::turned_x(shapes::extrusion(shapes::sharp(gear), 0.06f), -90.0f), from, from + out),
          w.paint.steel);
  }
  const float r = kSprocket.radius - 0.055f;
  const shapes::Points2 hub = {{0.0f, 0.0f},       {r, 0.0f},         {r, 0.0f},         {r, 0.5f},
                               {r, 0.5f},          {r - 0.03f, 0.5f}, {r - 0.03f, 0.5f}, {r - 0.05f, 0.46f},
                               {r - 0.05f, 0.46f}, {0.17f, 0.44f},    {0.17f, 0.44f},    {0.15f, 0.53f},
                               {0.13f, 0.545f},    {0.13f, 0.545f},   {0.0f, 0.545f}};
  const vec3 from = centre - out * 0.25f;
  Mesh mesh = w.between(shapes::lathe(hub, w.detail(28.0f, 10)), from, from + out);
  for (int i = 0; i < 10; ++i) {
    const float a = 2.0f * kPi * float(i) / 10.0f;
    shapes::append(mesh, w.bolt(from + out * 0.45f + 0.205f * vec3(0, std::cos(a), std::sin(a)), out, 0.020f));
  }
  w.add("sprocket hub", std::move(mesh), w.paint.armour);
}

void add_running_gear(Workshop& w) {
  const Mesh link = track_link(w);
  // One link is 16 cm long with its gap; the belt is about 12.3 m.
  const std::vector<BeltPoint> points = belt(77);
  for (const float side : {1.0f, -1.0f}) {
    Mesh track;
    for (const BeltPoint& p : points) {
      const vec3 y(0, p.out.y, p.out.x), z(0, p.along.y, p.along.x);
      shapes::append(track,
                     shapes::transformed(link, mat4(glm::vec4(glm::cross(y, z), 0), glm::vec4(y, 0), glm::vec4(z, 0),
                                                    glm::vec4(side * kTrackCentre, p.position.y, p.position.x, 1))));
    }
    w.add(side > 0 ? "left track" : "right track", std::move(track), w.paint.track);

    const vec3 out(side, 0, 0);
    for (int i = 0; i < kRoadWheels; ++i) {
      const vec3 centre(side * kTrackCentre, kGrouser + kWheelRadius, kRoadFirst + kRoadPitch * float(i));
      add_wheel(w, "road wheel", centre, kWheelRadius, side);
      // The wheel's swing arm, from the tub forwards.
      Mesh arm = w.drum(centre - out * 0.16f, centre - out * 0.44f, 0.075f);
      shapes::append(arm,
                     w.hull({centre + vec3(-side * 0.27f, 0.07f, 0.05f), centre + vec3(-side * 0.27f, -0.07f, 0.0f),
                             centre + vec3(-side * 0.35f, 0.07f, 0.05f), centre + vec3(-side * 0.35f, -0.07f, 0.0f),
                             centre + vec3(-side * 0.27f, 0.28f, 0.30f), centre + vec3(-side * 0.27f, 0.16f, 0.36f),
                             centre + vec3(-side * 0.35f, 0.28f, 0.30f), centre + vec3(-side * 0.35f, 0.16f, 0.36f)}));
      shapes::append(
          arm, w.drum(centre + vec3(-side * 0.25f, 0.22f, 0.33f), centre + vec3(-side * 0.45f, 0.22f, 0.33f), 0.10f));
      w.add("swing arm", std::move(arm), w.paint.plate);
    }
    add_wheel(w, "idler", {side * kTrackCentre, kIdler.centre.y, kIdler.centre.x}, kIdler.radius, side);
    w.add("idler axle",
          w.drum({side * (kTubHalfWidth - 0.1f), kIdler.centre.y, kIdler.centre.x},
                 {side * (kTrackCentre - 0.1f), kIdler.centre.y, kIdler.centre.x}, 0.11f),
          w.paint.plate);
    add_sprocket(w, side);
    Mesh gearbox = w.drum({side * (kTubHalfWidth - 0.1f), kSprocket.centre.y, kSprocket.centre.x},
                          {side * (kTrackCentre - 0.24f), kSprocket.centre.y, kSprocket.centre.x}, 0.26f, 0.03f);
    w.add("final drive", std::move(gearbox), w.paint.plate);
    for (const float z : {-1.35f, 0.0f, 1.35f}) {
      // Return rollers support the upper run of the track.
      const float t = (z - kIdler.centre.x) / (kSprocket.centre.x - kIdler.centre.x);
      const float top = glm::mix(kIdler.centre.y + kIdler.radius, kSprocket.centre.y + kSprocket.radius, t);
      const vec3 centre(side * kTrackCentre, top - 0.10f, z);
      Mesh roller = w.drum(centre - out * 0.20f, centre - out * 0.06f, 0.10f);
      shapes::append(roller, w.drum(centre + out * 0.06f, centre + out * 0.20f, 0.10f));
      shapes::append(roller, w.drum(centre - out * 0.48f, centre + out * 0.21f, 0.045f));
      w.add("return roller", std::move(roller), w.paint.rubber);
    }
  }
}

// -------------------------------------------------------------------------------------------------------------- hull

/// Adds fenders with bent ends; the rear flaps do not hide the tracks from behind.
void add_fenders(Workshop& w) {
  const float t = kTubHalfWidth;
  Mesh fender = w.hull({{t, kFender - 0.02f, -2.75f},
                        {1.80f, kFender - 0.02f, -2.75f},
                        {t, kFender + 0.03f, -2.75f},
                        {1.80f, kFender + 0.03f, -2.75f},
                        {t, kFender - 0.02f, 2.70f},
                        {1.80f, kFender - 0.02f, 2.70f},
                        {t, kFender + 0.03f, 2.70f},
                        {1.80f, kFender + 0.03f, 2.70f}},
                       0.012f);
  for (const float end : {-1.0f, 1.0f}) {
    const float z = end > 0 ? 2.68f : -2.73f, reach = end > 0 ? 0.46f : 0.36f, drop = end > 0 ? 0.20f : 0.13f;
    shapes::append(fender, w.hull({{t, kFender - 0.02f, z},
                                   {1.80f, kFender - 0.02f, z},
                                   {t, kFender + 0.03f, z},
                                   {1.80f, kFender + 0.03f, z},
                                   {t, kFender - drop - 0.02f, z + end * reach},
                                   {1.80f, kFender - drop - 0.02f, z + end * reach},
                                   {t, kFender - drop + 0.03f, z + end * reach},
                                   {1.80f, kFender - drop + 0.03f, z + end * reach}},
                                  0.012f));
    // The flap's rib.
    shapes::append(fender, w.hull({{1.38f, kFender + 0.01f, z},
                                   {1.46f, kFender + 0.01f, z},
                                   {1.38f, kFender + 0.055f, z},
                                   {1.46f, kFender + 0.055f, z},
                                   {1.38f, kFender - drop + 0.01f, z + end * (reach - 0.03f)},
                                   {1.46f, kFender - drop + 0.01f, z + end * (reach - 0.03f)},
                                   {1.38f, kFender - drop + 0.05f, z + end * (reach - 0.03f)},
                                   {1.46f, kFender - drop + 0.05f, z + end * (reach - 0.03f)}},
                                  0.010f));
  }
  w.add_pair("fender", fender, w.paint.plate);
}

/// Adds side armour of bolted plates.
void add_side_armour(Workshop& w) {
  for (int i = 0; i < 5; ++i) {
    const float z = -2.10f + 0.86f * float(i);
    Mesh plate = w.hull({{1.795f, 0.92f, z + 0.05f},
                         {1.84f, 0.92f, z + 0.05f},
                         {1.795f, 0.92f, z + 0.78f},
                         {1.84f, 0.92f, z + 0.78f},
                         {1.795f, 1.00f, z},
                         {1.84f, 1.00f, z},
                         {1.795f, 1.00f, z + 0.83f},
                         {1.84f, 1.00f, z + 0.83f},
                         {1.795f, 1.34f, z},
                         {1.84f, 1.34f, z},
                         {1.795f, 1.34f, z + 0.83f},
                         {1.84f, 1.34f, z + 0.83f}},
                        0.014f);
    for (const float y : {1.05f, 1.28f})
      for (const float u : {0.10f, 0.73f}) shapes::append(plate, w.bolt({1.84f, y, z + u}, {1, 0, 0}, 0.024f));
    w.add_pair("side plate", plate, i % 2 == 0 ? w.paint.armour : w.paint.plate);
  }
}

/// Adds spare track links on the bow.
void add_spare_links(Workshop& w) {
  for (int i = 0; i < 4; ++i) {
    const vec3 along = glm::normalize(vec3(0, 0.45f, -1.44f)), out = glm::normalize(vec3(0, 1.44f, 0.45f));
    const vec3 at = vec3(-0.02f, 1.27f, 2.74f) + along * (0.32f + 0.17f * float(i)) + out * 0.012f;
    Mesh spare = shapes::scaled(track_link(w), {0.95f, 1.0f, 1.0f});
    w.add("spare link",
          shapes::transformed(spare, mat4(glm::vec4(glm::cross(out, along), 0), glm::vec4(out, 0), glm::vec4(along, 0),
                                          glm::vec4(at, 1))),
          w.paint.track);
  }
}

/// Adds the driver's hatch with two periscopes.
void add_drivers_hatch(Workshop& w) {
  const vec3 driver(0.62f, kDeck - 0.02f, 1.02f);
  Mesh hatch = w.drum(driver, driver + vec3(0, 0.05f, 0), 0.27f, 0.02f, 28.0f);
  shapes::append(hatch, w.drum(driver + vec3(0, 0.03f, 0), driver + vec3(0, 0.085f, 0), 0.22f, 0.025f, 28.0f));
  shapes::append(hatch, w.block(driver + vec3(-0.05f, 0.03f, -0.33f), driver + vec3(0.05f, 0.09f, -0.18f)));
  w.add("driver's hatch", std::move(hatch), w.paint.armour);
  for (const float side : {-1.0f, 1.0f}) {
    const vec3 at = driver + vec3(side * 0.13f, 0.02f, 0.27f);
    w.add("periscope", w.tapered(at, {0.08f, -0.05f, 0.06f}, 0.09f, {0.07f, -0.05f, 0.02f}, 0.010f), w.paint.dark);
  }
}

/// Adds headlamps on stalks, with guards, and towing eyes at the bow.
void add_headlamps(Workshop& w) {
  for (const float side : {-1.0f, 1.0f}) {
    const vec3 at(side * 1.42f, 1.43f, 2.45f);
    Mesh lamp = w.drum(at - vec3(0, 0, 0.10f), at + vec3(0, 0, 0.05f), 0.10f, 0.03f, 22.0f);
    shapes::append(lamp, w.drum(at - vec3(0, 0.20f, 0.02f), at - vec3(0, 0.05f, 0.02f), 0.035f));
    w.add("headlamp", std::move(lamp), w.paint.armour);
    w.add("headlamp glass", w.drum(at + vec3(0, 0, 0.04f), at + vec3(0, 0, 0.065f), 0.082f, 0.02f, 22.0f),
          w.paint.glass);
    const float x = at.x;
    w.add("lamp guard",
          w.pipe({{x - 0.17f, 1.26f, 2.40f},
                  {x - 0.17f, 1.50f, 2.50f},
                  {x - 0.10f, 1.60f, 2.54f},
                  {x + 0.10f, 1.60f, 2.54f},
                  {x + 0.17f, 1.50f, 2.50f},
                  {x + 0.17f, 1.26f, 2.40f}},
                 0.018f),
          w.paint.dark);
    // Towing eyes at the bow.
    const vec3 eye(side * 0.72f, 0.86f, 2.88f);
    Mesh hook = w.block(eye + vec3(-0.07f, -0.09f, -0.10f), eye + vec3(0.07f, 0.09f, 0.06f), 0.02f);
    shapes::append(hook, shapes::moved(shapes::turned_z(
                                           shapes::torus(0.085f, 0.030f, w.detail(18.0f, 8), w.detail(8.0f, 5)), 90.0f),
                                       eye + vec3(0, -0.01f, 0.11f)));
    w.add("towing eye", std::move(hook), w.paint.steel);
  }
}

void add_hull(Workshop& w) {
  const float t = kTubHalfWidth;
  w.add("tub",
        w.symmetric_hull({{t, 0.44f, -2.45f},
                          {t, 0.66f, kRear},
                          {t, 1.27f, kRear - 0.02f},
                          {t, 0.44f, 2.15f},
                          {t, 0.98f, 3.00f},
                          {t, 1.27f, 2.70f}},
                         0.03f),
        w.paint.plate);
  const int deck = w.add("hull",
                         w.symmetric_hull({{1.78f, kFender + 0.02f, -2.92f},
                                           {1.78f, 1.40f, -2.92f},
                                           {1.42f, kDeck, -2.78f},
                                           {1.78f, kFender + 0.02f, 2.05f},
                                           {1.78f, 1.36f, 1.95f},
                                           {1.42f, kDeck, 1.25f},
                                           {1.02f, kFender + 0.02f, 2.74f},
                                           {1.02f, 1.02f, 3.02f},
                                           {0.95f, kDeck, 1.30f}},
                                          0.03f),
                         w.paint.armour);
  add_fenders(w);
  add_side_armour(w);
  add_spare_links(w);
  add_drivers_hatch(w);
  add_headlamps(w);
  Mesh bolts;
  for (const float side : {-1.0f, 1.0f}) {
    const vec3 out = glm::normalize(vec3(side * 0.32f, 0.36f, 0.0f));
    w.bolt_row(bolts, {side * 1.70f, 1.475f, -2.6f}, {side * 1.70f, 1.475f, 1.2f}, 13, out, 0.020f);
  }
  w.bolt_row(bolts, {-0.85f, 1.10f, 3.0f}, {0.85f, 1.10f, 3.0f}, 9, glm::normalize(vec3(0, 0.35f, 1.0f)), 0.022f);
  w.add("hull bolts", std::move(bolts), w.paint.plate, deck);
}

/// z of the rear plate, on which parts are mounted.
constexpr float kRearPlate = kRear - 0.02f;

/// Adds two gratings on the deck: a frame, and slanted slats.
void add_gratings(Workshop& w) {
  for (const float x : {-0.72f, 0.72f}) {
    const float y = kDeck - 0.01f;
    Mesh frame = w.block({x - 0.56f, y, -2.68f}, {x + 0.56f, y + 0.07f, -2.60f});
    shapes::append(frame, w.block({x - 0.56f, y, -1.78f}, {x + 0.56f, y + 0.07f, -1.70f}));
    shapes::append(frame, w.block({x - 0.56f, y, -2.64f}, {x - 0.48f, y + 0.07f, -1.74f}));
    shapes::append(frame, w.block({x + 0.48f, y, -2.64f}, {x + 0.56f, y + 0.07f, -1.74f}));
    shapes::append(frame, w.block({x - 0.02f, y, -2.64f}, {x + 0.02f, y + 0.06f, -1.74f}));
    w.add("deck grating", std::move(frame), w.paint.plate);
    Mesh slats;
    for (int i = 0; i < 11; ++i) {
      const float z = -2.56f + 0.074f * float(i);
      shapes::append(
          slats,
          shapes::moved(shapes::turned_x(w.block({-0.50f, -0.008f, -0.04f}, {0.50f, 0.008f, 0.04f}, 0.005f), -35.0f),
                        {x, y + 0.028f, z}));
    }
    w.add("deck slats", std::move(slats), w.paint.dark);
  }
}

/// Adds a silencer across the plate under the deck's edge; its pipe turns out and up.
void add_silencer(Workshop& w, float side) {
  const float z = kRearPlate;
  const vec3 inner(side * 0.46f, 1.40f, z - 0.19f), outer(side * 1.22f, 1.40f, z - 0.19f);
  Mesh can = w.drum(inner, outer, 0.135f, 0.04f, 26.0f);
  for (const float u : {0.14f, 0.86f})
    shapes::append(can,
                   w.drum(glm::mix(inner, outer, u - 0.03f), glm::mix(inner, outer, u + 0.03f), 0.148f, 0.010f, 26.0f));
  w.add("silencer", std::move(can), w.paint.dark);
  const float x = side * 1.22f;
  const shapes::Points2 mouth = {{0.062f, 0.0f},  {0.062f, 0.22f}, {0.066f, 0.24f}, {0.062f, 0.255f}, {0.052f, 0.255f},
                                 {0.048f, 0.24f}, {0.048f, 0.03f}, {0.048f, 0.03f}, {0.0f, 0.03f}};
  Mesh pipe = w.pipe({{x - side * 0.05f, 1.40f, z - 0.19f},
                      {x + side * 0.09f, 1.41f, z - 0.20f},
                      {x + side * 0.15f, 1.47f, z - 0.24f},
                      {x + side * 0.16f, 1.56f, z - 0.28f}},
                     0.058f, 14.0f);
  shapes::append(pipe, w.between(shapes::lathe(mouth, w.detail(20.0f, 8)), {x + side * 0.16f, 1.53f, z - 0.27f},
                                 {x + side * 0.19f, 1.80f, z - 0.42f}));
  w.add("exhaust", std::move(pipe), w.paint.steel);
  for (const float u : {0.62f, 1.06f})
    w.add("silencer bracket", w.block({side * u - 0.03f, 1.30f, z - 0.20f}, {side * u + 0.03f, 1.36f, z + 0.06f}),
          w.paint.plate);
}

/// Adds tail lamps and towing hooks.
void add_tail(Workshop& w, float side) {
  const vec3 lamp(side * 1.52f, 1.36f, -2.92f);
  w.add("tail lamp box", w.block(lamp + vec3(-0.12f, -0.06f, -0.05f), lamp + vec3(0.12f, 0.06f, 0.02f), 0.015f),
        w.paint.dark);
  w.add("tail lamp",
        w.drum(lamp + vec3(-side * 0.055f, 0, -0.04f), lamp + vec3(-side * 0.055f, 0, -0.07f), 0.042f, 0.012f, 18.0f),
        w.paint.red);
  w.add("tail lamp",
        w.drum(lamp + vec3(side * 0.055f, 0, -0.04f), lamp + vec3(side * 0.055f, 0, -0.07f), 0.042f, 0.012f, 18.0f),
        w.paint.glass);
  const vec3 eye(side * 0.33f, 0.60f, -2.72f);
  Mesh hook = w.block(eye + vec3(-0.065f, -0.08f, -0.12f), eye + vec3(0.065f, 0.09f, 0.14f), 0.02f);
  shapes::append(
      hook, shapes::moved(shapes::turned_z(shapes::torus(0.085f, 0.028f, w.detail(18.0f, 8), w.detail(8.0f, 5)), 90.0f),
                          eye + vec3(0, -0.02f, -0.16f)));
  w.add("towing eye", std::move(hook), w.paint.steel);
}

/// Adds a leg: bracket, arm, foot and the ram that pushes it down.
void add_leg(Workshop& w, float side) {
  const float z = kRearPlate;
  const float leg = side * 0.70f;
  const vec3 hip(leg, 0.86f, z - 0.10f), ankle(leg * 1.10f, 0.20f, -3.86f);
  Mesh bracket;
  for (const float u : {-0.15f, 0.15f})
    shapes::append(bracket, w.hull({{leg + u - 0.025f, 0.70f, z + 0.05f},
                                    {leg + u + 0.025f, 0.70f, z + 0.05f},
                                    {leg + u - 0.025f, 1.26f, z + 0.05f},
                                    {leg + u + 0.025f, 1.26f, z + 0.05f},
                                    {leg + u - 0.025f, 0.77f, z - 0.20f},
                                    {leg + u + 0.025f, 0.77f, z - 0.20f},
                                    {leg + u - 0.025f, 0.93f, z - 0.22f},
                                    {leg + u + 0.025f, 0.93f, z - 0.22f}},
                                   0.012f));
  shapes::append(bracket, w.drum(hip - vec3(0.21f, 0, 0), hip + vec3(0.21f, 0, 0), 0.055f));
  w.add("leg bracket", std::move(bracket), w.paint.plate);
  const vec3 direction = glm::normalize(ankle - hip), up = glm::normalize(glm::cross(vec3(1, 0, 0), direction));
  const auto place = [&](vec3 base, float x, float y) { return base + vec3(x, 0, 0) + up * y; };
  Mesh arm = w.hull({place(hip, -0.11f, -0.10f), place(hip, 0.11f, -0.10f), place(hip, -0.11f, 0.11f),
                     place(hip, 0.11f, 0.11f), place(ankle, -0.08f, -0.07f), place(ankle, 0.08f, -0.07f),
                     place(ankle, -0.08f, 0.07f), place(ankle, 0.08f, 0.07f)},
                    0.025f);
  for (const float u : {-1.0f, 1.0f})
    shapes::append(arm, w.hull({place(glm::mix(hip, ankle, 0.18f), u * 0.107f - 0.012f, -0.045f),
                                place(glm::mix(hip, ankle, 0.18f), u * 0.107f + 0.012f, -0.045f),
                                place(glm::mix(hip, ankle, 0.18f), u * 0.107f - 0.012f, 0.05f),
                                place(glm::mix(hip, ankle, 0.18f), u * 0.107f + 0.012f, 0.05f),
                                place(glm::mix(hip, ankle, 0.82f), u * 0.087f - 0.012f, -0.035f),
                                place(glm::mix(hip, ankle, 0.82f), u * 0.087f + 0.012f, -0.035f),
                                place(glm::mix(hip, ankle, 0.82f), u * 0.087f - 0.012f, 0.04f),
                                place(glm::mix(hip, ankle, 0.82f), u * 0.087f + 0.012f, 0.04f)},
                               0.010f));
  shapes::append(arm, w.drum(ankle - vec3(0.12f, 0, 0), ankle + vec3(0.12f, 0, 0), 0.085f));
  w.add(side > 0 ? "left leg" : "right leg", std::move(arm), w.paint.armour);
  const shapes::Points2 foot = {{0.0f, 0.0f},    {0.33f, 0.0f},   {0.33f, 0.0f},   {0.345f, 0.015f}, {0.345f, 0.05f},
                                {0.33f, 0.07f},  {0.33f, 0.07f},  {0.15f, 0.105f}, {0.13f, 0.13f},   {0.12f, 0.20f},
                                {0.10f, 0.215f}, {0.10f, 0.215f}, {0.0f, 0.215f}};
  Mesh pad = shapes::moved(shapes::lathe(foot, w.detail(30.0f, 12)), {ankle.x, 0.0f, ankle.z});
  for (int i = 0; i < 8; ++i) {
    const float a = 2.0f * kPi * float(i) / 8.0f;
    shapes::append(pad,
                   w.bolt({ankle.x + 0.25f * std::cos(a), 0.083f, ankle.z + 0.25f * std::sin(a)}, {0, 1, 0}, 0.022f));
  }
  w.add("foot", std::move(pad), w.paint.steel);
  const vec3 top(leg, 1.16f, z - 0.07f), bottom = glm::mix(hip, ankle, 0.66f) + up * 0.16f;
  Mesh lugs = w.block(bottom + vec3(-0.085f, -0.12f, -0.05f), bottom + vec3(-0.045f, 0.05f, 0.05f), 0.015f);
  shapes::append(lugs, w.block(bottom + vec3(0.045f, -0.12f, -0.05f), bottom + vec3(0.085f, 0.05f, 0.05f), 0.015f));
  shapes::append(lugs, w.drum(bottom - vec3(0.10f, 0, 0), bottom + vec3(0.10f, 0, 0), 0.032f));
  shapes::append(lugs, w.drum(top - vec3(0.19f, 0, 0), top + vec3(0.19f, 0, 0), 0.035f));
  w.add("ram pins", std::move(lugs), w.paint.dark);
  w.add("ram cylinder",
        w.drum(top + 0.05f * glm::normalize(top - bottom), glm::mix(top, bottom, 0.58f), 0.068f, 0.015f),
        w.paint.armour);
  w.add("ram rod", w.drum(glm::mix(top, bottom, 0.5f), bottom, 0.038f, 0.010f), w.paint.steel);
  w.add("hose",
        w.pipe({{leg + 0.06f, 1.10f, z + 0.02f},
                {leg + 0.10f, 1.12f, z - 0.12f},
                glm::mix(top, bottom, 0.3f) + vec3(0.12f, 0.06f, 0.0f),
                glm::mix(top, bottom, 0.5f) + vec3(0.065f, 0.0f, 0.0f)},
               0.016f),
        w.paint.rubber);
}

/// Adds the deck over the engine, and the parts on the rear plate.
void add_rear(Workshop& w) {
  add_gratings(w);
  // The rear plate: a grille in the middle, between two silencers.
  const float z = kRearPlate;
  Mesh frame = w.block({-0.36f, 0.78f, z - 0.10f}, {-0.30f, 1.24f, z + 0.05f});
  shapes::append(frame, w.block({0.30f, 0.78f, z - 0.10f}, {0.36f, 1.24f, z + 0.05f}));
  shapes::append(frame, w.block({-0.36f, 0.74f, z - 0.10f}, {0.36f, 0.80f, z + 0.05f}));
  shapes::append(frame, w.block({-0.36f, 1.20f, z - 0.10f}, {0.36f, 1.26f, z + 0.05f}));
  w.add("rear grille", std::move(frame), w.paint.armour);
  Mesh bars;
  for (int i = 0; i < 8; ++i) {
    const float y = 0.83f + 0.052f * float(i);
    shapes::append(bars, shapes::moved(shapes::turned_x(
                                           w.block({-0.31f, -0.007f, -0.04f}, {0.31f, 0.007f, 0.04f}, 0.004f), -40.0f),
                                       {0.0f, y, z - 0.04f}));
  }
  w.add("rear bars", std::move(bars), w.paint.dark);

  for (const float side : {-1.0f, 1.0f}) {
    add_silencer(w, side);
    add_tail(w, side);
    add_leg(w, side);
  }
  Mesh bolts;
  w.bolt_row(bolts, {-0.92f, 0.71f, z}, {-0.92f, 1.18f, z}, 4, {0, 0, -1});
  w.bolt_row(bolts, {0.92f, 0.71f, z}, {0.92f, 1.18f, z}, 4, {0, 0, -1});
  w.bolt_row(bolts, {-0.48f, 0.78f, z}, {-0.48f, 1.22f, z}, 4, {0, 0, -1}, 0.016f);
  w.bolt_row(bolts, {0.48f, 0.78f, z}, {0.48f, 1.22f, z}, 4, {0, 0, -1}, 0.016f);
  w.add("rear bolts", std::move(bolts), w.paint.steel);
}

/// Adds stowage on the fenders.
void add_stowage(Workshop& w) {
  for (const float side : {-1.0f, 1.0f}) {
    // Boxes on the sloped flank are on small shelves.
    for (const float z : {-1.95f, -0.95f}) {
      const float x0 = side > 0 ? 1.44f : -1.82f, x1 = side > 0 ? 1.82f : -1.44f;
      Mesh box = w.block({x0, 1.36f, z}, {x1, 1.72f, z + 0.82f}, 0.025f);
      w.add("stowage box", std::move(box), w.paint.plate);
      Mesh lid = w.block({x0 - 0.012f, 1.70f, z - 0.012f}, {x1 + 0.012f, 1.76f, z + 0.832f}, 0.018f);
      w.add("stowage lid", std::move(lid), w.paint.armour);
      Mesh latch;
      for (const float u : {0.18f, 0.64f}) {
        const float x = side * 1.82f;
        shapes::append(latch,
                       w.block({x - 0.015f, 1.60f, z + u - 0.025f}, {x + 0.022f, 1.74f, z + u + 0.025f}, 0.008f));
      }
      w.add("latch", std::move(latch), w.paint.steel);
    }
  }
  // Left: a tow cable along the flank with its eyes; right: spade and crowbar.
  const vec3 out = glm::normalize(vec3(0.32f, 0.36f, 0.0f));
  const auto flank = [&](float side, float up, float z, float lift) {
    return vec3(side * (1.78f - 0.36f * up), 1.40f + 0.32f * up, z) + lift * vec3(side * out.x, out.y, 0.0f);
  };
  Mesh cable = w.pipe({flank(1, 0.62f, 0.05f, 0.03f), flank(1, 0.40f, 0.35f, 0.03f), flank(1, 0.46f, 0.75f, 0.03f),
                       flank(1, 0.62f, 1.05f, 0.03f), flank(1, 0.80f, 1.22f, 0.03f)},
                      0.026f);
  shapes::append(cable, shapes::moved(shapes::turned_z(
                                          shapes::torus(0.055f, 0.022f, w.detail(16.0f, 8), w.detail(7.0f, 5)), -48.0f),
                                      flank(1, 0.62f, -0.02f, 0.03f)));
  w.add("tow cable", std::move(cable), w.paint.brass);
  w.add("spade shaft", w.drum(flank(-1, 0.42f, 0.10f, 0.025f), flank(-1, 0.42f, 0.95f, 0.025f), 0.024f, 0.010f, 10.0f),
        w.paint.wood);
  const vec3 tip = flank(-1, 0.42f, 0.95f, 0.03f), across = glm::normalize(vec3(0.36f, 0.32f, 0.0f)),
             lift(-out.x * 0.010f, out.y * 0.010f, 0.0f);
  w.add("spade",
        w.hull({tip - across * 0.09f - lift, tip + across * 0.09f - lift, tip - across * 0.09f + lift,
                tip + across * 0.09f + lift, tip - across * 0.09f + vec3(0, 0, 0.20f) - lift,
                tip + across * 0.09f + vec3(0, 0, 0.20f) - lift, tip - across * 0.09f + vec3(0, 0, 0.20f) + lift,
                tip + across * 0.09f + vec3(0, 0, 0.20f) + lift, tip + vec3(0, 0, 0.28f) - lift,
                tip + vec3(0, 0, 0.28f) + lift},
               0.006f),
        w.paint.steel);
  w.add("crowbar", w.drum(flank(-1, 0.78f, 0.05f, 0.022f), flank(-1, 0.78f, 1.15f, 0.022f), 0.018f, 0.008f, 8.0f),
        w.paint.dark);
  Mesh clips;
  for (const float z : {0.25f, 0.80f})
    for (const float up : {0.42f, 0.78f}) {
      const vec3 at = flank(-1, up, z, 0.02f);
      shapes::append(clips, w.hull({at - across * 0.045f - 3.0f * lift, at + across * 0.045f - 3.0f * lift,
                                    at - across * 0.03f + 3.2f * lift, at + across * 0.03f + 3.2f * lift,
                                    at - across * 0.045f - 3.0f * lift + vec3(0, 0, 0.04f),
                                    at + across * 0.045f - 3.0f * lift + vec3(0, 0, 0.04f),
                                    at - across * 0.03f + 3.2f * lift + vec3(0, 0, 0.04f),
                                    at + across * 0.03f + 3.2f * lift + vec3(0, 0, 0.04f)},
                                   0.006f));
    }
  w.add("clips", std::move(clips), w.paint.plate);
}

// ------------------------------------------------------------------------------------------------------------ turret

/// Raises a part of the gun: the parts are built along +z from the trunnion.
Mesh raised(Mesh mesh) { return shapes::moved(shapes::turned_x(std::move(mesh), -5.0f), {0.0f, 2.10f, 1.0f}); }

/// Makes a round part of the gun: radii at distances from the trunnion.
Mesh raised_lathe(const Workshop& w, const shapes::Points2& profile) {
  return raised(w.between(shapes::lathe(profile, w.detail(30.0f, 10)), vec3(0.0f), {0, 0, 1}));
}

void add_mantlet(Workshop& w) {
  w.add("mantlet",
        raised(w.symmetric_hull({{0.46f, -0.24f, -0.15f},
                                 {0.46f, 0.24f, -0.15f},
                                 {0.46f, -0.16f, 0.30f},
                                 {0.46f, 0.16f, 0.30f},
                                 {0.30f, -0.20f, 0.46f},
                                 {0.30f, 0.20f, 0.46f}},
                                0.05f)),
        w.paint.plate);
  const shapes::Points2 rim = {{0.0f, 0.40f},  {0.23f, 0.40f}, {0.23f, 0.40f}, {0.235f, 0.42f}, {0.235f, 0.56f},
                               {0.22f, 0.58f}, {0.22f, 0.58f}, {0.17f, 0.60f}, {0.0f, 0.60f}};
  Mesh collar = raised_lathe(w, rim);
  for (int i = 0; i < 10; ++i) {
    const float a = 2.0f * kPi * float(i) / 10.0f;
    shapes::append(collar, raised(w.bolt({0.195f * std::cos(a), 0.195f * std::sin(a), 0.588f}, {0, 0, 1}, 0.017f)));
  }
  w.add("collar", std::move(collar), w.paint.armour);
}

void add_barrel(Workshop& w) {
  const shapes::Points2 barrel = {{0.145f, 0.5f}, {0.14f, 1.45f},  {0.14f, 1.45f}, {0.15f, 1.47f},
                                  {0.15f, 1.53f}, {0.14f, 1.55f},  {0.14f, 1.55f}, {0.12f, 1.60f},
                                  {0.12f, 1.60f}, {0.105f, 3.55f}, {0.105f, 3.55f}};
  w.add("barrel", raised_lathe(w, barrel), w.paint.armour);
  // The fume extractor, a swelling at two thirds of the barrel.
  const shapes::Points2 extractor = {{0.11f, 2.06f},  {0.15f, 2.11f},  {0.165f, 2.15f}, {0.165f, 2.15f},
                                     {0.165f, 2.62f}, {0.165f, 2.62f}, {0.15f, 2.66f},  {0.11f, 2.72f}};
  w.add("fume extractor", raised_lathe(w, extractor), w.paint.plate);
}

void add_muzzle(Workshop& w) {
  // The brake: three discs on a bored core, two chambers open to the sides.
  Mesh brake;
  const auto disc = [&](float z0, float z1, float radius) {
    shapes::append(brake, raised_lathe(w, {{0.060f, z0},
                                           {radius - 0.02f, z0},
                                           {radius - 0.02f, z0},
                                           {radius, z0 + 0.02f},
                                           {radius, z1 - 0.02f},
                                           {radius - 0.02f, z1},
                                           {radius - 0.02f, z1},
                                           {0.060f, z1},
                                           {0.060f, z1},
                                           {0.060f, z0}}));
  };
  disc(3.48f, 3.62f, 0.155f);
  disc(3.78f, 3.86f, 0.185f);
  disc(4.02f, 4.12f, 0.175f);
  for (const float x : {-1.0f, 1.0f})
    for (const float y : {-1.0f, 1.0f})
      shapes::append(brake, raised(w.hull({{x * 0.075f - 0.05f, y * 0.112f - 0.035f, 3.58f},
                                           {x * 0.075f + 0.05f, y * 0.112f - 0.035f, 3.58f},
                                           {x * 0.075f - 0.05f, y * 0.112f + 0.035f, 3.58f},
                                           {x * 0.075f + 0.05f, y * 0.112f + 0.035f, 3.58f},
                                           {x * 0.075f - 0.05f, y * 0.112f - 0.035f, 4.06f},
                                           {x * 0.075f + 0.05f, y * 0.112f - 0.035f, 4.06f},
                                           {x * 0.075f - 0.05f, y * 0.112f + 0.035f, 4.06f},
                                           {x * 0.075f + 0.05f, y * 0.112f + 0.035f, 4.06f}},
                                          0.015f)));
  w.add("muzzle brake", std::move(brake), w.paint.dark);
  // The bore, visible from the front, ends deep inside.
  const shapes::Points2 bore = {{0.0f, 3.40f},   {0.058f, 3.40f}, {0.058f, 3.40f}, {0.062f, 3.60f}, {0.062f, 3.60f},
                                {0.052f, 3.60f}, {0.052f, 3.60f}, {0.05f, 3.42f},  {0.05f, 3.42f},  {0.0f, 3.42f}};
  w.add("bore", raised_lathe(w, bore), w.paint.rubber);
}

void add_gun(Workshop& w) {
  add_mantlet(w);
  add_barrel(w);
  add_muzzle(w);
  // A smaller gun beside the main one.
  Mesh second = raised(w.drum({0.33f, 0.02f, 0.3f}, {0.33f, 0.02f, 0.52f}, 0.065f));
  shapes::append(second, raised(w.drum({0.33f, 0.02f, 0.4f}, {0.33f, 0.02f, 0.95f}, 0.028f, 0.006f, 14.0f)));
  w.add("coaxial gun", std::move(second), w.paint.dark);
}

/// Adds reactive armour bricks on the cheeks, with gaps between them.
void add_cheek_bricks(Workshop& w) {
  for (const float side : {-1.0f, 1.0f})
    for (int row = 0; row < 2; ++row)
      for (int i = 0; i < 3; ++i) {
        // The cheek is the plane through three of the turret's corners.
        const vec3 a(side * 0.62f, 1.96f, 1.42f), b(side * 1.30f, 1.92f, 0.50f), c(side * 0.42f, kRoof, 0.62f),
            e(side * 0.92f, kRoof, 0.20f);
        const vec3 out = glm::normalize(glm::cross(b - a, c - a)) * side;
        const vec3 d = e - out * glm::dot(out, e - a);
        const float u0 = 0.06f + 0.31f * float(i), u1 = u0 + 0.27f, v0 = 0.08f + 0.45f * float(row), v1 = v0 + 0.38f;
        const auto at = [&](float u, float v, float lift) {
          return glm::mix(glm::mix(a, b, u), glm::mix(c, d, u), v) + lift * out;
        };
        std::vector<vec3> corners;
        for (const float lift : {-0.01f, 0.07f})
          for (const float u : {u0, u1})
            for (const float v : {v0, v1}) corners.push_back(at(u, v, lift));
        Mesh brick = rounded_hull(corners, 0.012f, w.steps(2.0f));
        shapes::append(brick, w.bolt(at(0.5f * (u0 + u1), 0.5f * (v0 + v1), 0.07f), out, 0.024f));
        w.add("armour brick", std::move(brick), (i + row) % 2 == 0 ? w.paint.plate : w.paint.armour);
      }
}

/// Adds the commander's cupola with periscopes and a slightly open lid.
void add_cupola(Workshop& w) {
  const vec3 cupola(0.48f, kRoof - 0.02f, -0.42f);
  const shapes::Points2 ring = {{0.40f, 0.0f},   {0.40f, 0.0f},   {0.38f, 0.12f}, {0.36f, 0.15f}, {0.33f, 0.165f},
                                {0.30f, 0.165f}, {0.30f, 0.165f}, {0.29f, 0.14f}, {0.29f, 0.14f}, {0.0f, 0.14f}};
  w.add("cupola", shapes::moved(shapes::lathe(ring, w.detail(34.0f, 12)), cupola), w.paint.plate);
  for (int i = 0; i < 7; ++i) {
    const float a = 2.0f * kPi * (float(i) + 0.5f) / 8.0f - 0.5f * kPi;
    const mat4 turn = glm::rotate(glm::translate(mat4(1.0f), cupola), a, vec3(0, 1, 0));
    w.add("cupola periscope",
          shapes::transformed(w.block({-0.065f, 0.02f, 0.34f}, {0.065f, 0.125f, 0.43f}, 0.012f), turn), w.paint.armour);
    w.add("cupola glass",
          shapes::transformed(w.block({-0.045f, 0.055f, 0.42f}, {0.045f, 0.105f, 0.437f}, 0.006f), turn),
          w.paint.glass);
  }
  Mesh lid = w.drum({0, 0, 0}, {0, 0.04f, 0}, 0.285f, 0.018f, 30.0f);
  shapes::append(lid, w.drum({0, 0.03f, 0}, {0, 0.07f, 0}, 0.19f, 0.03f, 30.0f));
  shapes::append(
      lid,
      w.pipe({{-0.10f, 0.06f, 0.10f}, {-0.09f, 0.11f, 0.10f}, {0.09f, 0.11f, 0.10f}, {0.10f, 0.06f, 0.10f}}, 0.014f));
  shapes::append(lid, w.block({-0.06f, -0.02f, -0.36f}, {0.06f, 0.04f, -0.24f}, 0.015f));
  w.add("cupola lid",
        shapes::moved(shapes::turned_x(shapes::moved(lid, {0, 0, 0.30f}), -14.0f), cupola + vec3(0, 0.17f, -0.30f)),
        w.paint.armour);
}

/// Adds the loader's hatch: a flat lid with hinges.
void add_loaders_hatch(Workshop& w) {
  const vec3 loader(-0.50f, kRoof - 0.02f, -0.30f);
  Mesh hatch = w.drum(loader, loader + vec3(0, 0.06f, 0), 0.32f, 0.02f, 30.0f);
  shapes::append(hatch, w.drum(loader + vec3(0, 0.05f, 0), loader + vec3(0, 0.10f, 0), 0.27f, 0.03f, 30.0f));
  for (const float x : {-0.12f, 0.12f})
    shapes::append(hatch,
                   w.block(loader + vec3(x - 0.035f, 0.02f, -0.40f), loader + vec3(x + 0.035f, 0.11f, -0.20f), 0.015f));
  shapes::append(hatch, w.pipe({loader + vec3(-0.09f, 0.09f, 0.12f), loader + vec3(-0.08f, 0.14f, 0.12f),
                                loader + vec3(0.08f, 0.14f, 0.12f), loader + vec3(0.09f, 0.09f, 0.12f)},
                               0.014f));
  w.add("loader's hatch", std::move(hatch), w.paint.plate);
}

/// Adds a machine gun on a post by the loader's hatch.
void add_machine_gun(Workshop& w) {
  const vec3 post(-0.50f, kRoof, 0.22f);
  Mesh mount = w.drum(post - vec3(0, 0.05f, 0), post + vec3(0, 0.05f, 0), 0.09f);
  shapes::append(mount, w.drum(post, post + vec3(0, 0.24f, 0), 0.035f));
  shapes::append(mount, w.block(post + vec3(-0.05f, 0.22f, -0.07f), post + vec3(0.05f, 0.28f, 0.07f)));
  w.add("gun mount", std::move(mount), w.paint.plate);
  Mesh gun = w.block(post + vec3(-0.045f, 0.27f, -0.30f), post + vec3(0.045f, 0.38f, 0.26f), 0.015f);
  shapes::append(gun, w.drum(post + vec3(0, 0.33f, 0.25f), post + vec3(0, 0.33f, 0.55f), 0.034f, 0.008f, 14.0f));
  shapes::append(gun, w.drum(post + vec3(0, 0.33f, 0.50f), post + vec3(0, 0.33f, 0.98f), 0.018f, 0.004f, 12.0f));
  shapes::append(gun, w.drum(post + vec3(0, 0.33f, 0.92f), post + vec3(0, 0.33f, 1.02f), 0.028f, 0.006f, 12.0f));
  for (const float x : {-0.03f, 0.03f})
    shapes::append(gun, w.drum(post + vec3(x, 0.33f, -0.30f), post + vec3(x, 0.36f, -0.42f), 0.014f, 0.005f, 8.0f));
  w.add("machine gun", std::move(gun), w.paint.dark);
  w.add("ammunition box", w.block(post + vec3(0.045f, 0.22f, -0.12f), post + vec3(0.19f, 0.37f, 0.12f), 0.012f),
        w.paint.plate);
}

/// Adds smoke dischargers, four tubes per side, and lifting eyes.
void add_smoke_dischargers(Workshop& w) {
  for (const float side : {-1.0f, 1.0f}) {
    Mesh tubes = w.block({side * 1.21f - 0.06f, 2.00f, -0.62f}, {side * 1.21f + 0.06f, 2.10f, 0.10f});
    for (int i = 0; i < 4; ++i) {
      const vec3 from(side * 1.20f, 2.06f, -0.52f + 0.17f * float(i));
      const vec3 direction = glm::normalize(vec3(side * 0.75f, 0.62f, 0.30f));
      const shapes::Points2 tube = {{0.0f, 0.0f},    {0.062f, 0.0f},  {0.062f, 0.0f},  {0.062f, 0.25f}, {0.062f, 0.25f},
                                    {0.050f, 0.25f}, {0.050f, 0.25f}, {0.050f, 0.04f}, {0.050f, 0.04f}, {0.0f, 0.04f}};
      shapes::append(tubes, w.between(shapes::lathe(tube, w.detail(18.0f, 8)), from, from + direction));
    }
    w.add("smoke dischargers", std::move(tubes), w.paint.dark);
    for (const float z : {0.28f, -1.35f})
      w.add("lifting eye",
            w.pipe({{side * 0.80f, kRoof - 0.04f, z - 0.07f},
                    {side * 0.82f, kRoof + 0.05f, z - 0.05f},
                    {side * 0.82f, kRoof + 0.05f, z + 0.05f},
                    {side * 0.80f, kRoof - 0.04f, z + 0.07f}},
                   0.018f),
            w.paint.steel);
  }
}

/// Adds the sight in front of the cupola.
void add_sight(Workshop& w) {
  const vec3 sight(0.50f, kRoof - 0.02f, 0.18f);
  w.add("sight", w.tapered(sight, {0.13f, -0.16f, 0.16f}, 0.21f, {0.11f, -0.12f, 0.15f}), w.paint.plate);
  w.add("sight glass", w.block(sight + vec3(-0.08f, 0.08f, 0.14f), sight + vec3(0.08f, 0.17f, 0.165f), 0.008f),
        w.paint.glass);
}

/// Adds the rack at the rear: rails on posts, and floor bars.
void add_rack(Workshop& w) {
  Mesh rack;
  for (const float y : {1.98f, 2.20f, 2.36f})
    shapes::append(rack, w.pipe({{0.86f, y, -1.55f},
                                 {0.90f, y, -1.85f},
                                 {0.90f, y, -2.15f},
                                 {0.84f, y, -2.29f},
                                 {0.70f, y, -2.35f},
                                 {0.25f, y, -2.35f},
                                 {-0.25f, y, -2.35f},
                                 {-0.70f, y, -2.35f},
                                 {-0.84f, y, -2.29f},
                                 {-0.90f, y, -2.15f},
                                 {-0.90f, y, -1.85f},
                                 {-0.86f, y, -1.55f}},
                                0.020f, 8.0f));
  for (const vec2& p : {vec2(0.84f, -2.29f), vec2(-0.84f, -2.29f), vec2(0.44f, -2.35f), vec2(-0.44f, -2.35f),
                        vec2(0.0f, -2.35f), vec2(0.90f, -1.92f), vec2(-0.90f, -1.92f)})
    shapes::append(rack, w.drum({p.x, 1.96f, p.y}, {p.x, 2.38f, p.y}, 0.018f, 0.004f, 8.0f));
  for (int i = 0; i < 9; ++i) {
    const float x = -0.80f + 0.20f * float(i);
    shapes::append(rack, w.drum({x, 1.98f, -1.68f}, {x, 1.98f, -2.35f}, 0.014f, 0.003f, 6.0f));
  }
  w.add("rack", std::move(rack), w.paint.dark);
}

/// Adds the load of the rack: rolled tarpaulins with straps, a crate and a can.
void add_rack_load(Workshop& w) {
  const auto roll = [&](vec3 from, vec3 to, float radius) {
    Mesh cloth = w.drum(from, to, radius, 0.4f * radius, 22.0f);
    const int object = w.add("tarpaulin", std::move(cloth), w.paint.canvas);
    Mesh straps;
    for (const float u : {0.22f, 0.78f})
      shapes::append(straps, w.drum(glm::mix(from, to, u - 0.025f), glm::mix(from, to, u + 0.025f), radius + 0.010f,
                                    0.006f, 22.0f));
    w.add("straps", std::move(straps), w.paint.wood, object);
  };
  roll({-0.80f, 2.105f, -2.19f}, {0.10f, 2.105f, -2.19f}, 0.115f);
  roll({-0.74f, 2.105f, -1.95f}, {0.06f, 2.105f, -1.95f}, 0.112f);
  roll({-0.68f, 2.285f, -2.06f}, {0.00f, 2.285f, -2.08f}, 0.095f);
  w.add("crate", w.block({0.20f, 1.99f, -2.28f}, {0.62f, 2.27f, -1.86f}, 0.018f), w.paint.wood);
  Mesh planks;
  for (int i = 0; i < 3; ++i) {
    const float y = 2.01f + 0.09f * float(i);
    shapes::append(planks, w.block({0.19f, y, -2.29f}, {0.63f, y + 0.06f, -2.26f}, 0.008f));
  }
  w.add("crate planks", std::move(planks), w.paint.wood);
  w.add("can", w.block({0.66f, 1.99f, -2.22f}, {0.82f, 2.40f, -1.90f}, 0.035f), w.paint.plate);
  w.add(
      "can handle",
      w.pipe({{0.74f, 2.37f, -2.14f}, {0.74f, 2.44f, -2.12f}, {0.74f, 2.44f, -2.00f}, {0.74f, 2.37f, -1.98f}}, 0.016f),
      w.paint.dark);
}

/// Adds two whip aerials, bent by their own weight.
void add_aerials(Workshop& w) {
  for (const float side : {-1.0f, 1.0f}) {
    const vec3 base(side * 0.70f, kRoof - 0.05f, -1.42f);
    w.add("aerial base", w.drum(base, base + vec3(0, 0.14f, 0), 0.05f, 0.02f, 16.0f), w.paint.rubber);
    w.add("aerial",
          w.pipe({base + vec3(0, 0.12f, 0), base + vec3(side * 0.01f, 0.6f, -0.05f),
                  base + vec3(side * 0.05f, 1.05f, -0.18f), base + vec3(side * 0.10f, 1.35f, -0.34f)},
                 0.010f, 6.0f),
          w.paint.dark);
  }
}

void add_turret(Workshop& w) {
  w.add("turret ring", w.drum({0, kDeck - 0.03f, -0.1f}, {0, kTurretFloor + 0.04f, -0.1f}, 1.12f, 0.03f, 44.0f),
        w.paint.dark);
  w.add("turret",
        w.symmetric_hull({{0.60f, kTurretFloor, 1.38f},
                          {1.20f, kTurretFloor, 0.62f},
                          {1.30f, 1.92f, 0.50f},
                          {0.62f, 1.96f, 1.42f},
                          {1.22f, kTurretFloor, -1.00f},
                          {1.32f, 1.94f, -1.05f},
                          {0.85f, 1.84f, -1.72f},
                          {0.92f, 1.98f, -1.80f},
                          {0.42f, kRoof, 0.62f},
                          {0.92f, kRoof, 0.20f},
                          {0.98f, kRoof, -0.95f},
                          {0.78f, kRoof - 0.03f, -1.62f}},
                         0.035f),
        w.paint.armour);
  add_cheek_bricks(w);
  add_cupola(w);
  add_loaders_hatch(w);
  add_machine_gun(w);
  add_smoke_dischargers(w);
  add_sight(w);
  add_rack(w);
  add_rack_load(w);
  add_aerials(w);
}

/// Adds a round concrete pad with a joint, a raised edge and a marked ring.
void add_pad(Workshop& w) {
  const int slices = w.detail(80.0f, 24);
  const shapes::Points2 slab = {{0.0f, -0.30f},   {4.95f, -0.30f}, {4.95f, -0.30f}, {5.0f, -0.26f},   {5.0f, -0.05f},
                                {4.98f, -0.015f}, {4.95f, 0.0f},   {4.95f, 0.0f},   {4.62f, 0.0f},    {4.62f, 0.0f},
                                {4.61f, -0.012f}, {4.60f, -0.05f}, {4.56f, -0.05f}, {4.55f, -0.012f}, {4.54f, 0.0f},
                                {4.54f, 0.0f},    {0.0f, 0.0f}};
  const int pad = w.add("pad", shapes::lathe(slab, slices), w.paint.pad);
  const shapes::Points2 ring = {{4.68f, -0.01f}, {4.90f, -0.01f}, {4.90f, -0.01f}, {4.90f, 0.004f},
                                {4.90f, 0.004f}, {4.68f, 0.004f}, {4.68f, 0.004f}, {4.68f, -0.01f}};
  w.add("marking", shapes::lathe(ring, slices), w.paint.line, pad);
}

Scene build(const Detail& detail) {
  Workshop w{.scene = {}, .detail = detail, .paint = {}};
  w.paint = add_paint(w.scene);
  add_running_gear(w);
  add_hull(w);
  add_rear(w);
  add_stowage(w);
  add_gun(w);
  add_turret(w);
  add_pad(w);
  w.scene.views = {{.eye = {-6.9f, 4.5f, -11.2f}, .target = {-0.15f, 1.22f, -0.55f}, .angle_deg = 31.0f},
                   {.eye = {8.0f, 3.6f, 11.4f}, .target = {0.15f, 1.35f, 1.35f}, .angle_deg = 33.0f}};
  return std::move(w.scene);
}

}  // namespace

Scene make_tank(int triangles) { return shapes::build_to_count(triangles, build); }

}  // namespace umbrage
