// scene:claw - an armoured creature that reaches for the viewer: a claw far in front of the body, an open mouth,
// overlapping plates, spines against the sky. It replaces figures 4 and 5 of the unsharp masking paper, where a claw's
// edge is in front of the far plane and of a distant body; the creature is our own. It faces +z.
#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "generators/makers.h"
#include "generators/sdf_mesh.h"
#include "generators/shapes.h"

namespace umbrage {

namespace {

using glm::mat3;
using glm::mat4;
using glm::vec3;
using sdf::Field;
using shapes::Detail;

/// Edge length of the implicit surfaces' triangles at scale 1, metres; and the scale below which they are not enlarged
/// further, because the grid would miss teeth and spines.
constexpr float kCell = 0.028f, kMinScale = 0.28f;

struct Palette {
  int shell, claw, tip, flesh, gum, tongue, tooth, eye, pupil, spine, rock, moss;
};

Palette add_palette(Scene& scene) {
  const shapes::MaterialMaker make{scene};
  Palette p;
  p.shell = make.plain("shell", {0.10f, 0.30f, 0.33f}, 0.25f, 40.0f);
  p.claw = make.plain("claw", {0.66f, 0.21f, 0.09f}, 0.25f, 40.0f);
  p.tip = make.plain("claw tip", {0.16f, 0.075f, 0.06f}, 0.40f, 60.0f);
  p.flesh = make.plain("flesh", {0.60f, 0.47f, 0.31f}, 0.08f, 16.0f);
  p.gum = make.plain("gum", {0.38f, 0.055f, 0.07f}, 0.20f, 30.0f);
  p.tongue = make.plain("tongue", {0.62f, 0.18f, 0.22f}, 0.25f, 30.0f);
  p.tooth = make.plain("tooth", {0.86f, 0.80f, 0.64f}, 0.30f, 60.0f);
  p.eye = make.plain("eye", {0.88f, 0.52f, 0.05f}, 0.60f, 90.0f);
  p.pupil = make.plain("pupil", {0.02f, 0.015f, 0.02f}, 0.60f, 90.0f);
  p.spine = make.plain("spine", {0.72f, 0.63f, 0.46f}, 0.20f, 40.0f);
  p.rock = make.plain("rock", {0.37f, 0.35f, 0.34f}, 0.0f, 1.0f);
  p.moss = make.plain("moss", {0.28f, 0.37f, 0.14f}, 0.0f, 1.0f);
  return p;
}

struct Maker {
  Scene scene;
  Detail detail;
  Palette paint;

  float cell(float cell_factor) const { return kCell * cell_factor / std::max(detail.scale, kMinScale); }

  /// Adds an implicit surface made in its own frame. `cell_factor` is the edge length of its triangles relative to the
  /// default.
  int add(const char* name, int material, const Field& field, vec3 low, vec3 high, const mat4& frame = mat4(1.0f),
          float cell_factor = 1.0f, int part_of = -1) {
    Mesh mesh = sdf::mesh(field, low, high, cell(cell_factor));
    return shapes::add_mesh(scene, name, shapes::transformed(std::move(mesh), frame), material, part_of);
  }
};

/// A bent horn: a bar along a quadratic Bezier curve, with the radius interpolated between its ends.
struct Horn {
  vec3 a, b, c;
  float radius_a, radius_c;
  float power = 1.0f;  ///< above 1, the horn stays thick for longer

  vec3 at(float t) const { return glm::mix(glm::mix(a, b, t), glm::mix(b, c, t), t); }
  float radius(float t) const { return glm::mix(radius_a, radius_c, std::pow(t, power)); }

