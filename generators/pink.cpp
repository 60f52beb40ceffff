// scene:pink - a round pink sprite with coral frills and large red feet on a disc of meadow: smooth blends, soft
// contacts and clear silhouettes. It replaces the figures of the toon shading paper; the character is our own.
#include <algorithm>
#include <array>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "generators/makers.h"
#include "generators/sdf_mesh.h"
#include "generators/shapes.h"

namespace umbrage {

namespace {

using glm::vec3;
using shapes::Detail;

/// Edge length of the implicit surfaces' triangles at scale 1, metres.
constexpr float kCell = 0.017f;

/// Below this scale the triangles are not enlarged further, because the grid would miss fingers and petals.
constexpr float kMinScale = 0.3f;

struct Palette {
  int skin, belly, frill, foot, sole, eye, iris, shine, blush, mouth, tongue, leaf, stem;
  int grass, blade, earth, stone, cap, dot, stalk, petal, pollen;
};

Palette add_palette(Scene& scene) {
  const shapes::MaterialMaker make{scene};
  Palette p;
  p.skin = make.plain("skin", {0.90f, 0.36f, 0.47f}, 0.10f, 20.0f);
  p.belly = make.plain("belly", {0.95f, 0.64f, 0.56f});
  p.frill = make.plain("frill", {0.76f, 0.11f, 0.20f}, 0.15f, 24.0f);
  p.foot = make.plain("foot", {0.66f, 0.045f, 0.06f}, 0.30f, 40.0f);
  p.sole = make.plain("sole", {0.36f, 0.03f, 0.045f});
  p.eye = make.plain("eye", {0.020f, 0.022f, 0.055f}, 0.50f, 90.0f);
  p.iris = make.plain("iris", {0.03f, 0.26f, 0.36f});
  p.shine = make.plain("shine", {0.95f, 0.96f, 1.0f});
  p.blush = make.plain("blush", {0.86f, 0.17f, 0.27f});
  p.mouth = make.plain("mouth", {0.23f, 0.016f, 0.03f});
  p.tongue = make.plain("tongue", {0.80f, 0.17f, 0.20f});
  p.leaf = make.plain("leaf", {0.20f, 0.52f, 0.09f}, 0.12f, 30.0f);
  p.stem = make.plain("stem", {0.16f, 0.36f, 0.08f});
  p.grass = make.plain("grass", {0.30f, 0.55f, 0.13f});
  p.blade = make.plain("blade", {0.20f, 0.45f, 0.09f});
  p.earth = make.plain("earth", {0.33f, 0.19f, 0.10f});
  p.stone = make.plain("stone", {0.46f, 0.45f, 0.44f});
  p.cap = make.plain("cap", {0.78f, 0.20f, 0.06f}, 0.25f, 50.0f);
  p.dot = make.plain("dot", {0.90f, 0.84f, 0.70f});
  p.stalk = make.plain("stalk", {0.82f, 0.73f, 0.57f});
  p.petal = make.plain("petal", {0.86f, 0.84f, 0.90f});
  p.pollen = make.plain("pollen", {0.90f, 0.58f, 0.06f});
  return p;
}

struct Maker {
  Scene scene;
  Detail detail;
  Palette paint;

