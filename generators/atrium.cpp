// The atrium: an open court of 9 by 24 metres between two storeys of round arches, with vaulted galleries behind,
// drapes, plants and a fountain. It has features for judging occlusion and color bleeding: long corners, thin rails,
// fluting, folds of coloured cloth near plain stone, cut-out leaves, sun and deep shadow.
#include <algorithm>
#include <array>
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

// The plan, seen from above: the arcades stand on the rectangle +-kCourt; the galleries' outer walls are kGallery
// behind it.
constexpr float kBay = 3.0f;
constexpr vec2 kCourt(4.5f, 12.0f);
constexpr float kGallery = 3.2f;
constexpr float kWall = 0.6f;     // thickness of the arcade walls
constexpr float kOpening = 2.3f;  // width of an arch
constexpr float kPier = 0.84f;    // corner piers, a little wider than the walls that end in them

// The section: heights of the parts, metres.
constexpr float kStep = 0.15f;        // the galleries are one step above the court
constexpr float kSpring = 3.5f;       // lower arches
constexpr float kFloor = 5.3f;        // upper storey
constexpr float kRail = 6.35f;        // top of the balustrade and of the upper columns' pedestals
constexpr float kSpringUpper = 8.5f;  // upper arches
constexpr float kTop = 10.1f;         // top of the upper walls
constexpr float kEaves = 10.5f;       // lowest edge of the roof

/// A lantern that burns, behind glass of one of four colours. Lanterns hang in every second arch of the long sides.
struct Lantern {
  int side, index, glass;  ///< see Bay
};
constexpr std::array<Lantern, 4> kBurning = {{{1, 4, 1}, {1, 2, 2}, {0, 5, 0}, {0, 3, 3}}};
constexpr std::array<vec3, 4> kGlassColour = {
    {{1.00f, 0.58f, 0.20f}, {1.00f, 0.24f, 0.22f}, {0.16f, 0.78f, 0.66f}, {0.34f, 0.42f, 1.00f}}};
constexpr float kGlassHeight = 2.95f;  // height of a lantern's centre
// Glass is brighter than the walls that it lights, but not white in the picture.
constexpr float kGlassShine = 0.85f;
// Brightness of a lantern's light at kLanternReach, the distance of the nearest columns: less than the sun's, more than
// the sky's.
constexpr float kLanternLight = 0.8f, kLanternReach = 1.3f;
// The light is below the lantern, since glass and metal would block it, and so far below that their shadow is narrow
// and falls only on the arch's crown.
constexpr float kFlameDrop = 0.55f, kFlameRadius = 0.05f;

struct Materials {
  int stone, blocks, plaster, vault, court, tiles, wood, roof, iron, terracotta, water, soil, leaf, frond, bark, door,
      brass, unlit;
  std::array<int, 4> glow;  ///< by Lantern::glass
  std::array<int, 3> cloth;
};

Materials add_materials(Scene& scene) {
  using namespace procedural;
  Materials m{};
  const MaterialMaker make{scene};
  m.stone = make.textured("dressed stone", plaster(512, {0.62f, 0.55f, 0.44f}, 0.16f, 11));
  m.blocks =
      make.textured("stone blocks", stone_blocks(512, 4, 8, {0.60f, 0.52f, 0.40f}, {0.42f, 0.37f, 0.30f}, 0.05f, 12));
  m.plaster = make.textured("plaster", plaster(256, {0.66f, 0.52f, 0.36f}, 0.14f, 13));
  m.vault = make.textured("vault plaster", plaster(256, {0.68f, 0.63f, 0.54f}, 0.10f, 14));
  m.court = make.textured("court floor",
                          marble_tiles(512, {0.60f, 0.55f, 0.46f}, {0.36f, 0.22f, 0.15f}, {0.12f, 0.17f, 0.19f}, 15),
                          0.15f, 64.0f);
  m.tiles = make.textured("gallery floor",
                          marble_tiles(512, {0.46f, 0.22f, 0.12f}, {0.40f, 0.18f, 0.10f}, {0.50f, 0.43f, 0.32f}, 16));
  m.wood = make.textured("ceiling wood", wood(256, 1, {0.30f, 0.17f, 0.08f}, {0.14f, 0.07f, 0.03f}, 17));
  m.door = make.textured("doors", wood(256, 5, {0.24f, 0.13f, 0.06f}, {0.11f, 0.05f, 0.02f}, 18));
  m.roof = make.textured("roof tiles", plaster(256, {0.47f, 0.21f, 0.12f}, 0.3f, 19));
  m.terracotta = make.textured("terracotta", plaster(256, {0.50f, 0.22f, 0.11f}, 0.2f, 20));
  m.iron = make.cut_out("window grilles", lattice(256, 5, 0.07f, {0.05f, 0.045f, 0.04f}));
  m.leaf = make.cut_out("leaves", leaf(128, {0.07f, 0.20f, 0.035f}, {0.18f, 0.32f, 0.09f}));
  m.frond = make.cut_out("fronds", frond(256, 512, {0.09f, 0.24f, 0.045f}, {0.20f, 0.26f, 0.08f}));
  m.bark = make.plain("bark", {0.20f, 0.14f, 0.09f});
  m.soil = make.plain("soil", {0.09f, 0.06f, 0.04f});
  m.water = make.plain("water", {0.07f, 0.16f, 0.17f}, 0.8f, 200.0f);
  m.brass = make.plain("brass", {0.45f, 0.30f, 0.10f}, 0.5f, 60.0f);
  m.unlit = make.plain("lamp glass", {0.55f, 0.45f, 0.28f});
  constexpr std::array<const char*, 4> kGlass = {"amber lamp glass", "red lamp glass", "green lamp glass",
                                                 "blue lamp glass"};
  for (std::size_t k = 0; k < kGlass.size(); ++k)
    m.glow[k] = add_material(
        scene, {.name = kGlass[k], .albedo = 0.3f + 0.4f * kGlassColour[k], .emission = kGlassShine * kGlassColour[k]});
  m.cloth = {make.textured("red damask", damask(512, {0.46f, 0.025f, 0.02f}, {0.60f, 0.34f, 0.10f})),
             make.textured("green damask", damask(512, {0.03f, 0.22f, 0.05f}, {0.45f, 0.42f, 0.14f})),
             make.textured("blue damask", damask(512, {0.02f, 0.07f, 0.36f}, {0.38f, 0.42f, 0.50f}))};
  return m;
}

/// One bay of the arcades: a frame with x along the wall, z towards the court, and the bay's centre at the origin.
struct Bay {
  mat4 place;
  int side;   ///< 0, 1: the long sides at -x and +x; 2, 3: the ends at -z and +z
  int index;  ///< along the side
};

std::vector<Bay> all_bays() {
  std::vector<Bay> bays;
  const auto add = [&bays](vec3 at, float turn_deg, int side, int index) {
    const mat4 place = glm::rotate(glm::translate(mat4(1.0f), at), glm::radians(turn_deg), vec3(0, 1, 0));
    bays.push_back({place, side, index});
  };
  const int along = int(std::lround(2.0f * kCourt.y / kBay)), across = int(std::lround(2.0f * kCourt.x / kBay));
  for (int i = 0; i < along; ++i) {
    const float z = -kCourt.y + kBay * (float(i) + 0.5f);
    add({-kCourt.x, 0, z}, 90.0f, 0, i);
    add({kCourt.x, 0, z}, -90.0f, 1, i);
  }
  for (int i = 0; i < across; ++i) {
    const float x = -kCourt.x + kBay * (float(i) + 0.5f);
    add({x, 0, -kCourt.y}, 0.0f, 2, i);
    add({x, 0, kCourt.y}, 180.0f, 3, i);
  }
  return bays;
}