  float operator()(vec3 p) const {
    // Finds the nearest of a few points, then makes Newton steps on the derivative of the squared distance.
    constexpr int kStarts = 6;
    float best = 0.0f, min = 1e30f;
    for (int i = 0; i <= kStarts; ++i) {
      const float t = float(i) / float(kStarts);
      const vec3 d = at(t) - p;
      if (glm::dot(d, d) < min) {
        min = glm::dot(d, d);
        best = t;
      }
    }
    const vec3 bend = a - 2.0f * b + c;
    for (int i = 0; i < 3; ++i) {
      const vec3 d = at(best) - p, slope = 2.0f * (b - a + best * bend);
      const float curvature = glm::dot(slope, slope) + 2.0f * glm::dot(d, bend);
      if (curvature > 1e-9f) best = std::clamp(best - glm::dot(d, slope) / curvature, 0.0f, 1.0f);
    }
    return glm::distance(at(best), p) - radius(best);
  }
  vec3 low() const { return glm::min(glm::min(a, b), c) - 1.2f * std::max(radius_a, radius_c); }
  vec3 high() const { return glm::max(glm::max(a, b), c) + 1.2f * std::max(radius_a, radius_c); }
};

/// Adds a horn as a tapered tube, whose tip stays sharp at any tessellation.
int add_horn(Maker& m, const char* name, int material, const Horn& horn, const mat4& frame = mat4(1.0f),
             float cell_factor = 0.7f, int part_of = -1) {
  constexpr float kPi = std::numbers::pi_v<float>;
  constexpr int kMinSteps = 5, kMinSides = 6;
  const float edge = kCell * cell_factor / m.detail.scale, thick = std::max(horn.radius_a, horn.radius_c);
  const float length = glm::distance(horn.a, horn.b) + glm::distance(horn.b, horn.c);
  const int steps = std::max(kMinSteps, int(length / edge)),
            sides = std::max(kMinSides, int(2.0f * kPi * thick / edge));
  shapes::Points3 path;
  std::vector<float> scale;
  for (int i = 0; i <= steps; ++i) {
    const float t = float(i) / float(steps);
    path.push_back(horn.at(t));
    scale.push_back(horn.radius(t) / thick);
  }
  Mesh mesh = shapes::tube(path, thick, sides, false, scale);
  mesh.uvs.clear();
  return shapes::add_mesh(m.scene, name, shapes::transformed(std::move(mesh), frame), material, part_of);
}

/// Returns a frame at `origin` whose y axis points along `along` and whose z axis is as close as possible to `front`.
mat4 frame_along(vec3 origin, vec3 along, vec3 front) {
  const vec3 y = glm::normalize(along), x = glm::normalize(glm::cross(y, front)), z = glm::cross(x, y);
  return mat4(glm::vec4(x, 0), glm::vec4(y, 0), glm::vec4(z, 0), glm::vec4(origin, 1));
}

mat4 pitched(vec3 origin, float pitch_deg) {
  return glm::rotate(glm::translate(mat4(1.0f), origin), glm::radians(pitch_deg), vec3(1, 0, 0));
}

// -------------------------------------------------------------------------------------------------------------- body

/// The trunk rises from the hips to the neck.
constexpr vec3 kHips{0.0f, 0.92f, -0.42f}, kChest{0.0f, 1.72f, -0.02f}, kNeck{0.0f, 2.22f, 0.22f};

void add_trunk(Maker& m) {
  m.add("trunk", m.paint.flesh,
        [](vec3 p) {
          float d =
              sdf::join(sdf::bar(p, kHips, kChest, 0.34f, 0.42f), sdf::bar(p, kChest, kNeck, 0.30f, 0.17f), 0.25f);
          for (const float side : {-1.0f, 1.0f})
            d = sdf::join(d, sdf::ball(p, {side * 0.40f, 1.78f, 0.02f}, 0.21f), 0.15f);
          // Rings around the belly and the throat, deepest in front.
          const float front = std::clamp(0.5f + 1.6f * (p.z - 0.5f * (p.y - 1.3f)), 0.0f, 1.0f);
          return 0.85f * (d + 0.022f * front * std::sin(34.0f * (p.y + 0.35f * p.z)));
        },
        {-0.75f, 0.5f, -0.9f}, {0.75f, 2.5f, 0.6f});

  // Five overlapping plates down the back, each with a row of spines.
  for (int i = 0; i < 5; ++i) {
    const float t = float(i) / 4.0f;
    const vec3 at = glm::mix(kChest + vec3(0, 0.22f, 0.0f), kHips + vec3(0, -0.06f, -0.06f), t);
    const float wide = 0.60f - 0.03f * float(i), deep = 0.56f - 0.02f * float(i);
    const mat4 frame = pitched(at, 20.0f + 4.0f * float(i));
    m.add(
        "back plate", m.paint.shell,
        [=](vec3 p) {
          const float whole = sdf::ellipsoid(p, {0.0f, 0.0f, 0.0f}, {wide, 0.42f, deep});
          const float shell = sdf::overlap(whole, -(whole + 0.075f), 0.02f);
          const float front = p.z - 0.10f + 0.5f * p.x * p.x;
          const float under = -p.y - 0.14f - 0.35f * p.x * p.x;
          return 0.9f * sdf::overlap(sdf::overlap(shell, 0.9f * front, 0.04f), 0.8f * under, 0.04f);
        },
        {-0.66f, -0.3f, -0.62f}, {0.66f, 0.46f, 0.2f}, frame, 0.55f);
    for (int k = -2; k <= 2; ++k) {
      const float turn = 0.46f * float(k),
                  length = (k == 0 ? 0.50f : 0.30f - 0.05f * float(std::abs(k))) * (1.0f - 0.08f * float(i));
      const vec3 out(std::sin(turn), 0.18f, -std::cos(turn));
      const vec3 root = vec3(wide * 0.93f, 0.0f, deep * 0.93f) * out + vec3(0, 0.06f, 0);
      add_horn(m, "spine", m.paint.spine,
               {root, root + 0.5f * length * out + vec3(0, 0.05f, 0),
                root + length * out + vec3(0, 0.28f * length + 0.10f, 0), k == 0 ? 0.075f : 0.055f, 0.006f},
               frame, 0.6f);
    }
  }

  // The abdomen is behind: plates like a lobster's, and a fan.
  for (int i = 0; i < 5; ++i) {
    const float t = float(i) / 4.0f;
    const vec3 at(0.0f, 0.66f - 0.16f * t, -0.80f - 0.95f * t);
    const float size = 0.47f - 0.17f * t;
    m.add(
        "abdomen plate", m.paint.shell,
        [=](vec3 p) {
          const float whole = sdf::ellipsoid(p, vec3(0.0f), {size, 0.82f * size, 0.52f * size});
          const float shell = sdf::overlap(whole, -(whole + 0.070f), 0.02f);
          return sdf::overlap(shell, -p.y - 0.35f * size, 0.04f);
        },
        vec3(-size, -size, -size) * 1.05f, vec3(size) * 1.05f, pitched(at, -12.0f), 0.6f);
    m.add(
        "abdomen", m.paint.flesh,
        [=](vec3 p) {
          return sdf::ellipsoid(p, vec3(0.0f), {0.84f * size, 0.66f * size, 0.60f * size});
        },
        vec3(-size), vec3(size), pitched(at - vec3(0, 0.02f, 0), -12.0f), 1.3f);
    if (i < 4)
      add_horn(m, "spine", m.paint.spine,
               {at + vec3(0, 0.72f * size, 0), at + vec3(0, size + 0.05f, -0.05f), at + vec3(0, size + 0.14f, -0.22f),
                0.055f, 0.006f},
               mat4(1.0f), 0.6f);
  }
  for (int k = -2; k <= 2; ++k) {
    const float turn = 0.42f * float(k);
    const vec3 out(std::sin(turn), -0.10f, -std::cos(turn)), at = vec3(0.0f, 0.42f, -1.92f) + 0.26f * out;
    m.add(
        "tail fan", m.paint.shell,
        [](vec3 p) {
          const float blade = sdf::ellipsoid(p, vec3(0.0f), {0.15f, 0.30f, 0.035f});
          return sdf::cut(blade, sdf::bar(p, {0, -0.3f, 0.04f}, {0, 0.24f, 0.04f}, 0.025f, 0.01f), 0.02f);
        },
        {-0.2f, -0.35f, -0.08f}, {0.2f, 0.35f, 0.08f}, frame_along(at, out, {0, 1, 0}), 0.7f);
  }
}

// -------------------------------------------------------------------------------------------------------------- head

/// Adds horns of the crest, swept back.
void add_crest(Maker& m, const mat4& head) {
  struct Crest {
    float x, length, radius;
  };
  for (const Crest& each : {Crest{0.0f, 1.0f, 0.105f}, Crest{0.17f, 0.78f, 0.085f}, Crest{-0.17f, 0.78f, 0.085f},
                            Crest{0.27f, 0.5f, 0.06f}, Crest{-0.27f, 0.5f, 0.06f}}) {
    const vec3 root(each.x, 0.17f - 0.9f * each.x * each.x, -0.16f);
    add_horn(m, "crest horn", m.paint.shell,
             {root, root + vec3(0.45f * each.x, 0.24f, -0.22f) * each.length,
              root + vec3(1.5f * each.x, 0.34f, -0.85f) * each.length, each.radius, 0.010f, 1.3f},
             head, 0.7f);
  }
}

/// Adds an eye, a mandible and a feeler.
void add_side_of_head(Maker& m, const mat4& head, float side) {
  const vec3 at(side * 0.215f, 0.030f, 0.200f);
  const int eye = m.add(
      "eye", m.paint.eye, [=](vec3 p) { return sdf::ball(p, at, 0.064f); }, at - 0.08f, at + 0.08f, head, 0.5f);
  const vec3 look = glm::normalize(vec3(side * 0.62f, 0.02f, 0.78f)), centre = at + 0.052f * look;
  const mat4 pupil = head * frame_along(centre, {0, 1, 0}, look);
  m.add(
      "pupil", m.paint.pupil,
      [](vec3 p) {
        return sdf::ellipsoid(p, vec3(0.0f), {0.014f, 0.044f, 0.018f});
      },
      vec3(-0.06f), vec3(0.06f), pupil, 0.2f, eye);
  add_horn(m, "mandible", m.paint.claw,
           {{side * 0.24f, -0.14f, 0.02f},
            {side * 0.48f, -0.30f, 0.26f},
            {side * 0.21f, -0.36f, 0.60f},
            0.075f,
            0.010f,
            1.2f},
           head, 0.7f);
  for (const float u : {0.55f, 0.75f}) {
    const Horn whole{{side * 0.24f, -0.14f, 0.02f},
                     {side * 0.48f, -0.30f, 0.26f},
                     {side * 0.21f, -0.36f, 0.60f},
                     0.075f,
                     0.010f,
                     1.2f};
    const vec3 on = whole.at(u);
    add_horn(m, "mandible spur", m.paint.tip,
             {on, on + vec3(-side * 0.05f, 0.0f, 0.03f), on + vec3(-side * 0.10f, 0.01f, 0.035f), 0.026f, 0.004f}, head,
             0.4f);
  }
  // Feelers from the brow.
  add_horn(m, "feeler", m.paint.claw,
           {{side * 0.10f, 0.14f, 0.30f}, {side * 0.32f, 0.72f, 0.62f}, {side * 0.85f, 0.66f, 0.20f}, 0.030f, 0.012f},
           head, 0.4f);
}

/// Adds teeth around both jaws, longest near the front.
void add_teeth(Maker& m, const mat4& head, const mat4& jaw) {
  for (const bool upper : {true, false})
    for (const float side : {-1.0f, 1.0f})
      for (int i = 0; i < 6; ++i) {
        const float u = (float(i) + 0.5f) / 6.0f, turn = 0.5f * std::numbers::pi_v<float> * (1.0f - u);
        const float size = (i == 4 ? 1.5f : 0.8f + 0.4f * u) * (upper ? 1.0f : 0.85f);
        Horn tooth;
        if (upper) {
          const vec3 root(side * 0.158f * std::sin(turn) + side * 0.012f, -0.075f - 0.012f * u,
                          0.16f + 0.37f * std::cos(turn));
          tooth = {root + vec3(0, 0.035f, 0), root + vec3(0, -0.05f * size, 0.008f),
                   root + vec3(-side * 0.010f, -0.105f * size, -0.012f), 0.026f * std::sqrt(size), 0.004f};
          add_horn(m, "tooth", m.paint.tooth, tooth, head, 0.4f);
        } else {
          const vec3 root(side * 0.150f * std::sin(turn) + side * 0.008f, 0.015f, 0.20f + 0.385f * std::cos(turn));
          tooth = {root + vec3(0, -0.03f, 0), root + vec3(0, 0.05f * size, 0.008f),
                   root + vec3(-side * 0.008f, 0.105f * size, -0.010f), 0.024f * std::sqrt(size), 0.004f};
          add_horn(m, "tooth", m.paint.tooth, tooth, jaw, 0.4f);
        }
      }
}

void add_head(Maker& m) {
  const mat4 head = pitched({0.0f, 2.40f, 0.36f}, 6.0f);
  const auto palate = [](vec3 p) { return sdf::ellipsoid(p, {0.0f, -0.17f, 0.26f}, {0.150f, 0.145f, 0.31f}); };
  const auto skull = [](vec3 p) {
    float d = sdf::join(sdf::ellipsoid(p, {0.0f, 0.05f, -0.08f}, {0.29f, 0.23f, 0.36f}),
                        sdf::ellipsoid(p, {0.0f, -0.01f, 0.28f}, {0.200f, 0.125f, 0.28f}), 0.14f);
    for (const float side : {-1.0f, 1.0f}) {
      d = sdf::join(d, sdf::bar(p, {side * 0.25f, 0.09f, 0.02f}, {side * 0.12f, 0.125f, 0.36f}, 0.065f, 0.040f), 0.05f);
      d = sdf::join(d, sdf::ellipsoid(p, {side * 0.22f, -0.08f, 0.0f}, {0.10f, 0.12f, 0.16f}), 0.08f);
      d = sdf::cut(d, sdf::ball(p, {side * 0.235f, 0.035f, 0.205f}, 0.075f), 0.03f);
      d = sdf::cut(d, sdf::ball(p, {side * 0.060f, 0.045f, 0.560f}, 0.022f), 0.02f);
    }
    return d;
  };
  m.add(
      "skull", m.paint.shell, [=](vec3 p) { return sdf::cut(skull(p), palate(p), 0.03f); }, {-0.42f, -0.3f, -0.5f},
      {0.42f, 0.36f, 0.62f}, head, 0.8f);
  m.add(
      "palate", m.paint.gum,
      [=](vec3 p) {
        const float lining =
            sdf::cut(sdf::ellipsoid(p, {0.0f, -0.17f, 0.26f}, {0.185f, 0.175f, 0.35f}), palate(p) + 0.012f, 0.01f);
        return sdf::overlap(lining, skull(p) + 0.016f, 0.02f);
      },
      {-0.25f, -0.36f, -0.12f}, {0.25f, 0.08f, 0.62f}, head, 0.4f);

  add_crest(m, head);
  for (const float side : {-1.0f, 1.0f}) add_side_of_head(m, head, side);

  // The lower jaw hangs open from its hinge under the cheeks.
  const mat4 jaw = head * pitched({0.0f, -0.15f, -0.06f}, 36.0f);
  const auto bowl = [](vec3 p) { return sdf::ellipsoid(p, {0.0f, 0.050f, 0.30f}, {0.135f, 0.095f, 0.29f}); };
  const auto chin = [](vec3 p) { return sdf::ellipsoid(p, {0.0f, -0.02f, 0.24f}, {0.185f, 0.105f, 0.38f}); };
  m.add(
      "jaw", m.paint.shell,
      [=](vec3 p) {
        const float flat = sdf::overlap(chin(p), p.y - 0.035f, 0.03f);
        return sdf::cut(flat, bowl(p), 0.02f);
      },
      {-0.22f, -0.16f, -0.2f}, {0.22f, 0.12f, 0.66f}, jaw, 0.7f);
  m.add(
      "jaw's gum", m.paint.gum,
      [=](vec3 p) {
        const float lining =
            sdf::cut(sdf::ellipsoid(p, {0.0f, 0.050f, 0.30f}, {0.160f, 0.118f, 0.32f}), bowl(p) + 0.010f, 0.01f);
        return sdf::overlap(sdf::overlap(lining, chin(p) + 0.012f, 0.01f), p.y - 0.040f, 0.015f);
      },
      {-0.22f, -0.16f, -0.2f}, {0.22f, 0.12f, 0.66f}, jaw, 0.4f);
  m.add(
      "throat", m.paint.gum,
      [](vec3 p) {
        const float plug = sdf::ellipsoid(p, {0.0f, -0.20f, -0.02f}, {0.185f, 0.20f, 0.20f});
        return sdf::cut(plug, sdf::ellipsoid(p, {0.0f, -0.19f, 0.18f}, {0.085f, 0.085f, 0.18f}), 0.05f);
      },
      {-0.25f, -0.45f, -0.3f}, {0.25f, 0.05f, 0.25f}, head, 0.6f);
  add_horn(m, "tongue", m.paint.tongue,
           {{0.0f, 0.0f, 0.04f}, {0.0f, 0.06f, 0.34f}, {0.02f, 0.13f, 0.50f}, 0.075f, 0.028f}, jaw, 0.6f);

  add_teeth(m, head, jaw);
}

// ------------------------------------------------------------------------------------------------------------- limbs

/// Adds the claw in its own frame: the wrist at the origin, fingers along +y, opening along x, the palm's back at +z.
void add_claw(Maker& m, const mat4& frame, float side) {
  const vec3 mirror(side, 1.0f, 1.0f);
  const auto flip = [=](const Horn& h) {
    return Horn{h.a * mirror, h.b * mirror, h.c * mirror, h.radius_a, h.radius_c, h.power};
  };
  const Horn fixed = flip({{0.10f, 0.34f, 0.0f}, {0.42f, 0.86f, 0.02f}, {0.07f, 1.30f, 0.05f}, 0.21f, 0.020f, 1.1f});
  const Horn free = flip({{-0.20f, 0.50f, 0.0f}, {-0.50f, 0.92f, 0.02f}, {-0.06f, 1.27f, 0.05f}, 0.145f, 0.018f, 1.1f});
  const auto palm = [=](vec3 p) {
    const vec3 q = p * mirror;
    float d = sdf::ellipsoid(q, {0.0f, 0.33f, 0.0f}, {0.34f, 0.37f, 0.21f});
    d = sdf::join(d, sdf::bar(q, {0.0f, 0.0f, 0.0f}, {0.0f, 0.25f, 0.0f}, 0.13f, 0.20f), 0.10f);
    // Two low ridges along the palm's back.
    for (const float x : {-0.12f, 0.10f})
      d = sdf::join(d, sdf::bar(q, {0.6f * x, 0.12f, 0.13f}, {1.3f * x, 0.52f, 0.15f}, 0.05f, 0.06f), 0.06f);
    return d;
  };
  m.add(
      "claw", m.paint.claw,
      [=](vec3 p) {
        float d = sdf::join(palm(p), fixed(p), 0.12f);
        // The socket of the free finger.
        return sdf::cut(d, sdf::ball(p * mirror, {-0.24f, 0.56f, 0.0f}, 0.150f), 0.04f);
      },
      {-0.5f, -0.2f, -0.3f}, {0.5f, 1.36f, 0.3f}, frame, 0.8f);
  m.add(
      "free finger", m.paint.claw,
      [=](vec3 p) {
        return sdf::join(free(p), sdf::ball(p * mirror, {-0.22f, 0.55f, 0.0f}, 0.135f), 0.05f);
      },
      {-0.6f, 0.3f, -0.25f}, {0.6f, 1.34f, 0.3f}, frame, 0.8f);
  // Dark horn over both tips.
  for (const Horn* finger : {&fixed, &free})
    m.add(
        "claw tip", m.paint.tip,
        [=, finger = *finger](vec3 p) {
          const vec3 at = finger.at(0.80f), along = glm::normalize(finger.c - at);
          return sdf::overlap(finger(p) - 0.012f, -glm::dot(p - at, along), 0.02f);
        },
        finger->low(), finger->high() + 0.03f, frame, 0.5f);
  // Teeth along the fingers' inner edges, and knobs on the palm's back.
  for (int i = 0; i < 5; ++i) {
    const float grow = 1.0f - 0.10f * float(i);
    for (const bool moving : {false, true}) {
      const Horn& finger = moving ? free : fixed;
      const float t = (moving ? 0.30f : 0.34f) + 0.105f * float(i);
      const vec3 in = glm::normalize(vec3(moving ? side : -side, 0.10f, 0.0f));
      const vec3 root = finger.at(t) + in * (0.80f * finger.radius(t));
      add_horn(m, "claw tooth", m.paint.tip,
               {root, root + 0.04f * grow * in, root + (0.085f * grow + 0.2f * finger.radius(t)) * in, 0.050f * grow,
                0.008f},
               frame, 0.5f);
    }
    const vec3 knob = vec3(-0.16f + 0.08f * float(i), 0.24f + 0.05f * float(i * i % 3), 0.0f) * mirror;
    const float high = 0.19f * std::sqrt(1.0f - 6.0f * knob.x * knob.x);
    add_horn(m, "knob", m.paint.tip,
             {knob + vec3(0, 0, high - 0.03f), knob + vec3(0, 0, high + 0.03f), knob + vec3(0, 0.02f, high + 0.065f),
              0.036f, 0.010f},
             frame, 0.5f);
  }
  // Spurs on the outer edge.
  for (int i = 0; i < 4; ++i) {
    const float t = 0.10f + 0.19f * float(i);
    const vec3 on = fixed.at(t), out = glm::normalize(vec3(side, 0.15f, 0.1f));
    const vec3 root = on + out * fixed.radius(t) * 0.85f;
    add_horn(m, "spur", m.paint.tip, {root, root + 0.06f * out, root + 0.11f * out + vec3(0, 0.05f, 0), 0.040f, 0.005f},
             frame, 0.5f);
  }
}

struct Arm {
  vec3 shoulder, elbow, wrist, finger, back;  ///< joint positions; directions of the fingers and the palm's back
  float side, size;
};

void add_arm(Maker& m, const Arm& arm) {
  const auto limb = [&](const char* name, vec3 from, vec3 to, float thick, vec3 front) {
    const float length = glm::distance(from, to);
    const mat4 frame = frame_along(from, to - from, front);
    m.add(
        name, m.paint.shell,
        [=](vec3 p) {
          float d = sdf::bar(p, {0, 0.10f * length, 0}, {0, 0.52f * length, 0.02f}, 0.62f * thick, thick);
          d = sdf::join(d, sdf::bar(p, {0, 0.52f * length, 0.02f}, {0, 0.90f * length, 0}, thick, 0.68f * thick), 0.1f);
          // A groove around the limb before its end.
          const float ring = std::hypot(std::hypot(p.x, p.z) - 0.92f * thick, p.y - 0.78f * length) - 0.15f * thick;
          return sdf::cut(d, ring, 0.04f);
        },
        {-1.3f * thick, -0.1f, -1.3f * thick}, {1.3f * thick, length + 0.15f, 1.3f * thick}, frame, 0.9f);
    for (int i = 0; i < 3; ++i) {
      const float y = (0.36f + 0.18f * float(i)) * length;
      add_horn(m, "spur", m.paint.spine,
               {{0.0f, y, 0.85f * thick}, {0.0f, y, thick + 0.08f}, {0.0f, y + 0.07f, thick + 0.15f}, 0.042f, 0.005f},
               frame, 0.55f);
    }
  };
  limb("upper arm", arm.shoulder, arm.elbow, 0.175f * arm.size, vec3(0, 1, -0.3f));
  limb("forearm", arm.elbow, arm.wrist, 0.185f * arm.size, vec3(arm.side, 0.9f, 0));
  const float joint = 0.140f * arm.size;
  for (const vec3& at : {arm.shoulder, arm.elbow, arm.wrist})
    m.add(
        "joint", m.paint.flesh,
        [=](vec3 p) {
          const float ball = sdf::ball(p, vec3(0.0f), joint);
          return 0.9f * (ball + 0.010f * std::sin(70.0f * p.y));
        },
        vec3(-1.2f * joint), vec3(1.2f * joint), glm::translate(mat4(1.0f), at), 0.7f);
  // A dome over the shoulder.
  m.add(
      "shoulder plate", m.paint.shell,
      [=](vec3 p) {
        const float whole = sdf::ellipsoid(p, vec3(0.0f), {0.31f, 0.30f, 0.33f});
        const float shell = sdf::overlap(whole, -(whole + 0.070f), 0.02f);
        return sdf::overlap(shell, -p.y + 0.02f - 0.25f * arm.side * p.x, 0.04f);
      },
      vec3(-0.36f), vec3(0.36f), glm::translate(mat4(1.0f), arm.shoulder + vec3(arm.side * 0.02f, 0.0f, 0.0f)), 0.5f);
  add_horn(m, "shoulder spine", m.paint.spine,
           {arm.shoulder + vec3(arm.side * 0.10f, 0.25f, -0.05f), arm.shoulder + vec3(arm.side * 0.22f, 0.42f, -0.10f),
            arm.shoulder + vec3(arm.side * 0.30f, 0.62f, -0.26f), 0.085f, 0.007f});
  add_claw(m, frame_along(arm.wrist, arm.finger, arm.back) * glm::scale(mat4(1.0f), vec3(arm.size)), arm.side);
}

void add_legs(Maker& m) {
  struct Leg {
    vec3 hip, knee, foot;
  };
  for (const Leg& leg : {Leg{{0.26f, 0.86f, -0.22f}, {1.02f, 1.18f, 0.22f}, {1.42f, 0.0f, 0.62f}},
                         Leg{{0.30f, 0.82f, -0.48f}, {1.22f, 1.22f, -0.52f}, {1.72f, 0.0f, -0.46f}},
                         Leg{{0.26f, 0.80f, -0.74f}, {1.00f, 1.12f, -1.22f}, {1.36f, 0.0f, -1.62f}}})
    for (const float side : {-1.0f, 1.0f}) {
      const vec3 mirror(side, 1, 1), hip = leg.hip * mirror, knee = leg.knee * mirror, foot = leg.foot * mirror;
      add_horn(m, "thigh", m.paint.shell, {hip, glm::mix(hip, knee, 0.5f) + vec3(0, 0.16f, 0), knee, 0.155f, 0.085f},
               mat4(1.0f), 0.9f);
      const vec3 sink(0, -0.02f, 0);
      add_horn(m, "shin", m.paint.shell,
               {knee, glm::mix(knee, foot, 0.35f) + vec3(side * 0.20f, 0.06f, 0), foot + sink, 0.105f, 0.018f, 0.8f},
               mat4(1.0f), 0.8f);
      m.add(
          "joint", m.paint.flesh, [=](vec3 p) { return sdf::ball(p, knee, 0.100f); }, knee - 0.12f, knee + 0.12f,
          mat4(1.0f), 0.8f);
      add_horn(m, "knee spur", m.paint.spine,
               {knee + vec3(side * 0.03f, 0.06f, 0), knee + vec3(side * 0.08f, 0.18f, 0),
                knee + vec3(side * 0.20f, 0.28f, -0.02f), 0.060f, 0.006f},
               mat4(1.0f), 0.6f);
    }
}

/// Adds rock under the creature, partly covered with moss.
void add_rock(Maker& m) {
  m.add(
      "rock", m.paint.rock,
      [](vec3 p) {
        const float r = std::hypot(p.x, p.z + 0.45f), angle = std::atan2(p.x, p.z + 0.45f);
        const float rim = 2.12f + 0.09f * std::sin(3.0f * angle + 1.0f) + 0.06f * std::sin(7.0f * angle) +
                          0.25f * std::min(p.y, 0.0f);
        const float lumps =
            0.018f * std::sin(5.0f * p.x + 1.0f) * std::sin(6.0f * p.z) * std::clamp(1.6f * (r - 0.2f), 0.0f, 1.0f) +
            0.03f * std::sin(9.0f * p.y + 4.0f * angle);
        const float round = 0.08f, out = r - rim + round - lumps * std::clamp(-10.0f * p.y - 0.5f, 0.0f, 1.0f);
        const float over = std::abs(p.y + 0.25f) - 0.25f + round;
        return 0.75f *
               (std::hypot(std::max(out, 0.0f), std::max(over, 0.0f)) + std::min(std::max(out, over), 0.0f) - round);
      },
      {-2.45f, -0.6f, -2.85f}, {2.45f, 0.1f, 2.0f}, mat4(1.0f), 2.0f);
  struct Boulder {
    float x, z, size, turn_deg;
    bool mossy;
  };
  for (const Boulder& each : {Boulder{1.20f, 1.05f, 0.26f, 20, false}, Boulder{1.52f, 0.90f, 0.15f, 70, true},
                              Boulder{-1.62f, 0.35f, 0.24f, 110, true}, Boulder{-1.35f, 0.85f, 0.14f, 35, false},
                              Boulder{0.35f, 1.30f, 0.12f, 200, false}, Boulder{0.60f, 1.42f, 0.08f, 80, true},
                              Boulder{-0.5f, -2.2f, 0.28f, 10, true}}) {
    const vec3 at(each.x, 0.30f * each.size, each.z);
    const float s = each.size;
    const mat4 frame = glm::rotate(glm::translate(mat4(1.0f), at), glm::radians(each.turn_deg), vec3(0, 1, 0));
    const auto stone = [=](vec3 p) {
      float d = sdf::ellipsoid(p, vec3(0.0f), {1.15f * s, 0.85f * s, s});
      for (const vec3& n : {vec3(0.6f, 1.0f, 0.2f), vec3(-1.0f, 0.5f, 0.3f), vec3(0.2f, 0.3f, 1.0f),
                            vec3(0.9f, -0.1f, -0.6f), vec3(-0.3f, 0.6f, -1.0f)})
        d = sdf::overlap(d, glm::dot(p, glm::normalize(n)) - 0.72f * s, 0.12f * s);
      return d;
    };
    const int object = m.add("boulder", m.paint.rock, stone, vec3(-1.2f * s), vec3(1.2f * s), frame, 0.9f);
    if (each.mossy)
      m.add(
          "moss", m.paint.moss,
          [=](vec3 p) {
            return sdf::overlap(stone(p) - 0.012f,
                                0.35f * s + 0.10f * s * std::sin(14.0f * p.x / s * 0.3f + 3.0f * p.z / s) - p.y, 0.03f);
          },
          vec3(-1.3f * s), vec3(1.3f * s), frame, 0.6f, object);
  }
}

Scene build(const Detail& detail) {
  Maker m{.scene = {}, .detail = detail, .paint = {}};
  m.paint = add_palette(m.scene);
  add_trunk(m);
  add_head(m);
  add_arm(m, {.shoulder = {-0.52f, 1.84f, 0.02f},
              .elbow = {-1.12f, 1.40f, 1.02f},
              .wrist = {-0.52f, 1.18f, 2.30f},
              .finger = {0.02f, 0.86f, 0.50f},
              .back = {-0.25f, -0.5f, 0.85f},
              .side = -1.0f,
              .size = 1.0f});
  add_arm(m, {.shoulder = {0.52f, 1.84f, 0.02f},
              .elbow = {1.28f, 1.50f, 0.25f},
              .wrist = {1.42f, 0.98f, 0.92f},
              .finger = {-0.42f, -0.10f, 0.70f},
              .back = {0.2f, 0.9f, 0.4f},
              .side = 1.0f,
              .size = 0.78f});
  add_legs(m);
  add_rock(m);
  m.scene.views = {{.eye = {0.25f, 2.15f, 8.2f}, .target = {0.0f, 1.34f, 0.0f}, .angle_deg = 28.5f},
                   {.eye = {-4.5f, 0.55f, 4.0f}, .target = {-0.50f, 1.76f, 2.58f}, .angle_deg = 21.0f},
                   {.eye = {5.4f, 3.3f, 6.4f}, .target = {-0.15f, 1.22f, 0.5f}, .angle_deg = 35.0f}};
  return std::move(m.scene);
}

}  // namespace

Scene make_claw(int triangles) { return shapes::build_to_count(triangles, build); }

}  // namespace umbrage