  /// Adds an implicit surface. `cell_factor` is the edge length of its triangles relative to the default.
  int add(const char* name, int material, const sdf::Field& field, vec3 low, vec3 high, float cell_factor = 1.0f,
          int part_of = -1) {
    return shapes::add_mesh(scene, name,
                            sdf::mesh(field, low, high, kCell * cell_factor / std::max(detail.scale, kMinScale)),
                            material, part_of);
  }
};

glm::mat3 turn(float angle_deg, vec3 axis) {
  return glm::mat3(glm::rotate(glm::mat4(1.0f), glm::radians(angle_deg), axis));
}

/// Returns the field of the body without mouth: a pear of two spheres, two short arms with three fingers each, one
/// waving, and a tail.
float skin_field(vec3 p) {
  const float lower = sdf::ellipsoid(p, {0.0f, 0.55f, 0.0f}, {0.47f, 0.36f, 0.43f});
  const float upper = sdf::ellipsoid(p, {0.0f, 0.80f, 0.0f}, {0.42f, 0.34f, 0.39f});
  float d = sdf::join(lower, upper, 0.25f);
  struct Arm {
    vec3 shoulder, hand, side;
  };
  static const Arm kArms[] = {{{0.36f, 0.66f, 0.06f}, {0.61f, 0.84f, 0.16f}, {-0.6f, 0.8f, 0.0f}},
                              {{-0.38f, 0.60f, 0.08f}, {-0.52f, 0.44f, 0.22f}, {0.55f, -0.6f, 0.6f}}};
  for (const Arm& arm : kArms) {
    const float near = sdf::ball(p, arm.hand, 0.30f);
    if (near > d + 0.3f) continue;
    float limb = sdf::bar(p, arm.shoulder, arm.hand, 0.125f, 0.105f);
    const vec3 out = glm::normalize(arm.hand - arm.shoulder);
    for (int i = -1; i <= 1; ++i) {
      const vec3 tip = arm.hand + 0.085f * out + 0.082f * float(i) * arm.side - 0.012f * float(i * i) * out;
      limb = sdf::join(limb, sdf::ball(p, tip, 0.046f), 0.020f);
    }
    d = sdf::join(d, limb, 0.12f);
  }
  const float tail = sdf::bar(p, {0.0f, 0.42f, -0.34f}, {0.05f, 0.36f, -0.62f}, 0.14f, 0.05f);
  return sdf::join(d, tail, 0.14f);
}

/// Returns the point of the skin in front at (x, y).
vec3 on_face(float x, float y) {
  vec3 p(x, y, 0.7f);
  for (int i = 0; i < 40; ++i) p.z -= skin_field(p);
  return p;
}

/// Returns the axes at a point of the skin: the third column points out of the body.
glm::mat3 skin_axes(vec3 p) {
  constexpr float kStep = 1e-3f;
  const auto slope = [&](vec3 axis) { return skin_field(p + kStep * axis) - skin_field(p - kStep * axis); };
  const vec3 out = glm::normalize(vec3(slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})));
  const vec3 right = glm::normalize(glm::cross(vec3(0, 1, 0), out));
  return {right, glm::cross(out, right), out};
}

/// Height of the upper lip's centre.
constexpr float kLipHeight = 0.665f;

/// Returns the field of a laughing mouth around the lip: a half moon, enlarged by `grow`. q is relative to the lip.
float mouth_field(vec3 q, float grow) {
  const float moon = sdf::ellipsoid(q, vec3(0.0f, 0.01f, 0.0f), {0.150f + grow, 0.125f + grow, 0.15f + grow});
  // The upper lip sags in the middle and lifts at the corners.
  const float lip = q.y - (1.5f * q.x * q.x) - grow;
  return sdf::overlap(moon, 0.92f * lip, 0.025f);
}