/// Returns the feet of the columns: between the bays of each side, not in the corners.
std::vector<mat4> column_places() {
  std::vector<mat4> places;
  const auto add = [&places](vec3 at, float turn_deg) {
    places.push_back(glm::rotate(glm::translate(mat4(1.0f), at), glm::radians(turn_deg), vec3(0, 1, 0)));
  };
  for (float z = -kCourt.y + kBay; z < kCourt.y - 0.1f; z += kBay) {
    add({-kCourt.x, 0, z}, 90.0f);
    add({kCourt.x, 0, z}, -90.0f);
  }
  for (float x = -kCourt.x + kBay; x < kCourt.x - 0.1f; x += kBay) {
    add({x, 0, -kCourt.y}, 0.0f);
    add({x, 0, kCourt.y}, 180.0f);
  }
  return places;
}

/// Returns a rectangular path around the origin. A moulding on it faces outwards or inwards.
Points3 ring(vec2 half, float y, bool outwards) {
  if (outwards) return {{-half.x, y, -half.y}, {-half.x, y, half.y}, {half.x, y, half.y}, {half.x, y, -half.y}};
  return {{-half.x, y, -half.y}, {half.x, y, -half.y}, {half.x, y, half.y}, {-half.x, y, half.y}};
}

// ----------------------------------------------------------------------------------------------------------- columns

/// Makes a bell between two radii, surrounded by two rows of eight leaves that curl outwards at their tips.
Mesh leafy_capital(float radius_low, float radius_high, float height, const Detail& d) {
  const auto leaf_row = [](float turn, float v, float from, float to) {
    const float t = (v - from) / (to - from);
    if (t < 0.0f || t > 1.0f) return 0.0f;
    const float across = std::abs(turn - std::floor(turn) - 0.5f) * 2.0f;
    const float width = 0.92f * std::sqrt(std::max(1.0f - t * t, 0.0f));
    const float inside = glm::smoothstep(0.0f, 0.22f, width - across);
    const float midrib = 0.75f + 0.25f * glm::smoothstep(0.0f, 0.16f, across);
    return inside * midrib * (0.35f + 0.65f * t * t);
  };
  return surface(
      d(72, 8), d(24, 3),
      [&](float u, float v) {
        const float bell = radius_low + (radius_high - radius_low) * std::pow(v, 2.2f);
        const float low = leaf_row(8.0f * u, v, -0.02f, 0.52f), high = leaf_row(8.0f * u + 0.5f, v, 0.2f, 0.94f);
        const float r = bell + 0.24f * radius_low * std::max(low, 0.9f * high);
        const float turn = 2.0f * kPi * u;
        return SurfacePoint{{r * std::sin(turn), height * v, r * std::cos(turn)}, {radius_high * turn, height * v}};
      },
      {.u = true});
}

/// Makes a column from its plinth at y = 0 to the top of its abacus at `height`.
Mesh column(float height, float radius, int flutes, const Detail& d) {
  const float plinth = 0.55f * radius, base = 0.75f * radius, capital = 1.9f * radius, abacus = 0.45f * radius;
  const float half = 1.42f * radius, neck = 0.84f * radius;
  Mesh mesh = box({-half, 0, -half}, {half, plinth, half}, 0.04f * radius, d(1, 0));
  // An Attic base: a torus, a hollow, a smaller torus.
  const int turn = d(6, 2);
  Points2 low = arc({1.18f * radius, plinth + 0.17f * radius}, 0.17f * radius, -90.0f, 90.0f, turn);
  Points2 hollow = arc({1.26f * radius, plinth + 0.44f * radius}, 0.12f * radius, 250.0f, 110.0f, turn);
  Points2 high = arc({1.08f * radius, plinth + 0.65f * radius}, 0.10f * radius, -90.0f, 90.0f, turn);
  append(mesh, lathe(join({low, hollow, high, {{radius, plinth + base}}}), d(32, 8)));
  // Shaft with entasis: straight for a third, then drawn in along a curve.
  const float from = plinth + base, to = height - capital - abacus;
  if (d(4) < 3) flutes = 0;  // too coarse for fluting
  const int slices = flutes > 0 ? flutes * d(4) : d(32, 8);
  append(mesh, surface(slices, d(12, 3),
                       [&](float u, float v) {
                         const float rise = std::max(v - 0.3f, 0.0f) / 0.7f;
                         float r = radius + (neck - radius) * (0.35f * rise + 0.65f * rise * rise);
                         const float ends = glm::smoothstep(0.0f, 0.04f, v) * (1.0f - glm::smoothstep(0.96f, 1.0f, v));
                         if (flutes > 0) r -= 0.09f * radius * ends * std::abs(std::sin(kPi * float(flutes) * u));
                         const float angle = 2.0f * kPi * u, y = from + v * (to - from);
                         return SurfacePoint{{r * std::sin(angle), y, r * std::cos(angle)}, {radius * angle, y}};
                       },
                       {.u = true}));
  append(mesh, moved(torus(neck, 0.09f * radius, d(32, 8), d(8, 4)), {0, to, 0}));
  append(mesh, moved(leafy_capital(neck, 1.3f * radius, capital, d), {0, to, 0}));
  append(mesh, box({-1.36f * radius, height - abacus, -1.36f * radius}, {1.36f * radius, height, 1.36f * radius},
                   0.08f * radius, d(1, 0)));
  return mesh;
}

/// Makes a corner pier with a foot and a head.
Mesh pier(float low, float high, const Detail& d) {
  const float half = 0.5f * kPier;
  Mesh mesh = box({-half, low, -half}, {half, high, half}, 0.02f, d(1, 0));
  const Points2 foot = join({{{0.07f, 0.0f}, {0.07f, 0.24f}}, arc({0.0f, 0.24f}, 0.05f, 0.0f, 90.0f, d(4, 2))});
  append(mesh, moulding(ring(vec2(half), low, true), foot, true));
  return mesh;
}

/// Makes the moulding at the spring of an arch on a pier, with the outline of a capital's abacus.
Mesh impost(float y, const Detail& d) {
  const Points2 section = join({arc({0.0f, -0.22f}, 0.07f, -80.0f, 0.0f, d(4, 2)),
                                {{0.09f, -0.13f}, {0.09f, 0.0f}, {0.09f, 0.0f}, {0.0f, 0.0f}}});
  return moulding(ring(vec2(0.5f * kPier), y, true), section, true);
}

// ------------------------------------------------------------------------------------------------------------- walls

/// Makes a plain band with a rounded edge along the arch that projects from the wall, and its keystone.
Mesh archivolt(float spring, const Detail& d) {
  const float radius = 0.5f * kOpening, front = 0.5f * kWall;
  Points3 path;
  for (const vec2 p : arc({0, spring}, radius + 0.11f, 0.0f, 180.0f, d(24, 6))) path.emplace_back(p.x, p.y, front);
  Points2 section = rectangle({0.20f, 0.10f}, 0.025f, d(2, 0));
  Mesh mesh = sweep(path, section, {1, 0, 0});
  const Points2 key = {
      {-0.10f, radius - 0.03f}, {0.10f, radius - 0.03f}, {0.15f, radius + 0.42f}, {-0.15f, radius + 0.42f}};
  append(mesh, moved(extrusion(sharp(key), 0.12f), {0, spring, front - 0.02f}));
  return mesh;
}

/// Makes a round boss with two rings of petals, facing +z.
Mesh rosette(float radius, const Detail& d) {
  return surface(
      d(40, 10), d(10, 3),
      [&](float u, float v) {
        const float r = radius * (1.0f - v);  // from the edge to the centre, so that the front is +z
        const float turn = 2.0f * kPi * u, fraction = 1.0f - v;
        const float outer = std::abs(std::cos(4.0f * turn)), inner = std::abs(std::sin(4.0f * turn));
        float z = 0.05f * glm::smoothstep(1.0f, 0.93f, fraction);
        if (fraction < 0.78f)
          z = 0.012f + 0.07f * std::sqrt(outer) * std::sin(kPi * std::clamp(fraction / 0.78f, 0.0f, 1.0f));
        if (fraction < 0.45f) z = std::max(z, 0.03f + 0.07f * std::sqrt(inner) * std::sin(kPi * fraction / 0.45f));
        if (fraction < 0.17f) z = 0.10f * std::sqrt(1.0f - fraction * fraction / 0.03f);
        return SurfacePoint{{r * std::cos(turn), r * std::sin(turn), z}, {r * std::cos(turn), r * std::sin(turn)}};
      },
      {.u = true});
}

/// Makes a wall across a bay in the plane z = 0, with a round-headed hole and its reveals, `depth` deep behind.
Mesh wall_with_arched_hole(float width, float height, float opening, float sill, float spring, float depth,
                           const Detail& d) {
  const float half = 0.5f * width, o = 0.5f * opening;
  Mesh mesh = moved(arch(opening, width, height - spring, depth, d(20, 6)), {0, spring, -0.5f * depth});
  append(mesh, quad({-half, 0, 0}, {-o, 0, 0}, {-o, spring, 0}, {-half, spring, 0}, 1, 1));
  append(mesh, quad({o, 0, 0}, {half, 0, 0}, {half, spring, 0}, {o, spring, 0}, 1, 1));
  append(mesh, quad({-o, sill, 0}, {-o, sill, -depth}, {-o, spring, -depth}, {-o, spring, 0}, 1, 1));
  append(mesh, quad({o, sill, -depth}, {o, sill, 0}, {o, spring, 0}, {o, spring, -depth}, 1, 1));
  if (sill > 0.0f) {
    append(mesh, quad({-o, 0, 0}, {o, 0, 0}, {o, sill, 0}, {-o, sill, 0}, 1, 1));
    append(mesh, quad({-o, sill, 0}, {o, sill, 0}, {o, sill, -depth}, {-o, sill, -depth}, 1, 1));
  }
  box_uvs(mesh);
  return mesh;
}

/// Makes a round-headed panel in the plane z = 0, standing on y = 0.
Mesh arched_panel(float width, float spring, const Detail& d) {
  const float o = 0.5f * width;
  Mesh mesh = surface(d(20, 6), 1, [&](float u, float v) {
    const float angle = kPi * (1.0f - u);
    const vec2 top(o * std::cos(angle), spring + o * std::sin(angle));
    const vec2 p(top.x, v * top.y);
    return SurfacePoint{{p.x, p.y, 0.0f}, p};
  });
  return mesh;
}

/// Makes a groin vault over a rectangle around the origin, springing at y = 0, facing down: two barrels that intersect.
Mesh groin_vault(vec2 half, float rise, const Detail& d) {
  Mesh mesh;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const bool along_z = quarter % 2 == 0;
    const float sign = quarter < 2 ? 1.0f : -1.0f;
    Mesh part = surface(d(16, 4), d(6, 2), [&](float u, float v) {
      // In this quarter the barrel runs towards the edge, and its height depends only on the position across.
      const float across = std::sin(0.5f * kPi * (2.0f * u - 1.0f)) * v;
      const float y = rise * std::sqrt(std::max(1.0f - across * across, 0.0f));
      const vec2 p = along_z ? vec2(across, sign * v) : vec2(sign * v, across);
      return SurfacePoint{{p.x * half.x, y, p.y * half.y}, {p.x * half.x, p.y * half.y}};
    });
    glm::vec3 facing(0.0f);
    for (const vec3& normal : part.normals) facing += normal;
    append(mesh, facing.y > 0.0f ? flipped(std::move(part)) : std::move(part));
  }
  return mesh;
}

Mesh baluster(float height, const Detail& d) {
  const float w = 0.075f;
  Mesh mesh = box({-w, 0, -w}, {w, 0.07f, w});
  append(mesh, box({-w, height - 0.07f, -w}, {w, height, w}));
  const float h = height - 0.14f;
  const Points2 waist = {{0.055f, 0.0f},      {0.05f, 0.06f * h},  {0.078f, 0.22f * h}, {0.07f, 0.36f * h},
                         {0.035f, 0.66f * h}, {0.033f, 0.86f * h}, {0.055f, 0.93f * h}, {0.05f, h}};
  append(mesh, moved(lathe(smooth(waist, d(2)), d(10, 5)), {0, 0.07f, 0}));
  return mesh;
}

// ------------------------------------------------------------------------------------------------------------- cloth

/// Makes one half of a curtain, hanging from y = 0 to -height beside x = 0 and drawn to the side by a tie at `tie`
/// below the rail. Covers x in [0, width] at the rail and gathers towards x = 0.
Mesh tied_curtain(float width, float height, float tie, std::uint32_t seed, const Detail& d) {
  constexpr float kFolds = 7.0f;
  noise::Random random{noise::hash(seed)};
  const float start = random.next();
  return surface(d(72, 10), d(40, 4), [&](float u, float v) {
    const float down = 1.0f - v, y = -height * down;
    const float at_tie = tie / height;
    // Fraction of the full width: the free edge falls in an arc to the tie, then opens again a little.
    const float above = std::clamp(down / at_tie, 0.0f, 1.0f);
    const float below = std::clamp((down - at_tie) / (1.0f - at_tie), 0.0f, 1.0f);
    const float narrow =
        0.24f + 0.76f * std::pow(1.0f - above, 0.62f) * (1.0f - 0.35f * above) + 0.30f * std::pow(below, 0.7f);
    const float drift = 0.35f * noise::gradient({3.0f * u, 2.0f * down}, seed);
    const float phase = 2.0f * kPi * (kFolds * u + start + drift);
    const float from_tie = (down - at_tie) / 0.16f, gathered = std::exp(-from_tie * from_tie);
    const float depth = (0.055f + 0.02f * down) * (1.0f - 0.45f * gathered);
    const float wave = std::sin(phase) + 0.3f * std::sin(2.0f * phase + 0.7f);
    // Cloth above the tie sags outwards from the wall of the opening.
    const float x = width * narrow * u + 0.02f * std::cos(phase) * narrow;
    return SurfacePoint{{x, y + 0.03f * wave * below, depth * wave}, {1.6f * width * u, height * v}};
  });
}