void add_face(Maker& m, int body) {
  for (const float side : {-1.0f, 1.0f}) {
    const vec3 at = on_face(side * 0.190f, 0.820f);
    const glm::mat3 axes = skin_axes(at), inverse = glm::transpose(axes);
    const auto spot = [&](float right, float up, vec3 radii, float out) {
      const vec3 centre = at + axes * vec3(right, up, out);
      return [=](vec3 p) { return sdf::ellipsoid(inverse * (p - centre), vec3(0.0f), radii); };
    };
    const vec3 reach(0.14f);
    const auto ball = spot(0.0f, 0.0f, {0.072f, 0.090f, 0.042f}, 0.0f);
    const int eye = m.add(side < 0 ? "right eye" : "left eye", m.paint.eye, ball, at - reach, at + reach, 0.6f);
    const auto lower = spot(0.0f, -0.052f, {0.050f, 0.036f, 0.06f}, 0.02f);
    m.add(
        "iris", m.paint.iris, [=](vec3 p) { return sdf::overlap(ball(p) - 0.0025f, lower(p), 0.004f); }, at - reach,
        at + reach, 0.35f, eye);
    m.add("shine", m.paint.shine, spot(-0.022f, 0.036f, {0.025f, 0.029f, 0.012f}, 0.034f), at - reach, at + reach,
          0.35f, eye);
    m.add("shine", m.paint.shine, spot(0.030f, -0.028f, {0.011f, 0.012f, 0.008f}, 0.036f), at - reach, at + reach,
          0.25f, eye);
    const vec3 cheek = on_face(side * 0.300f, 0.665f);
    const glm::mat3 cheek_inverse = glm::transpose(skin_axes(cheek));
    m.add(
        "blush", m.paint.blush,
        [=](vec3 p) {
          const float patch = sdf::ellipsoid(cheek_inverse * (p - cheek), vec3(0.0f), {0.066f, 0.040f, 0.08f});
          return sdf::overlap(skin_field(p) - 0.005f, patch, 0.01f);
        },
        cheek - 0.1f, cheek + 0.1f, 0.3f, body);
  }
  const vec3 lip = on_face(0.0f, kLipHeight);
  const vec3 low = lip - vec3(0.20f, 0.17f, 0.2f), high = lip + vec3(0.20f, 0.10f, 0.06f);
  m.add(
      "mouth", m.paint.mouth,
      [=](vec3 p) {
        const float lining = sdf::cut(mouth_field(p - lip, 0.030f), mouth_field(p - lip, 0.0f), 0.004f);
        return sdf::overlap(lining, skin_field(p) + 0.004f, 0.008f);
      },
      low, high, 0.45f);
  m.add(
      "tongue", m.paint.tongue,
      [=](vec3 p) {
        const vec3 q = p - lip;
        const float halves = sdf::join(sdf::ellipsoid(q, {-0.034f, -0.105f, -0.080f}, {0.058f, 0.045f, 0.065f}),
                                       sdf::ellipsoid(q, {0.034f, -0.105f, -0.080f}, {0.058f, 0.045f, 0.065f}), 0.02f);
        return sdf::overlap(sdf::overlap(halves, mouth_field(q, 0.015f), 0.01f), skin_field(p) + 0.012f, 0.02f);
      },
      low, high, 0.45f);
}

void add_foot(Maker& m, float side) {
  const glm::mat3 axes = turn(side * 24.0f, {0, 1, 0}), inverse = glm::transpose(axes);
  const vec3 ankle(side * 0.235f, 0.0f, 0.06f);
  const auto foot = [=](vec3 p) {
    const vec3 q = inverse * (p - ankle);
    const float toes = sdf::ellipsoid(q, {0.0f, 0.125f, 0.13f}, {0.175f, 0.145f, 0.19f});
    const float heel = sdf::ellipsoid(q, {0.0f, 0.13f, -0.06f}, {0.135f, 0.15f, 0.15f});
    return sdf::overlap(sdf::join(toes, heel, 0.10f), 0.02f - q.y, 0.05f);
  };
  const vec3 low = ankle + vec3(-0.3f, -0.02f, -0.3f), high = ankle + vec3(0.3f, 0.32f, 0.4f);
  const int object = m.add(side < 0 ? "right foot" : "left foot", m.paint.foot, foot, low, high, 0.9f);
  m.add(
      "sole", m.paint.sole,
      [=](vec3 p) { return sdf::overlap(foot(p) - 0.012f, std::abs(p.y - 0.022f) - 0.034f, 0.03f); }, low, high, 0.7f,
      object);
}