/// Makes a cloth laid over the balustrade, whose rail is `rail` deep with its top around the origin: from behind the
/// rail over its top, out over the ledge (`ledge` = how far out and how far down), and straight down from there.
Mesh rail_banner(float width, float rail, vec2 ledge, float drop, std::uint32_t seed, const Detail& d) {
  constexpr float kBehind = 0.55f, kOff = 0.015f;  // metres behind the rail, and off the stone
  const float half = 0.5f * rail + kOff;
  const float total = kBehind + 2.0f * half + drop;
  return surface(d(40, 6), d(64, 12), [&](float u, float v) {
    const float s = total * (1.0f - v);  // along the cloth, from the hem behind
    vec3 p(width * (u - 0.5f), kOff, 0.0f);
    float loose = 0.0f, out = 0.0f;
    if (s < kBehind) {
      p = {p.x, s - kBehind + kOff, -half};
      loose = 0.25f * (1.0f - s / kBehind);
      out = -1.0f;
    } else if (s < kBehind + 2.0f * half) {
      p.z = s - kBehind - half;
    } else {
      const float down = s - kBehind - 2.0f * half;
      p = {p.x, kOff - down, half + (ledge.x - half) * glm::smoothstep(0.0f, 1.0f, down / ledge.y)};
      loose = glm::smoothstep(ledge.y, drop, down);
      out = 1.0f;
    }
    const float drift = 0.5f * noise::gradient({2.0f * u, s}, seed);
    const float wave = std::sin(2.0f * kPi * (3.2f * u + drift)) + 0.35f * std::sin(2.0f * kPi * (7.1f * u + 0.3f));
    p.z += out * loose * 0.05f * (1.3f + wave);
    p.x *= 1.0f - 0.07f * loose;
    p.y -= 0.025f * loose * wave;
    return SurfacePoint{p, {width * u, total * v}};
  });
}

// ------------------------------------------------------------------------------------------------------------ plants

Mesh pot(float radius, float height, const Detail& d) {
  const Points2 side = {{0.62f * radius, 0.0f},
                        {0.74f * radius, 0.35f * height},
                        {0.93f * radius, 0.8f * height},
                        {0.95f * radius, 0.86f * height}};
  const Points2 rim = {{1.0f * radius, 0.86f * height},  {1.06f * radius, 0.88f * height},
                       {1.08f * radius, 0.97f * height}, {1.04f * radius, height},
                       {0.95f * radius, height},         {0.92f * radius, 0.96f * height}};
  return lathe(join({{{0, 0}}, smooth(side, d(4)), smooth(rim, d(2)), {{0.9f * radius, 0.84f * height}}}), d(32, 10));
}

/// Makes fronds that rise from the origin and bow outwards.
Mesh fern(float size, int fronds, std::uint32_t seed, const Detail& d) {
  Mesh mesh;
  noise::Random random{noise::hash(seed)};
  for (int i = 0; i < fronds; ++i) {
    const float turn = 360.0f * (float(i) * 0.381966f) + random.between(-12.0f, 12.0f);
    const float steep = glm::radians(random.between(48.0f, 82.0f));
    const float length = size * random.between(0.75f, 1.1f), width = 0.26f * length;
    const float bow = random.between(1.5f, 2.4f), twist = random.between(-0.3f, 0.3f);
    Mesh blade = surface(d(2), d(8, 3), [&](float u, float v) {
      // The angle to the ground decreases linearly along the frond, which is integrated in closed form.
      const float end = steep - bow * v;
      const float out = length * (std::sin(steep) - std::sin(end)) / bow,
                  up = length * (std::cos(end) - std::cos(steep)) / bow;
      const float side = (0.5f - u) * width, cup = std::abs(u - 0.5f) * 0.5f * width;
      return SurfacePoint{{side, up + cup * std::cos(end) + twist * side * v, out - cup * std::sin(end)}, {u, v}};
    });
    append(mesh, turned_y(std::move(blade), turn));
  }
  return mesh;
}

/// Makes a crown of leaves scattered over and inside a lumpy sphere around the origin.
Mesh crown(float radius, int leaves, std::uint32_t seed, const Detail& d) {
  Mesh mesh;
  noise::Random random{noise::hash(seed)};
  for (int i = 0; i < leaves; ++i) {
    const float y = random.between(-0.85f, 1.0f), turn = 2.0f * kPi * random.next();
    const float flat = std::sqrt(1.0f - y * y);
    const vec3 out(flat * std::sin(turn), y, flat * std::cos(turn));
    const float lumps = 1.0f + 0.16f * noise::value(out * 3.0f, seed);
    const vec3 at = out * radius * lumps * std::pow(random.between(0.35f, 1.0f), 0.4f);
    const vec3 tip = glm::normalize(
        out + vec3(random.between(-0.8f, 0.8f), random.between(-0.9f, 0.4f), random.between(-0.8f, 0.8f)));
    const vec3 helper = std::abs(tip.y) < 0.9f ? vec3(0, 1, 0) : vec3(1, 0, 0);
    const vec3 across = glm::normalize(glm::cross(helper, tip)), over = glm::cross(tip, across);
    const float size = random.between(0.11f, 0.17f);
    append(mesh, surface(d(2), d(2), [&](float u, float v) {
             const float side = (u - 0.5f) * 0.55f * size;
             const vec3 bend = over * (0.25f * std::abs(side) - 0.25f * size * v * v);
             return SurfacePoint{at + side * across + v * size * tip + bend, {u, v}};
           }));
  }
  return mesh;
}

Mesh trunk(float height, const Detail& d) {
  const Points3 bones = {
      {0, -0.05f, 0}, {0.02f, 0.3f * height, 0.01f}, {-0.02f, 0.65f * height, 0.0f}, {0.01f, height, 0.01f}};
  const Points3 path = smooth(bones, d(4, 2));
  std::vector<float> scale;
  for (std::size_t i = 0; i < path.size(); ++i) scale.push_back(1.0f - 0.45f * float(i) / float(path.size() - 1));
  return tube(path, 0.045f, d(10, 5), false, scale);
}

// ---------------------------------------------------------------------------------------------------------- fountain

Points3 octagon(float radius, float y) {
  Points3 path;
  for (int i = 0; i < 8; ++i) {  // clockwise from above, so that a moulding faces outwards
    const float angle = 2.0f * kPi * (float(i) + 0.5f) / 8.0f;
    path.emplace_back(radius * std::sin(angle), y, radius * std::cos(angle));
  }
  return path;
}