/// Adds three frills per side, like those of an axolotl; the middle one is the longest.
void add_frills(Maker& m, float side) {
  const std::array<vec3, 3> roots = {vec3(0.34f, 0.95f, -0.08f), vec3(0.39f, 0.82f, -0.12f),
                                     vec3(0.40f, 0.69f, -0.17f)};
  const std::array<vec3, 3> tips = {vec3(0.56f, 1.22f, -0.16f), vec3(0.72f, 0.98f, -0.24f), vec3(0.70f, 0.70f, -0.34f)};
  const vec3 mirror(side, 1.0f, 1.0f);
  for (std::size_t i = 0; i < roots.size(); ++i) {
    const vec3 root = roots[i] * mirror, tip = tips[i] * mirror, middle = 0.5f * (root + tip) + vec3(0, 0.03f, 0);
    const vec3 across = glm::normalize(glm::cross(tip - root, vec3(0, 0, 1)));
    m.add(
        "frill", m.paint.frill,
        [=](vec3 p) {
          float d =
              sdf::join(sdf::bar(p, root, middle, 0.056f, 0.048f), sdf::bar(p, middle, tip, 0.048f, 0.030f), 0.03f);
          // Fringes along both edges.
          for (int k = 0; k < 4; ++k)
            for (const float s : {-1.0f, 1.0f}) {
              const float t = 0.38f + 0.20f * float(k);
              const vec3 on = glm::mix(root, tip, t) + vec3(0, 0.12f * t * (1 - t), 0);
              const vec3 end = on + s * (0.088f - 0.010f * float(k)) * across + 0.045f * glm::normalize(tip - root);
              d = sdf::join(d, sdf::bar(p, on, end, 0.024f, 0.018f), 0.02f);
            }
          return d;
        },
        glm::min(root, tip) - 0.12f, glm::max(root, tip) + 0.12f, 0.6f);
  }
}

/// Adds a sprout on the head: a bent stem and two leaves, each a curved lens with a rib.
void add_sprout(Maker& m) {
  const vec3 root(0.0f, 1.12f, 0.0f), fork(0.03f, 1.30f, 0.0f);
  m.add(
      "stem", m.paint.stem,
      [=](vec3 p) {
        const vec3 bend(-0.02f, 1.21f, 0.0f);
        return sdf::join(sdf::bar(p, root, bend, 0.032f, 0.024f), sdf::bar(p, bend, fork, 0.024f, 0.026f), 0.02f);
      },
      root - 0.06f, fork + 0.06f, 0.5f);
  struct Leaf {
    float yaw_deg, rise_deg, length;
  };
  for (const Leaf& leaf : {Leaf{-18.0f, 24.0f, 0.30f}, Leaf{158.0f, 42.0f, 0.24f}}) {
    const glm::mat3 axes = turn(leaf.yaw_deg, {0, 1, 0}) * turn(leaf.rise_deg, {0, 0, 1});
    const glm::mat3 inverse = glm::transpose(axes);
    const vec3 centre = fork + axes * vec3(0.5f * leaf.length - 0.01f, 0.0f, 0.0f);
    const float half = 0.5f * leaf.length;
    m.add(
        "leaf", m.paint.leaf,
        [=](vec3 p) {
          vec3 q = inverse * (p - centre);
          const float u = q.x / half;
          q.y += 0.30f * q.x * q.x / half - 0.9f * q.z * q.z / half * 0.8f;
          // The lens narrows with u, so that the leaf is pointed at its tip.
          const float width = 0.52f * half * (1.0f - 0.25f * u);
          float d = 0.7f * sdf::ellipsoid(q, vec3(0.0f), {half, 0.028f, width});
          const float groove = sdf::bar(q, {-half, 0.034f, 0.0f}, {0.8f * half, 0.034f, 0.0f}, 0.014f, 0.010f);
          return sdf::cut(d, groove, 0.012f);
        },
        centre - (half + 0.08f), centre + (half + 0.08f), 0.4f);
  }
}

void add_figure(Maker& m) {
  const vec3 lip = on_face(0.0f, kLipHeight);
  const int body = m.add("body", m.paint.skin,
                         [=](vec3 p) {
                           const float d = skin_field(p);
                           return glm::distance(p, lip) < 0.5f ? sdf::cut(d, mouth_field(p - lip, 0.015f), 0.025f) : d;
                         },
                         {-0.70f, 0.17f, -0.70f}, {0.80f, 1.16f, 0.48f});
  m.add(
      "belly", m.paint.belly,
      [](vec3 p) {
        const float patch = sdf::ellipsoid(p, {0.0f, 0.39f, 0.36f}, {0.25f, 0.145f, 0.30f});
        return sdf::overlap(skin_field(p) - 0.006f, patch, 0.012f);
      },
      {-0.30f, 0.18f, 0.02f}, {0.30f, 0.62f, 0.5f}, 0.4f, body);
  add_face(m, body);

  for (const float side : {-1.0f, 1.0f}) {
    add_foot(m, side);
    add_frills(m, side);
  }
  add_sprout(m);
}

/// Returns a point on the meadow by angle and radius.
vec3 on_meadow(float angle_deg, float radius, float y = 0.0f) {
  const float a = glm::radians(angle_deg);
  return {radius * std::sin(a), y, radius * std::cos(a)};
}

/// Radius of the disc.
constexpr float kMeadow = 1.12f;

/// Adds stones: some in the earth's side, some on the meadow.
void add_stones(Maker& m) {
  struct Stone {
    float angle_deg, radius, y, size;
  };
  for (const Stone& stone :
       {Stone{-38, 0.99f, -0.27f, 0.085f}, Stone{-22, 0.98f, -0.32f, 0.055f}, Stone{22, 0.98f, -0.29f, 0.07f},
        Stone{64, 0.98f, -0.29f, 0.10f}, Stone{120, 0.99f, -0.25f, 0.09f}, Stone{200, 0.99f, -0.27f, 0.09f},
        Stone{-62, 0.84f, 0.03f, 0.13f}, Stone{-50, 0.96f, 0.02f, 0.07f}, Stone{-78, 0.97f, 0.02f, 0.06f},
        Stone{33, 0.97f, 0.01f, 0.055f}}) {
    const vec3 centre = on_meadow(stone.angle_deg, stone.radius, stone.y);
    const float s = stone.size;
    const glm::mat3 inverse = turn(37.0f * stone.angle_deg, glm::normalize(vec3(0.2f, 1.0f, 0.1f)));
    m.add(
        "stone", m.paint.stone,
        [=](vec3 p) {
          const vec3 q = inverse * (p - centre);
          const float egg = sdf::ellipsoid(q, vec3(0.0f), {s, 0.72f * s, 0.85f * s});
          const float slab = glm::dot(q, glm::normalize(vec3(0.5f, 1.0f, 0.35f))) - 0.60f * s;
          const float flank = glm::dot(q, glm::normalize(vec3(-1.0f, 0.2f, 0.6f))) - 0.72f * s;
          return sdf::overlap(sdf::overlap(egg, slab, 0.35f * s), flank, 0.3f * s);
        },
        centre - 1.05f * s, centre + 1.05f * s, 0.9f);
  }
}