void add_fountain(Scene& scene, const Materials& m, vec3 at, const Detail& d) {
  constexpr float kRadius = 1.55f;
  Mesh steps = moulding(octagon(kRadius + 0.35f, 0.0f),
                        join({{{0.0f, 0.0f}, {0.0f, 0.12f}}, {{0.0f, 0.12f}, {-0.6f, 0.12f}}}), true);
  const Points2 wall = join({{{0.10f, 0.12f}, {0.10f, 0.22f}},
                             arc({0.0f, 0.22f}, 0.06f, 0.0f, 90.0f, d(4, 2)),
                             {{0.0f, 0.56f}},
                             arc({0.0f, 0.62f}, 0.06f, -90.0f, 0.0f, d(4, 2)),
                             arc({0.06f, 0.69f}, 0.05f, -20.0f, 90.0f, d(4, 2)),
                             {{-0.26f, 0.74f}, {-0.26f, 0.74f}, {-0.26f, 0.12f}}});
  append(steps, moulding(octagon(kRadius, 0.0f), wall, true));
  const int id = add_mesh(scene, "fountain basin", moved(steps, at), m.stone);
  Mesh pool;
  const Points3 shore = octagon(kRadius - 0.2f, 0.58f);
  for (std::size_t i = 0; i < shore.size(); ++i) {
    const vec3 middle(0.0f, 0.58f, 0.0f);
    append(pool, quad(middle, shore[i], shore[(i + 1) % shore.size()], middle, 1, 1));
  }
  add_mesh(scene, "fountain water", moved(pool, at), m.water, id);
  const Points2 foot = {{0.42f, 0.30f}, {0.40f, 0.62f}, {0.22f, 0.74f}, {0.15f, 0.95f},
                        {0.19f, 1.12f}, {0.13f, 1.30f}, {0.20f, 1.42f}};
  const Points2 bowl = {{0.20f, 1.42f}, {0.45f, 1.47f}, {0.72f, 1.62f}, {0.80f, 1.74f}, {0.80f, 1.79f}, {0.75f, 1.80f}};
  const Points2 upper_foot = {{0.14f, 1.66f}, {0.09f, 1.80f}, {0.08f, 2.02f}, {0.12f, 2.10f}};
  const Points2 upper_bowl = {{0.12f, 2.10f}, {0.28f, 2.14f}, {0.40f, 2.24f}, {0.42f, 2.31f}, {0.39f, 2.33f}};
  const Points2 finial = {{0.06f, 2.22f}, {0.07f, 2.38f}, {0.035f, 2.44f}, {0.085f, 2.54f},
                          {0.10f, 2.62f}, {0.06f, 2.71f}, {0.015f, 2.78f}, {0.0f, 2.82f}};
  const int s = d(4, 2), turn = d(48, 12);
  Mesh tower = lathe(join({smooth(foot, s),
                           smooth(bowl, s),
                           {{0.70f, 1.70f}, {0.14f, 1.66f}},
                           smooth(upper_foot, s),
                           smooth(upper_bowl, s),
                           {{0.35f, 2.26f}, {0.06f, 2.22f}},
                           smooth(finial, s)}),
                     turn);
  add_mesh(scene, "fountain tower", moved(tower, at), m.stone, id);
  Mesh still = moved(lathe(Points2{{0.74f, 1.765f}, {0.09f, 1.765f}}, turn), at);
  append(still, moved(lathe(Points2{{0.38f, 2.305f}, {0.06f, 2.305f}}, turn), at));
  add_mesh(scene, "fountain bowls' water", std::move(still), m.water, id);
}

// ---------------------------------------------------------------------------------------------------------- the whole

constexpr float kKerb = kFloor + 0.2f;  // base of the balustrade
constexpr float kRailDepth = 0.30f, kRailOut = 0.12f;
constexpr float kString = 0.24f;  // projection of the string course
constexpr float kGalleryMiddle = 0.5f * (0.5f * kWall + kGallery);
constexpr float kGalleryHalf = 0.5f * (kGallery - 0.5f * kWall);

/// Meshes collected by material, for parts that are built bay by bay.
struct Parts {
  Mesh stone, blocks, plaster, vault, wood, door, iron, brass;
};

void add_lower_bay(Parts& parts, const Bay& bay, const Detail& d) {
  const auto add_part = [&bay](Mesh& to, Mesh mesh) { append(to, transformed(std::move(mesh), bay.place)); };
  add_part(parts.blocks, moved(arch(kOpening, kBay, kFloor - 0.05f - kSpring, kWall, d(24, 6)), {0, kSpring, 0}));
  add_part(parts.stone, archivolt(kSpring, d));
  add_part(parts.vault, moved(groin_vault({0.5f * kBay, kGalleryHalf}, 1.5f, d), {0, kSpring, -kGalleryMiddle}));
  const float height = kFloor - kStep;
  if (bay.index % 2 == 1) {
    constexpr float kDoor = 1.5f, kDoorSpring = 2.2f, kDepth = 0.25f;
    add_part(parts.plaster,
             moved(wall_with_arched_hole(kBay, height, kDoor, 0.0f, kDoorSpring, kDepth, d), {0, kStep, -kGallery}));
    add_part(parts.door, moved(arched_panel(kDoor, kDoorSpring, d), {0, kStep, -kGallery - 0.8f * kDepth}));
    for (const float x : {-0.36f, 0.36f})  // two leaves with two raised panels each
      for (const vec2 span : {vec2(0.15f, 0.95f), vec2(1.1f, 2.1f)})
        add_part(parts.door, box({x - 0.26f, kStep + span.x, -kGallery - 0.8f * kDepth},
                                 {x + 0.26f, kStep + span.y, -kGallery - 0.6f * kDepth}, 0.025f, d(1, 0)));
    add_part(parts.brass, moved(sphere(0.035f, d(12, 6), d(6, 4)), {0.06f, kStep + 1.02f, -kGallery - 0.55f * kDepth}));
    Points3 path;
    for (const vec2 p : arc({0, kStep + kDoorSpring}, 0.5f * kDoor + 0.09f, 0.0f, 180.0f, d(20, 6)))
      path.emplace_back(p.x, p.y, -kGallery);
    path.insert(path.begin(), vec3(0.5f * kDoor + 0.09f, kStep, -kGallery));
    path.push_back(vec3(-0.5f * kDoor - 0.09f, kStep, -kGallery));
    add_part(parts.stone, sweep(path, rectangle({0.18f, 0.12f}, 0.02f, d(1, 0)), {1, 0, 0}));
  } else {
    add_part(parts.plaster, quad({-0.5f * kBay, kStep, -kGallery}, {0.5f * kBay, kStep, -kGallery},
                                 {0.5f * kBay, kFloor, -kGallery}, {-0.5f * kBay, kFloor, -kGallery}, 1, 1));
    add_part(parts.stone,
             box({-0.95f, kStep, -kGallery}, {0.95f, kStep + 0.42f, -kGallery + 0.4f}, 0.03f, d(1, 0)));  // a bench
  }
}

void add_upper_bay(Parts& parts, const Bay& bay, const Detail& d) {
  const auto add_part = [&bay](Mesh& to, Mesh mesh) { append(to, transformed(std::move(mesh), bay.place)); };
  const float half = 0.5f * kBay;
  add_part(parts.plaster, moved(arch(kOpening, kBay, kTop - kSpringUpper, kWall, d(24, 6)), {0, kSpringUpper, 0}));
  add_part(parts.stone, archivolt(kSpringUpper, d));
  Mesh kerb = box({-half, kFloor - 0.05f, -0.5f * kWall}, {half, kKerb, 0.5f * kWall});
  add_part(parts.stone, std::move(kerb));
  // Balustrade: a foot, balusters, a rail, between the pedestals of the columns.
  const float end = half - 0.36f, deep = 0.5f * kRailDepth;
  add_part(parts.stone,
           box({-end, kKerb, kRailOut - 0.9f * deep}, {end, kKerb + 0.09f, kRailOut + 0.9f * deep}, 0.015f, d(1, 0)));
  add_part(parts.stone, box({-end, kRail - 0.13f, kRailOut - deep}, {end, kRail, kRailOut + deep}, 0.03f, d(1, 0)));
  const int balusters = std::min(d(16, 3), 9);  // more than nine would be too dense
  const Mesh single = baluster(kRail - 0.13f - kKerb - 0.09f, d);
  for (int i = 0; i < balusters; ++i)
    add_part(parts.stone,
             moved(single, {-end + 2.0f * end * (float(i) + 0.5f) / float(balusters), kKerb + 0.09f, kRailOut}));
  // The outer wall with a grilled window, and the wooden ceiling's beams.
  constexpr float kWindow = 1.2f, kSill = 0.9f, kWindowSpring = 2.6f, kDepth = 0.3f;
  const float height = kTop - kFloor;
  add_part(parts.plaster, moved(wall_with_arched_hole(kBay, height, kWindow, kSill, kWindowSpring, kDepth, d),
                                {0, kFloor, -kGallery}));
  add_part(parts.iron, moved(arched_panel(kWindow, kWindowSpring, d), {0, kFloor, -kGallery - 0.5f * kDepth}));
  add_part(parts.stone, box({-0.75f, kFloor + kSill - 0.12f, -kGallery - 0.02f},
                            {0.75f, kFloor + kSill, -kGallery + 0.1f}, 0.02f, d(1, 0)));
  for (const float x : {-1.0f, 0.0f, 1.0f})
    add_part(parts.wood, box({x - 0.09f, kTop - 0.24f, -kGallery - 0.02f}, {x + 0.09f, kTop, -0.5f * kWall + 0.02f},
                             0.012f, d(1, 0)));
}