void add_mushrooms(Maker& m) {
  struct Mushroom {
    float angle_deg, radius, height, cap;
  };
  for (const Mushroom& mushroom :
       {Mushroom{54, 0.86f, 0.34f, 0.19f}, Mushroom{74, 0.70f, 0.22f, 0.125f}, Mushroom{42, 0.72f, 0.13f, 0.08f}}) {
    const vec3 foot = on_meadow(mushroom.angle_deg, mushroom.radius);
    const vec3 top = foot + vec3(0.10f * mushroom.height, mushroom.height, 0.05f * mushroom.height);
    const float c = mushroom.cap;
    const auto cap = [=](vec3 p) {
      const vec3 q = p - top;
      const float dome = sdf::ellipsoid(q, {0.0f, -0.05f * c, 0.0f}, {c, 0.78f * c, c});
      const float hollow = sdf::ellipsoid(q, {0.0f, -0.45f * c, 0.0f}, {0.95f * c, 0.42f * c, 0.95f * c});
      return sdf::cut(dome, hollow, 0.15f * c);
    };
    const int object = m.add("mushroom", m.paint.cap, cap, top - 1.1f * c, top + 1.1f * c, 0.8f);
    m.add(
        "stalk", m.paint.stalk,
        [=](vec3 p) {
          const float stalk = sdf::bar(p, foot - vec3(0, 0.02f, 0), top + vec3(0, 0.1f * c, 0), 0.40f * c, 0.25f * c);
          return sdf::join(stalk, sdf::ellipsoid(p, foot, {0.5f * c, 0.18f * c, 0.5f * c}), 0.2f * c);
        },
        glm::min(foot, top) - 0.55f * c, glm::max(foot, top) + 0.5f * c, 0.8f);
    for (int i = 0; i < 7; ++i) {
      const float around = 2.4f * float(i) + 0.6f, up = 0.95f - 0.13f * float(i);
      const float flat = std::sqrt(1.0f - up * up);
      const vec3 at = top + vec3(flat * std::sin(around) * c, (up * 0.78f - 0.05f) * c, flat * std::cos(around) * c);
      const float radius = (0.19f - 0.014f * float(i)) * c;
      m.add(
          "dot", m.paint.dot,
          [=](vec3 p) { return sdf::overlap(cap(p) - 0.035f * c, sdf::ball(p, at, radius), 0.05f * c); },
          at - 1.3f * radius, at + 1.3f * radius, 0.3f, object);
    }
  }
}

/// Adds tufts of grass: bent blades in a ring.
void add_blades(Maker& m) {
  Mesh blades;
  const int sides = m.detail(5.0f, 3), steps = m.detail(6.0f, 2);
  for (int t = 0; t < 15; ++t) {
    const float angle_deg = -160.0f + 137.5f * float(t), radius = 0.72f + 0.30f * std::abs(std::sin(2.1f * float(t)));
    const vec3 at = on_meadow(angle_deg, radius, -0.01f);
    for (int i = 0; i < 6; ++i) {
      const float turn_rad = 1.05f * float(i) + float(t), tall = 0.13f + 0.05f * std::sin(3.0f * float(i) + float(t));
      const vec3 out(std::sin(turn_rad), 0.0f, std::cos(turn_rad));
      shapes::Points3 path;
      std::vector<float> scale;
      for (int k = 0; k <= steps; ++k) {
        const float u = float(k) / float(steps);
        path.push_back(at + out * (0.012f + 0.075f * u * u) + vec3(0, tall * (u - 0.15f * u * u), 0));
        scale.push_back(1.0f - 0.93f * u * u);
      }
      shapes::append(blades, shapes::tube(path, 0.013f, sides, false, scale));
    }
  }
  shapes::add_mesh(m.scene, "blades", std::move(blades), m.paint.blade);
}

/// Adds flowers: five petals around a button.
void add_flowers(Maker& m) {
  for (const vec3& place : {vec3(-26, 0.88f, 1.0f), vec3(-104, 0.86f, 1.1f), vec3(100, 0.95f, 0.9f),
                            vec3(18, 0.84f, 0.8f), vec3(160, 0.90f, 1.2f)}) {
    const float size = 0.055f * place.z;
    const vec3 foot = on_meadow(place.x, place.y, -0.01f), head = foot + vec3(0.02f, 0.15f * place.z, 0.03f);
    const glm::mat3 axes = turn(35.0f, glm::normalize(vec3(foot.z, 0.0f, -foot.x) * vec3(1, 1, -1) + vec3(1, 0, 0)));
    const glm::mat3 inverse = glm::transpose(axes);
    m.add(
        "stalk", m.paint.stem, [=](vec3 p) { return sdf::bar(p, foot, head, 0.011f, 0.009f); }, foot - 0.03f,
        head + 0.03f, 0.35f);
    const int object = m.add(
        "petals", m.paint.petal,
        [=](vec3 p) {
          const vec3 q = inverse * (p - head);
          float d = 1e9f;
          for (int i = 0; i < 5; ++i) {
            const float a = 2.0f * std::numbers::pi_v<float> * float(i) / 5.0f;
            const vec3 out(std::cos(a), 0.0f, std::sin(a)), side(-out.z, 0.0f, out.x);
            const vec3 local(glm::dot(q, out), q.y, glm::dot(q, side));
            d = sdf::join(
                d, sdf::ellipsoid(local, {0.75f * size, 0.012f, 0.0f}, {0.62f * size, 0.20f * size, 0.42f * size}),
                0.06f * size);
          }
          return d;
        },
        head - 1.6f * size, head + 1.6f * size, 0.3f);
    m.add(
        "pollen", m.paint.pollen,
        [=](vec3 p) {
          return sdf::ellipsoid(inverse * (p - head), {0.0f, 0.014f, 0.0f}, {0.40f * size, 0.28f * size, 0.40f * size});
        },
        head - 0.7f * size, head + 0.7f * size, 0.4f, object);
  }
}