/// Adds the square where two galleries meet, built for the corner at +x, +z.
void add_corner(Parts& parts, vec2 sign, const Detail& d) {
  const auto add_part = [&sign](Mesh& to, Mesh mesh) { append(to, scaled(std::move(mesh), {sign.x, 1, sign.y})); };
  const vec2 out = kCourt + vec2(kGallery), middle = kCourt + vec2(kGalleryMiddle);
  add_part(parts.stone, moved(pier(0.0f, kTop, d), {kCourt.x, 0, kCourt.y}));
  for (const float y : {kSpring, kSpringUpper}) add_part(parts.stone, moved(impost(y, d), {kCourt.x, 0, kCourt.y}));
  add_part(parts.vault, moved(groin_vault(vec2(kGalleryHalf), 1.5f, d), {middle.x, kSpring, middle.y}));
  for (const vec2 span : {vec2(kStep, kFloor), vec2(kFloor, kTop)}) {
    add_part(parts.plaster, quad({out.x, span.x, kCourt.y}, {out.x, span.x, out.y}, {out.x, span.y, out.y},
                                 {out.x, span.y, kCourt.y}, 1, 1));
    add_part(parts.plaster, quad({out.x, span.x, out.y}, {kCourt.x, span.x, out.y}, {kCourt.x, span.y, out.y},
                                 {out.x, span.y, out.y}, 1, 1));
  }
}

/// Adds the arch across the gallery behind a column or pier, and the pilaster that carries its other end.
void add_transverse_arch(Parts& parts, const mat4& place, float width, const Detail& d) {
  Mesh span = turned_y(arch(2.0f * kGalleryHalf - 0.3f, 2.0f * kGalleryHalf, 1.7f, width, d(20, 6)), 90.0f);
  append(parts.blocks, transformed(moved(std::move(span), {0, kSpring, -kGalleryMiddle}), place));
  const float half = 0.5f * width + 0.03f;
  Mesh pilaster = box({-half, kStep, -kGallery - 0.02f}, {half, kSpring, -kGallery + 0.18f}, 0.02f, d(1, 0));
  append(pilaster, box({-half - 0.06f, kSpring - 0.16f, -kGallery - 0.02f}, {half + 0.06f, kSpring, -kGallery + 0.25f},
                       0.02f, d(1, 0)));
  append(pilaster, box({-half - 0.05f, kStep, -kGallery - 0.02f}, {half + 0.05f, kStep + 0.3f, -kGallery + 0.23f},
                       0.02f, d(1, 0)));
  append(parts.stone, transformed(std::move(pilaster), place));
}

void add_floors(Scene& scene, const Materials& m, const Detail& d) {
  const vec2 step = kCourt - vec2(0.6f), out = kCourt + vec2(kGallery + 0.3f);  // into the walls, under the doors
  Mesh court = plane(-step, step, 0.0f, d(8), d(16));
  scale_uvs(court, vec2(0.5f));
  add_mesh(scene, "court floor", std::move(court), m.court);
  const Points2 nosing = join({{{0.0f, 0.0f}, {0.0f, kStep - 0.05f}},
                               arc({0.02f, kStep - 0.025f}, 0.025f, -90.0f, 90.0f, d(4, 2)),
                               {{-0.35f, kStep}}});
  add_mesh(scene, "step", moulding(ring(step, 0.0f, false), nosing, true), m.stone);
  Mesh floors, ceiling;
  const auto add_ring = [&out](Mesh& mesh, vec2 in, float y) {
    for (const float side : {-1.0f, 1.0f}) {
      const float x0 = side < 0.0f ? -out.x : in.x, z0 = side < 0.0f ? -out.y : in.y;
      append(mesh, plane({x0, -out.y}, {x0 + out.x - in.x, out.y}, y, 1, 1));
      append(mesh, plane({-in.x, z0}, {in.x, z0 + out.y - in.y}, y, 1, 1));
    }
  };
  add_ring(floors, step + vec2(0.35f), kStep);
  add_ring(floors, kCourt + vec2(0.5f * kWall), kFloor);
  scale_uvs(floors, vec2(1.0f / 1.2f));
  add_mesh(scene, "gallery floors", std::move(floors), m.tiles);
  add_ring(ceiling, kCourt, kTop - 0.02f);
  scale_uvs(ceiling, vec2(0.4f));
  add_mesh(scene, "upper ceiling", flipped(std::move(ceiling)), m.wood);
}

/// Adds the string course between the storeys, the main cornice with dentils, and the roof.
void add_cornices(Scene& scene, const Materials& m, const Detail& d) {
  const vec2 face = kCourt - vec2(0.5f * kWall);
  const int n = d(5, 2);
  const Points2 course =
      join({{{0.0f, -0.32f}, {0.05f, -0.32f}, {0.05f, -0.32f}, {0.05f, -0.2f}},
            arc({0.15f, -0.2f}, 0.10f, 180.0f, 90.0f, n),
            {{0.21f, -0.10f}, {kString, -0.08f}, {kString, -0.08f}, {kString, 0.0f}, {kString, 0.0f}, {0.0f, 0.02f}}});
  add_mesh(scene, "string course", moulding(ring(face, kKerb, false), course, true), m.stone);
  const Points2 cornice = join({{{0.0f, -0.55f}, {0.04f, -0.55f}, {0.04f, -0.55f}, {0.04f, -0.45f}},
                                arc({0.04f, -0.38f}, 0.07f, -90.0f, 0.0f, n),
                                {{0.11f, -0.20f},
                                 {0.11f, -0.20f},
                                 {0.32f, -0.20f},
                                 {0.32f, -0.20f},
                                 {0.32f, -0.09f},
                                 {0.32f, -0.09f},
                                 {0.35f, -0.07f}},
                                arc({0.35f, 0.03f}, 0.10f, -90.0f, 0.0f, n),
                                {{0.45f, 0.06f}}});
  const int id = add_mesh(scene, "cornice", moulding(ring(face, kEaves, false), cornice, true), m.stone);
  Mesh dentils;
  constexpr float kPitch = 0.25f;
  const Mesh dentil = box({-0.07f, kEaves - 0.33f, -0.02f}, {0.07f, kEaves - 0.20f, 0.10f});
  const auto row = [&](vec3 from, vec3 to, float turn_deg) {
    const int count = int(glm::length(to - from) / kPitch);
    for (int i = 0; i < count; ++i)
      append(dentils, moved(turned_y(dentil, turn_deg), from + (to - from) * ((float(i) + 0.5f) / float(count))));
  };
  const float in = 0.11f;  // dentils are on the band under the corona
  const vec2 f = face - vec2(in);
  row({-f.x, 0, -f.y}, {f.x, 0, -f.y}, 0.0f);
  row({f.x, 0, f.y}, {-f.x, 0, f.y}, 180.0f);
  row({-f.x, 0, f.y}, {-f.x, 0, -f.y}, 90.0f);
  row({f.x, 0, -f.y}, {f.x, 0, f.y}, -90.0f);
  add_mesh(scene, "dentils", std::move(dentils), m.stone, id);

  // Half-round tiles in rows up the slope; rows beyond the court's corner start on the hip.
  constexpr float kTile = 0.24f, kTileHeight = 0.055f, kSlope = 0.42f;
  const vec2 eaves = face - vec2(0.52f);
  const float run = kCourt.x + kGallery + 0.4f - eaves.x;
  Mesh roof;
  const auto slope = [&](float in_half, float eave, float turn_deg) {
    const float half = in_half + run;
    const int rows = int(2.0f * half / kTile);
    Mesh sheet = surface(rows * d(6, 3), 1, [&](float u, float v) {
      const float along = -half + 2.0f * half * u;
      const float from = std::max((std::abs(along) - in_half) / run, 0.0f);
      const float t = from + (1.0f - from) * v;
      const float wave = std::abs(std::sin(kPi * float(rows) * u));
      const float y = kEaves + 0.02f + kSlope * run * t + kTileHeight * wave;
      return SurfacePoint{{along, y, -(eave + run * t)}, {along, run * t}};
    });
    append(roof, turned_y(std::move(sheet), turn_deg));
  };
  slope(eaves.x, eaves.y, 0.0f);
  slope(eaves.x, eaves.y, 180.0f);
  slope(eaves.y, eaves.x, 90.0f);
  slope(eaves.y, eaves.x, -90.0f);
  add_mesh(scene, "roof", std::move(roof), m.roof);
}

void add_cloths(Scene& scene, const Materials& m, const std::vector<Bay>& bays, const Detail& d) {
  constexpr float kRodRadius = 0.022f, kTieDrop = 2.0f;
  for (const Bay& bay : bays) {
    const std::uint32_t seed = std::uint32_t(bay.side * 16 + bay.index);
    const int colour = (bay.index / 2 + bay.side) % 3;
    const auto curtain = [&](float rod, float foot, float z, const char* name) {
      const float half = 0.5f * kOpening, height = rod - foot;
      Mesh pair = moved(tied_curtain(half + 0.03f, height, kTieDrop * height / 3.2f, seed, d), {-half + 0.02f, rod, z});
      append(pair, scaled(moved(tied_curtain(half + 0.03f, height, kTieDrop * height / 3.2f, seed + 1000u, d),
                                {-half + 0.02f, rod, z}),
                          {-1, 1, 1}));
      scale_uvs(pair, vec2(1.1f));
      const int id = add_mesh(scene, name, transformed(std::move(pair), bay.place), m.cloth[std::size_t(colour)]);
      const Points3 rod_line = {{-half - 0.02f, rod, z}, {half + 0.02f, rod, z}};
      Mesh metal = tube(rod_line, kRodRadius, d(10, 5));
      for (const float x : {-1.0f, 1.0f})  // the ties
        append(metal,
               transformed(
                   torus(0.17f, 0.022f, d(20, 8), d(6, 4)),
                   glm::scale(glm::translate(mat4(1.0f), vec3(x * (half - 0.13f), rod - kTieDrop * height / 3.2f, z)),
                              vec3(1.0f, 1.0f, 0.65f))));
      add_mesh(scene, std::string(name) + " rod", transformed(std::move(metal), bay.place), m.brass, id);
    };
    const bool long_side = bay.side < 2;
    if (long_side && bay.index % 2 == (bay.side == 0 ? 0 : 1)) curtain(kSpring - 0.08f, kStep + 0.02f, 0.0f, "curtain");
    if (!long_side && bay.index != 1) curtain(kSpring - 0.08f, kStep + 0.02f, 0.0f, "curtain");
    if (long_side && bay.index % 2 == (bay.side == 0 ? 1 : 0)) {
      Mesh banner =
          moved(rail_banner(1.25f, kRailDepth, {0.5f * kWall + kString + 0.03f - kRailOut, kRail - kKerb + 0.02f},
                            2.35f, seed, d),
                {0, kRail, kRailOut});
      add_mesh(scene, "banner", transformed(std::move(banner), bay.place), m.cloth[std::size_t((colour + 1) % 3)]);
    }
    if (long_side ? bay.index % 2 == (bay.side == 0 ? 0 : 1) : bay.index == 1)
      curtain(kSpringUpper - 0.08f, kFloor + 0.02f, -0.14f, "upper curtain");
  }
}

void add_lamps(Scene& scene, const Materials& m, const std::vector<Bay>& bays, const Detail& d) {
  constexpr float kGlass = kGlassHeight;
  for (const Bay& bay : bays) {
    if (bay.side >= 2 || bay.index % 2 != (bay.side == 0 ? 1 : 0)) continue;
    const Points2 cap = {
        {0.13f, kGlass + 0.15f}, {0.11f, kGlass + 0.19f}, {0.04f, kGlass + 0.27f}, {0.012f, kGlass + 0.34f}};
    const Points2 foot = {
        {0.02f, kGlass - 0.24f}, {0.035f, kGlass - 0.20f}, {0.08f, kGlass - 0.17f}, {0.11f, kGlass - 0.13f}};
    Mesh metal = lathe(join({{{0.0f, kGlass - 0.25f}}, smooth(foot, d(3)), {{0.0f, kGlass - 0.125f}}}), d(16, 8));
    append(metal, lathe(join({{{0.0f, kGlass + 0.145f}}, smooth(cap, d(3)), {{0.0f, kGlass + 0.345f}}}), d(16, 8)));
    const float top = kSpring + 0.5f * kOpening + 0.02f;
    append(metal, moved(cylinder(0.01f, top - kGlass - 0.33f, d(6, 4)), {0, kGlass + 0.33f, 0}));
    for (int i = 0; i < 6; ++i) {
      const float turn = kPi * float(i) / 3.0f;
      append(metal, moved(cylinder(0.008f, 0.28f, d(6, 4)),
                          {0.105f * std::sin(turn), kGlass - 0.13f, 0.105f * std::cos(turn)}));
    }
    const int id = add_mesh(scene, "lantern", transformed(std::move(metal), bay.place), m.brass);
    Mesh glass = moved(cylinder(0.09f, 0.26f, d(16, 8)), {0, kGlass - 0.12f, 0});
    const auto burning = std::find_if(kBurning.begin(), kBurning.end(), [&](const Lantern& lantern) {
      return lantern.side == bay.side && lantern.index == bay.index;
    });
    add_mesh(scene, "lantern glass", transformed(std::move(glass), bay.place),
             burning == kBurning.end() ? m.unlit : m.glow[std::size_t(burning->glass)], id);
  }
}