void add_meadow(Maker& m) {
  m.add(
      "grass", m.paint.grass,
      [](vec3 p) {
        const float r = std::hypot(p.x, p.z), angle = std::atan2(p.x, p.z);
        // The turf hangs over the earth in uneven tongues.
        const float hang = 0.06f + 0.035f * std::sin(11.0f * angle) + 0.020f * std::sin(17.0f * angle + 1.0f);
        const float rim = kMeadow + 0.012f * std::sin(11.0f * angle + 0.4f);
        const float bumps = 0.010f * std::sin(5.0f * p.x + 1.0f) * std::sin(6.0f * p.z);
        const float round = 0.05f;
        const float deep = 0.10f + hang * std::clamp((r - 0.6f) / 0.5f, 0.0f, 1.0f);
        // The side bulges, since tone steps on a vertical side would have vertical edges with square corners.
        const float off_middle = std::clamp(p.y + 0.5f * deep, -0.15f, 0.15f);
        const float out = r - rim + 2.0f * off_middle * off_middle + round;
        const float over = p.y - bumps + round, under = -p.y - deep + round;
        const float side = std::max(over, under);
        return 0.8f *
               (std::hypot(std::max(out, 0.0f), std::max(side, 0.0f)) + std::min(std::max(out, side), 0.0f) - round);
      },
      {-1.2f, -0.3f, -1.2f}, {1.2f, 0.05f, 1.2f}, 1.5f);
  m.add(
      "earth", m.paint.earth,
      [](vec3 p) {
        const float r = std::hypot(p.x, p.z), angle = std::atan2(p.x, p.z);
        const float lumps =
            0.020f * std::sin(7.0f * angle + 6.0f * p.y) + 0.012f * std::sin(19.0f * angle - 9.0f * p.y);
        const float rim = kMeadow - 0.08f + 0.30f * (p.y + 0.1f) + lumps, round = 0.05f;
        const float out = r - rim + round, side = std::abs(p.y + 0.23f) - 0.18f + round;
        return 0.8f *
               (std::hypot(std::max(out, 0.0f), std::max(side, 0.0f)) + std::min(std::max(out, side), 0.0f) - round);
      },
      {-1.2f, -0.45f, -1.2f}, {1.2f, 0.0f, 1.2f}, 1.7f);
  add_stones(m);
  add_mushrooms(m);
  add_blades(m);
  add_flowers(m);
}

Scene build(const Detail& detail) {
  Maker m{.scene = {}, .detail = detail, .paint = {}};
  m.paint = add_palette(m.scene);
  add_figure(m);
  add_meadow(m);
  m.scene.views = {{.eye = {1.25f, 1.75f, 4.6f}, .target = {0.02f, 0.46f, 0.0f}, .angle_deg = 29.0f},
                   {.eye = {-0.75f, 0.85f, 2.6f}, .target = {0.02f, 0.66f, 0.0f}, .angle_deg = 34.0f}};
  return std::move(m.scene);
}

}  // namespace

Scene make_pink(int triangles) { return shapes::build_to_count(triangles, build); }

}  // namespace umbrage