void add_plants(Scene& scene, const Materials& m, const Detail& d) {
  std::uint32_t seed = 40;
  for (const float z : {-9.0f, -6.0f, 0.0f, 3.0f, 6.0f})
    for (const float x : {-3.35f, 3.35f}) {
      const float size = 0.9f + 0.25f * noise::unit(noise::hash(seed));
      constexpr float kHeight = 0.55f;
      const int id = add_mesh(scene, "pot", moved(pot(0.34f, kHeight, d), {x, 0, z}), m.terracotta);
      add_mesh(scene, "pot soil",
               moved(lathe(Points2{{0.312f, kHeight - 0.06f}, {0.0f, kHeight - 0.05f}}, d(24, 8)), {x, 0, z}), m.soil,
               id);
      add_mesh(scene, "fern", moved(fern(size, 22, seed, d), {x, kHeight - 0.07f, z}), m.frond);
      ++seed;
    }
  for (const vec2 at : {vec2(-2.9f, -4.6f), vec2(2.9f, -4.6f), vec2(-2.9f, 1.4f), vec2(2.9f, 1.4f)}) {
    constexpr float kHalf = 0.38f, kHigh = 0.62f, kTrunk = 1.25f, kCrown = 0.72f;
    const vec3 foot(at.x, 0.0f, at.y);
    Mesh tub = box({-kHalf, 0.06f, -kHalf}, {kHalf, kHigh - 0.03f, kHalf}, 0.015f, d(1, 0));
    const Points2 rim = {{0.0f, -0.1f}, {0.05f, -0.1f}, {0.05f, 0.0f}, {-0.06f, 0.0f}, {-0.06f, -0.1f}};
    append(tub, moulding(ring(vec2(kHalf), kHigh, true), sharp(rim), true));
    for (const float x : {-1.0f, 1.0f})
      for (const float z : {-1.0f, 1.0f}) {
        append(tub, moved(sphere(0.075f, d(12, 6), d(8, 4)), {x * (kHalf - 0.04f), 0.07f, z * (kHalf - 0.04f)}));
        append(tub, moved(sphere(0.06f, d(12, 6), d(8, 4)), {x * (kHalf + 0.0f), kHigh + 0.05f, z * (kHalf + 0.0f)}));
      }
    const int id = add_mesh(scene, "tub", moved(tub, foot), m.door);
    add_mesh(scene, "tub soil",
             moved(plane({-kHalf + 0.02f, -kHalf + 0.02f}, {kHalf - 0.02f, kHalf - 0.02f}, kHigh - 0.02f, 1, 1), foot),
             m.soil, id);
    const int tree = add_mesh(scene, "tree trunk", moved(trunk(kTrunk, d), foot + vec3(0, kHigh - 0.02f, 0)), m.bark);
    add_mesh(scene, "tree crown", moved(crown(kCrown, d(900, 120), seed, d), foot + vec3(0, kHigh + kTrunk + 0.45f, 0)),
             m.leaf, tree);
    ++seed;
  }
}

Scene build(const Materials& m, const Detail& d) {
  Scene scene;
  const std::vector<Bay> bays = all_bays();
  add_floors(scene, m, d);
  Parts parts;
  for (const Bay& bay : bays) {
    add_lower_bay(parts, bay, d);
    add_upper_bay(parts, bay, d);
  }
  for (const vec2 sign : {vec2(1, 1), vec2(-1, 1), vec2(1, -1), vec2(-1, -1)}) add_corner(parts, sign, d);

  const Mesh lower = moved(column(kSpring - kStep, 0.30f, 0, d), {0, kStep, 0});
  const Mesh upper = moved(column(kSpringUpper - kRail, 0.235f, 16, d), {0, kRail, 0});
  const Mesh pedestal = box({-0.38f, kKerb, -0.34f}, {0.38f, kRail, 0.34f}, 0.03f, d(1, 0));
  const Mesh boss = moved(rosette(0.34f, d), {0, kSpring + 1.08f, 0.5f * kWall - 0.005f});
  for (const mat4& place : column_places()) {
    const int id = add_mesh(scene, "lower column", transformed(lower, place), m.stone);
    add_mesh(scene, "upper column", transformed(upper, place), m.stone);
    add_mesh(scene, "pedestal", transformed(pedestal, place), m.stone);
    add_mesh(scene, "rosette", transformed(boss, place), m.stone, id);
    add_transverse_arch(parts, place, 0.45f, d);
  }
  for (const float x : {-1.0f, 1.0f})
    for (const float z : {-1.0f, 1.0f})
      for (const float turn : {x < 0.0f ? 90.0f : -90.0f, z < 0.0f ? 0.0f : 180.0f}) {
        const mat4 at = glm::translate(mat4(1.0f), vec3(x * kCourt.x, 0.0f, z * kCourt.y));
        add_transverse_arch(parts, glm::rotate(at, glm::radians(turn), vec3(0, 1, 0)), kWall + 0.04f, d);
      }

  // Texture repeats, in metres: 2 m of blocks and plaster, 1.6 m of stone, 1 m of planks.
  for (Mesh* mesh : {&parts.blocks, &parts.plaster}) scale_uvs(*mesh, vec2(0.5f));
  scale_uvs(parts.stone, vec2(0.6f));
  scale_uvs(parts.vault, vec2(0.33f));
  for (vec2& uv : parts.door.uvs) uv = {uv.y, uv.x};  // boards are vertical
  add_mesh(scene, "arch walls", std::move(parts.blocks), m.blocks);
  add_mesh(scene, "mouldings and balustrade", std::move(parts.stone), m.stone);
  add_mesh(scene, "plaster walls", std::move(parts.plaster), m.plaster);
  add_mesh(scene, "vaults", std::move(parts.vault), m.vault);
  add_mesh(scene, "beams", std::move(parts.wood), m.wood);
  add_mesh(scene, "doors", std::move(parts.door), m.door);
  add_mesh(scene, "window grilles", std::move(parts.iron), m.iron);
  add_mesh(scene, "door knobs", std::move(parts.brass), m.brass);

  add_cornices(scene, m, d);
  add_cloths(scene, m, bays, d);
  add_lamps(scene, m, bays, d);
  add_plants(scene, m, d);
  add_fountain(scene, m, {0.0f, 0.0f, -1.6f}, d);
  return scene;
}

/// Returns the lights of the lanterns.
std::vector<Light> lantern_lights() {
  std::vector<Light> lights;
  for (const Bay& bay : all_bays())
    for (const Lantern& lantern : kBurning) {
      if (lantern.side != bay.side || lantern.index != bay.index) continue;
      lights.push_back({.kind = LightKind::kPoint,
                        .position = vec3(bay.place * glm::vec4(0.0f, kGlassHeight - kFlameDrop, 0.0f, 1.0f)),
                        .color = kLanternLight * kGlassColour[std::size_t(lantern.glass)],
                        .reach = kLanternReach,
                        .radius = kFlameRadius,
                        .casts_shadow = true});
    }
  return lights;
}

}  // namespace

Scene make_atrium(int triangles) {
  Scene scene = build_with_materials("atrium", triangles, add_materials, build);
  // A high sun from behind the camera's right shoulder: it lights the left side, the far end and part of the floor.
  // The last light represents the light reflected by lit walls, and is as wide as they are.
  scene.lights = {{.direction = glm::normalize(vec3(0.41f, 0.84f, 0.36f)),
                   .color = {1.12f, 1.00f, 0.80f},
                   .angle_deg = kSunAngleDeg,
                   .casts_shadow = true}};
  for (const Light& light : lantern_lights()) scene.lights.push_back(light);
  scene.lights.push_back({.direction = glm::normalize(vec3(-0.7f, 0.35f, 0.4f)),
                          .color = {0.10f, 0.085f, 0.07f},
                          .angle_deg = kFillAngleDeg});
  scene.ambient = {0.28f, 0.31f, 0.36f};
  scene.views = {{.eye = {1.3f, 2.4f, 10.6f}, .target = {-0.35f, 3.7f, -6.0f}, .angle_deg = 60.0f},
                 {.eye = {-2.6f, 1.6f, 6.5f}, .target = {3.2f, 1.5f, 0.5f}, .angle_deg = 55.0f}};
  return scene;
}

}  // namespace umbrage
