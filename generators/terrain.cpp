// The terrain: a square kilometre of mountains around a lake, with a wood on the lower slopes. It is a height field of
// ridged multifractal noise [Musgrave et al. 1989], eroded by rain drops that carry sediment downhill [Beyer 2015]. It
// has occlusion at all scales, from the valley to the gullies.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <numbers>

#include "generators/makers.h"
#include "generators/noise.h"
#include "generators/procedural_texture.h"
#include "generators/shapes.h"

namespace umbrage {

namespace {

using namespace shapes;
using glm::vec2;
using glm::vec3;

constexpr float kPi = std::numbers::pi_v<float>;

constexpr float kHalf = 500.0f;  // the land is x, z = +-kHalf
constexpr float kLake = 14.0f;   // height of the water
constexpr float kTreeLine = 115.0f, kSnowLine = 165.0f;
constexpr float kBase = -40.0f;  // bottom of the block of land
constexpr int kField = 400;      // samples of the eroded field along a side: 2.5 m

/// Heights on a square grid over the land.
struct Relief {
  int n = 0;  ///< samples along a side
  std::vector<float> height;

  float& at(int x, int z) { return height[std::size_t(z) * std::size_t(n) + std::size_t(x)]; }
  float at(int x, int z) const { return height[std::size_t(z) * std::size_t(n) + std::size_t(x)]; }
  float clamped(int x, int z) const { return at(std::clamp(x, 0, n - 1), std::clamp(z, 0, n - 1)); }
  float step() const { return 2.0f * kHalf / float(n - 1); }
};

/// A height and its derivatives along x and z, metres per metre.
struct Slope {
  float height = 0.0f;
  vec2 rise{0.0f};
  vec3 normal() const { return glm::normalize(vec3(-rise.x, 1.0f, -rise.y)); }
};

/// Evaluates a cubic B-spline around a point. Its second derivative is continuous, so that finer meshes are rounder,
/// not more faceted.
Slope smooth_slope(const Relief& field, vec2 p) {
  const vec2 q = (p + vec2(kHalf)) / field.step();
  const int x = int(std::floor(q.x)), z = int(std::floor(q.y));
  const auto weights = [](float t, float w[4], float dw[4]) {
    const float s = 1.0f - t;
    w[0] = s * s * s / 6.0f;
    w[1] = (3.0f * t * t * t - 6.0f * t * t + 4.0f) / 6.0f;
    w[2] = (3.0f * s * s * s - 6.0f * s * s + 4.0f) / 6.0f;
    w[3] = t * t * t / 6.0f;
    dw[0] = -0.5f * s * s;
    dw[1] = 1.5f * t * t - 2.0f * t;
    dw[2] = 2.0f * s - 1.5f * s * s;
    dw[3] = 0.5f * t * t;
  };
  float wx[4], wz[4], dx[4], dz[4];
  weights(q.x - float(x), wx, dx);
  weights(q.y - float(z), wz, dz);
  Slope slope;
  for (int j = 0; j < 4; ++j) {
    float row = 0.0f, row_rise = 0.0f;
    for (int i = 0; i < 4; ++i) {
      const float height = field.clamped(x + i - 1, z + j - 1);
      row += wx[i] * height;
      row_rise += dx[i] * height;
    }
    slope.height += wz[j] * row;
    slope.rise += vec2(wz[j] * row_rise, dz[j] * row) / field.step();
  }
  return slope;
}

/// Returns x of the valley's centre line at z.
float valley_middle(float z) { return 55.0f * std::sin(z / 150.0f + 0.4f) + 0.10f * z; }

/// Returns the height before erosion: ridges all around, lower towards a winding valley that opens to the viewer at +z.
float raw_height(vec2 p) {
  const vec2 warp = 55.0f * vec2(noise::fractal(p / 260.0f, 3, 101), noise::fractal(p / 260.0f, 3, 211));
  vec2 q = (p + warp) / 330.0f;
  float sum = 0.0f, size = 1.0f, weight = 1.0f;
  for (std::uint32_t octave = 0; octave < 7; ++octave) {
    // A ridge is a fold of the noise; it is rough only where the coarser octave is already high.
    float ridge = 1.0f - std::abs(noise::gradient(q, 17u + octave));
    ridge *= ridge * weight;
    sum += ridge * size;
    weight = std::clamp(1.9f * ridge, 0.0f, 1.0f);
    size *= 0.48f;
    q = vec2(0.8f * q.x - 0.6f * q.y, 0.6f * q.x + 0.8f * q.y) * 2.03f;  // rotated, so that no axis is visible
  }
  const float from_valley = std::abs(p.x + 0.5f * warp.x - valley_middle(p.y));
  const vec2 from_lake = (p + 0.8f * warp - vec2(valley_middle(60.0f) - 15.0f, 50.0f)) * vec2(1.0f, 0.8f);
  const float basin =
      1.0f - glm::smoothstep(55.0f, 170.0f, glm::length(from_lake) + 30.0f * noise::fractal(p / 75.0f, 3, 321));
  const float width = 95.0f + 45.0f * glm::smoothstep(-80.0f, 60.0f, p.y);
  const float rise = glm::smoothstep(0.45f * width, width + 300.0f, from_valley);
  const float head =
      1.0f - glm::smoothstep(-340.0f, -100.0f, p.y + 0.3f * warp.y);  // the valley ends in the main range
  const float high = std::clamp(rise + 0.95f * head, 0.0f, 1.15f);
  const float floor = kLake + 6.0f + 7.0f * noise::fractal(p / 90.0f, 3, 301) - 22.0f * basin;
  return floor + high * (14.0f + 118.0f * (0.30f + 0.70f * high) * sum);
}

/// Returns the height with the bed of the river, which leaves the lake towards +z. The bed is cut into the valley
/// floor, below the water.
float river_bed(vec2 p, float height) {
  constexpr float kHalfWidth = 8.0f, kDepth = 3.0f;
  const float middle = valley_middle(p.y) + 24.0f * std::sin(p.y / 38.0f) * glm::smoothstep(110.0f, 220.0f, p.y);
  const float off = (p.x - middle) / (kHalfWidth * (1.0f + 0.4f * noise::gradient(p / 30.0f, 311)));
  const float cut = std::exp(-std::pow(std::abs(off), 3.0f)) * glm::smoothstep(40.0f, 90.0f, p.y);
  const float banks = std::exp(-off * off / 30.0f) * glm::smoothstep(90.0f, 160.0f, p.y);
  const float low = height - 0.85f * banks * std::max(height - kLake - 2.5f, 0.0f);
  return low - cut * std::max(low - (kLake - kDepth), 0.0f);
}

/// Simulates rain: drops run downhill, take up earth where they are fast and deposit it where they are slow.
void erode(Relief& field) {
  constexpr int kDrops = 70'000, kSteps = 60;
  constexpr float kInertia = 0.06f, kCapacity = 5.0f, kMinSlope = 0.01f, kErosion = 0.28f, kDeposit = 0.25f,
                  kEvaporation = 0.018f, kGravity = 5.0f;
  constexpr int kBrush = 2;  // radius of the samples that a drop erodes; eroding single samples would leave needles
  float brush[2 * kBrush + 1][2 * kBrush + 1], total = 0.0f;
  for (int j = -kBrush; j <= kBrush; ++j)
    for (int i = -kBrush; i <= kBrush; ++i)
      total += brush[j + kBrush][i + kBrush] = std::max(0.0f, float(kBrush) + 0.5f - std::sqrt(float(i * i + j * j)));
  noise::Random random{noise::hash(7u)};
  const float last = float(field.n - 2 - kBrush),
              scale = 1.0f / field.step();  // from metres to samples
  for (int drop = 0; drop < kDrops; ++drop) {
    vec2 p(random.between(float(kBrush), last), random.between(float(kBrush), last));
    vec2 direction(0.0f);
    float speed = 1.0f, water = 1.0f, load = 0.0f;
    for (int step = 0; step < kSteps; ++step) {
      const int x = int(p.x), z = int(p.y);
      const float fx = p.x - float(x), fz = p.y - float(z);
      const float a = field.at(x, z), b = field.at(x + 1, z), c = field.at(x, z + 1), e = field.at(x + 1, z + 1);
      const vec2 slope = scale * vec2((b - a) * (1.0f - fz) + (e - c) * fz, (c - a) * (1.0f - fx) + (e - b) * fx);
      direction = kInertia * direction - (1.0f - kInertia) * slope;
      const float length = glm::length(direction);
      if (length < 1e-6f) break;
      direction /= length;
      const vec2 next = p + direction;
      if (next.x < float(kBrush) || next.y < float(kBrush) || next.x >= last || next.y >= last) break;
      const auto bilinear = [&field](vec2 q) {
        const int i = int(q.x), j = int(q.y);
        const float u = q.x - float(i), v = q.y - float(j);
        return (field.at(i, j) * (1.0f - u) + field.at(i + 1, j) * u) * (1.0f - v) +
               (field.at(i, j + 1) * (1.0f - u) + field.at(i + 1, j + 1) * u) * v;
      };
      const float rise = scale * (bilinear(next) - bilinear(p));
      const float capacity = std::max(-rise, kMinSlope) * speed * water * kCapacity;
      if (rise > 0.0f || load > capacity) {
        // Uphill: fill the pit behind, but no higher than its edge.
        const float deposited = rise > 0.0f ? std::min(rise, load) : (load - capacity) * kDeposit;
        load -= deposited;
        const float lift = deposited / scale;
        field.at(x, z) += lift * (1.0f - fx) * (1.0f - fz);
        field.at(x + 1, z) += lift * fx * (1.0f - fz);
        field.at(x, z + 1) += lift * (1.0f - fx) * fz;
        field.at(x + 1, z + 1) += lift * fx * fz;
      } else {
        const float eroded_height = std::min((capacity - load) * kErosion, -rise);
        load += eroded_height;
        for (int j = -kBrush; j <= kBrush; ++j)
          for (int i = -kBrush; i <= kBrush; ++i)
            field.at(x + i, z + j) -= eroded_height / scale * brush[j + kBrush][i + kBrush] / total;
      }
      speed = std::sqrt(std::max(speed * speed - rise * kGravity, 0.0f));
      water *= 1.0f - kEvaporation;
      p = next;
    }
  }
}

/// Simulates frost: ground that is too steep slides down to its neighbours, and gathers as scree below the cliffs.
void weather(Relief& field) {
  constexpr int kRounds = 28;
  constexpr float kMovedFraction = 0.18f;  // fraction of the excess that moves; above 1/4, four neighbours overshoot
  std::vector<float> change(field.height.size());
  for (int round = 0; round < kRounds; ++round) {
    std::fill(change.begin(), change.end(), 0.0f);
    for (int z = 0; z < field.n; ++z)
      for (int x = 0; x < field.n; ++x) {
        const std::size_t here = std::size_t(z) * std::size_t(field.n) + std::size_t(x);
        // The max slope of rock varies: crags stay between the screes.
        const float max_drop = field.step() * (0.75f + 1.0f * noise::unit(noise::hash(x / 9, z / 9, 331u)));
        for (const glm::ivec2 to : {glm::ivec2(1, 0), glm::ivec2(0, 1)}) {
          if (x + to.x >= field.n || z + to.y >= field.n) continue;
          const std::size_t there = here + std::size_t(to.x) + std::size_t(to.y) * std::size_t(field.n);
          const float drop = field.height[here] - field.height[there];
          const float moved = kMovedFraction * std::max(std::abs(drop) - max_drop, 0.0f) * (drop > 0.0f ? 1.0f : -1.0f);
          change[here] -= moved;
          change[there] += moved;
        }
      }
    for (std::size_t i = 0; i < change.size(); ++i) field.height[i] += change[i];
  }
}

Relief eroded_field() {
  Relief field{kField, std::vector<float>(std::size_t(kField) * kField)};
  for (int z = 0; z < kField; ++z)
    for (int x = 0; x < kField; ++x) field.at(x, z) = raw_height(vec2(float(x), float(z)) * field.step() - vec2(kHalf));
  weather(field);
  erode(field);
  weather(field);
  constexpr float kMinHeight = kLake - 15.0f;
  for (int z = 0; z < kField; ++z)
    for (int x = 0; x < kField; ++x)
      field.at(x, z) =
          std::max(river_bed(vec2(float(x), float(z)) * field.step() - vec2(kHalf), field.at(x, z)), kMinHeight);
  return field;
}

/// Returns detail finer than the eroded field: broken rock on steep ground, down to the resolution of `spacing`.
float fine_height(vec2 p, float steepness, float spacing) {
  float sum = 0.0f, size = 2.4f, wavelength = 26.0f;
  for (std::uint32_t octave = 0; octave < 6 && wavelength > 2.0f * spacing; ++octave) {
    // Folded noise has edges, like broken rock.
    sum += size * (0.5f - 1.6f * std::abs(noise::gradient(p / wavelength, 401u + octave)));
    size *= 0.52f;
    wavelength *= 0.5f;
  }
  return sum * (0.05f + 1.1f * glm::smoothstep(0.45f, 1.1f, steepness));
}

/// Returns the field of the mesh, n samples along a side.
Relief mesh_field(const Relief& eroded, int n) {
  Relief field{n, std::vector<float>(std::size_t(n) * std::size_t(n))};
  const float step = field.step();
  for (int z = 0; z < n; ++z)
    for (int x = 0; x < n; ++x) {
      const vec2 p = vec2(float(x), float(z)) * step - vec2(kHalf);
      const Slope slope = smooth_slope(eroded, p);
      field.at(x, z) = slope.height + fine_height(p, glm::length(slope.rise), step);
    }
  return field;
}

/// Height and upward normal of the field's surface, interpolated like the mesh's triangles.
struct Ground {
  float height = 0.0f;
  vec3 normal{0, 1, 0};
};
Ground ground_at(const Relief& field, vec2 p) {
  const vec2 q = glm::clamp((p + vec2(kHalf)) / field.step(), vec2(0.0f), vec2(float(field.n) - 1.001f));
  const int x = int(q.x), z = int(q.y);
  const float u = q.x - float(x), v = q.y - float(z);
  const float a = field.at(x, z), b = field.at(x + 1, z), c = field.at(x, z + 1), d = field.at(x + 1, z + 1);
  // The quads are split from (x, z + 1) to (x + 1, z).
  const float dx = u + v < 1.0f ? b - a : d - c, dz = u + v < 1.0f ? c - a : d - b;
  const float height = u + v < 1.0f ? a + u * dx + v * dz : d - (1.0f - u) * dx - (1.0f - v) * dz;
  return {height, glm::normalize(vec3(-dx, field.step(), -dz))};
}

/// Returns the density of the wood at a point, 0 to 1.
float woods(vec2 p, const Ground& ground) {
  const float patches = glm::smoothstep(-0.12f, 0.22f, noise::fractal(p / 120.0f, 3, 501));
  const float low =
      1.0f - glm::smoothstep(kTreeLine - 45.0f, kTreeLine, ground.height + 25.0f * noise::gradient(p / 60.0f, 502));
  const float dry = glm::smoothstep(kLake + 1.5f, kLake + 6.0f, ground.height);
  return patches * low * dry * glm::smoothstep(0.66f, 0.82f, ground.normal.y);
}

/// Returns the colour of the ground by height and slope: sand, meadow, forest floor, scree, rock, snow.
vec3 ground_color(const Relief& eroded, vec2 p) {
  const Slope slope = smooth_slope(eroded, p);
  const float height = slope.height;
  const Ground ground{height, slope.normal()};
  const float blotch = noise::fractal(p / 45.0f, 4, 601), speck = noise::fractal(p / 5.0f, 2, 611);
  const float flat = ground.normal.y + 0.05f * blotch + 0.04f * speck;
  const float strata = noise::gradient({height / 5.0f + 2.5f * blotch, p.x / 60.0f}, 621);

  const vec3 meadow = glm::mix(vec3(0.13f, 0.20f, 0.045f), vec3(0.27f, 0.26f, 0.09f),
                               glm::smoothstep(-0.35f, 0.45f, blotch + height / 400.0f));
  const float cracks =
      1.0f - glm::smoothstep(0.0f, 0.13f,
                             std::abs(noise::gradient({p.x / 9.0f + 0.4f * blotch, p.y / 9.0f + height / 26.0f}, 631)));
  const vec3 rock = (1.0f - 0.12f * cracks) * glm::mix(vec3(0.22f, 0.20f, 0.18f), vec3(0.41f, 0.37f, 0.32f),
                                                       0.5f + 0.12f * strata + 0.35f * speck + 0.5f * blotch);
  const vec3 scree = vec3(0.37f, 0.335f, 0.28f) * (1.0f + 0.25f * speck);
  const vec3 snow(0.86f, 0.89f, 0.93f), sand(0.46f, 0.40f, 0.28f), needles(0.055f, 0.085f, 0.03f);

  vec3 color = glm::mix(meadow * (1.0f + 0.25f * speck), needles, 0.75f * woods(p, ground));
  color = glm::mix(color, scree, glm::smoothstep(kTreeLine - 10.0f, kSnowLine - 10.0f, height + 40.0f * blotch));
  color = glm::mix(color, rock, 1.0f - glm::smoothstep(0.66f, 0.77f, flat));
  const float snowy = glm::smoothstep(kSnowLine - 25.0f, kSnowLine + 20.0f, height + 30.0f * blotch) *
                      glm::smoothstep(0.50f, 0.64f, flat);
  color = glm::mix(color, snow, snowy);
  return glm::mix(sand * (1.0f + 0.15f * speck), color,
                  glm::smoothstep(kLake + 0.6f, kLake + 2.6f, height + 0.8f * speck));
}

struct Materials {
  int ground, water, cut, needles, boulder;
};

Materials add_materials(Scene& scene, const Relief& eroded) {
  constexpr int kTexels = 1024;  // one metre each
  Materials m{};
  Texture ground = procedural::paint("ground", kTexels, kTexels, [&eroded](vec2 uv) {
    return glm::vec4(ground_color(eroded, vec2(2.0f * uv.x - 1.0f, 1.0f - 2.0f * uv.y) * kHalf), 1.0f);
  });
  m.ground =
      add_material(scene, {.name = "ground", .albedo = vec3(1.0f), .texture = add_texture(scene, std::move(ground))});
  m.water = add_material(
      scene,
      {.name = "lake", .albedo = {0.045f, 0.12f, 0.145f}, .specular_strength = 0.6f, .specular_exponent = 180.0f});
  Texture strata = procedural::paint("cut earth", 256, 256, [](vec2 uv) {
    const float bend = 0.05f * noise::fractal(uv * 4.0f, 3, 701, 4);
    const float layer = noise::gradient({0.5f, 9.0f * (uv.y + bend)}, 702),
                grain = noise::fractal(uv * 32.0f, 3, 703, 32);
    return glm::vec4(
        glm::mix(vec3(0.26f, 0.19f, 0.13f), vec3(0.40f, 0.32f, 0.23f), 0.5f + 0.6f * layer) * (1.0f + 0.25f * grain),
        1.0f);
  });
  m.cut = add_material(scene,
                       {.name = "cut earth", .albedo = vec3(1.0f), .texture = add_texture(scene, std::move(strata))});
  m.needles = add_material(scene, {.name = "firs", .albedo = {0.055f, 0.105f, 0.04f}});
  m.boulder = add_material(scene, {.name = "boulders", .albedo = {0.36f, 0.33f, 0.29f}});
  return m;
}

/// Adds the land as a sheet, and the four sides of its block.
void add_land(Scene& scene, const Materials& m, const Relief& field) {
  const int n = field.n - 1;
  const float step = field.step();
  Mesh land = surface(n, n, [&](float u, float v) {
    const int x = int(std::lround(u * float(n))), z = int(std::lround((1.0f - v) * float(n)));
    const vec2 p = vec2(float(x), float(z)) * step - vec2(kHalf);
    return SurfacePoint{{p.x, field.at(x, z), p.y}, {u, v}};
  });
  const int id = add_mesh(scene, "land", std::move(land), m.ground);
  Mesh sides;
  for (int side = 0; side < 4; ++side)
    append(sides, surface(n, 1, [&](float u, float v) {
             const int i = int(std::lround(u * float(n)));
             const int along[4] = {i, n, n - i, 0}, across[4] = {n, n - i, 0, i};
             const int x = along[side], z = across[side];
             const vec2 p = vec2(float(x), float(z)) * step - vec2(kHalf);
             const float y = kBase + v * (field.at(x, z) - kBase);
             return SurfacePoint{{p.x, y, p.y}, vec2(u * 2.0f * kHalf, y) / 120.0f};
           }));
  append(sides, flipped(plane(vec2(-kHalf), vec2(kHalf), kBase, 1, 1)));
  add_mesh(scene, "block", std::move(sides), m.cut, id);
  add_mesh(scene, "lake", plane(vec2(-kHalf + 0.5f), vec2(kHalf - 0.5f), kLake, 1, 1), m.water);
}

/// Makes a fir at the origin, one metre high: tiers of drooping branches with ragged edges.
Mesh fir(int slices, int tiers, std::uint32_t seed) {
  Points2 profile;
  for (int i = 0; i < tiers; ++i) {
    const float low = 0.10f + 0.86f * float(i) / float(tiers), high = 0.10f + 0.86f * float(i + 1) / float(tiers);
    const float rim = 0.21f * std::pow(1.0f - float(i) / float(tiers), 0.8f);
    profile.emplace_back(rim, low);
    profile.emplace_back(i + 1 < tiers ? 0.45f * rim : 0.0f, i + 1 < tiers ? high + 0.03f : 1.0f);
  }
  profile.insert(profile.begin(), {vec2(0.02f, 0.0f), vec2(0.02f, 0.13f)});
  const int rings = int(profile.size()) - 1;
  return surface(slices, rings,
                 [&](float u, float v) {
                   const int ring = int(std::lround(v * float(rings)));
                   const vec2 p = profile[std::size_t(ring)];
                   const int slice = int(std::lround(u * float(slices))) % slices;
                   const float ragged =
                       ring % 2 == 0 && ring > 1 ? 0.75f + 0.5f * noise::unit(noise::hash(slice, ring, seed)) : 1.0f;
                   const float angle = 2.0f * kPi * (float(slice) + 0.5f * float(ring % 2)) / float(slices);
                   return SurfacePoint{
                       {ragged * p.x * std::sin(angle), p.y - 0.05f * (ragged - 0.75f), ragged * p.x * std::cos(angle)},
                       {u, v}};
                 },
                 {.u = true});
}

/// Adds firs in the wood and boulders below the cliffs, with about `budget` triangles.
void add_cover(Scene& scene, const Materials& m, const Relief& field, int budget) {
  constexpr int kMaxFirs = 9000, kKinds = 4;
  constexpr int kMinSlices = 4, kMaxSlices = 24;
  const int tiers = budget < 20'000 ? 2 : 3;
  const int fir_budget = budget * 9 / 10;
  const auto cost = [tiers](int slices) { return 2 * slices * (2 * tiers + 1); };
  const int slices = std::clamp(fir_budget / (kMaxFirs * cost(1)), kMinSlices, kMaxSlices);
  const int firs = std::min(fir_budget / cost(slices), kMaxFirs);
  std::vector<Mesh> kinds;
  kinds.reserve(kKinds);
  for (int i = 0; i < kKinds; ++i) kinds.push_back(fir(slices, tiers, std::uint32_t(i)));
  Mesh wood;
  noise::Random random{noise::hash(801u)};
  constexpr int kTries = 40;  // per fir; enough to fill the wood, and a limit if there is none
  for (int placed = 0, tries = 0; placed < firs && tries < firs * kTries; ++tries) {
    const vec2 p(random.between(-kHalf + 6.0f, kHalf - 6.0f), random.between(-kHalf + 6.0f, kHalf - 6.0f));
    const Ground ground = ground_at(field, p);
    if (random.next() > woods(p, ground)) continue;
    const float size = random.between(6.0f, 12.5f) * (1.0f - 0.35f * glm::smoothstep(60.0f, kTreeLine, ground.height));
    // Lower the tree a little, so that its foot is in the ground on a slope too.
    Mesh tree = turned_y(scaled(kinds[std::size_t(placed % kKinds)], {size * random.between(0.85f, 1.15f), size, size}),
                         360.0f * random.next());
    append(wood, moved(std::move(tree), {p.x, ground.height - 0.06f * size, p.y}));
    ++placed;
  }
  add_mesh(scene, "wood", std::move(wood), m.needles);

  const int rock_budget = budget / 10;
  const int n = std::clamp(int(std::sqrt(float(rock_budget) / (12.0f * 220.0f))), 2, 24),
            rocks = std::min(rock_budget / (12 * n * n), 420);
  Mesh boulders;
  for (int placed = 0, tries = 0; placed < rocks && tries < rocks * kTries; ++tries) {
    const vec2 p(random.between(-kHalf + 6.0f, kHalf - 6.0f), random.between(-kHalf + 6.0f, kHalf - 6.0f));
    const Ground ground = ground_at(field, p);
    if (ground.height < kLake - 1.0f || ground.height > kSnowLine || ground.normal.y < 0.72f || ground.normal.y > 0.95f)
      continue;
    const float size = 0.8f + 3.4f * std::pow(random.next(), 3.0f);
    const std::uint32_t seed = noise::hash(std::uint32_t(placed));
    Mesh rock = cube_sphere(n, [&](vec3 out) {
      return size * (1.0f + 0.28f * noise::value(1.6f * out + vec3(float(placed)), seed) +
                     0.10f * noise::value(4.0f * out, seed));
    });
    append(boulders, moved(turned_y(scaled(std::move(rock), {1.15f, 0.75f, 0.9f}), 360.0f * random.next()),
                           {p.x, ground.height + 0.2f * size, p.y}));
    ++placed;
  }
  add_mesh(scene, "boulders", std::move(boulders), m.boulder);
}

}  // namespace

Scene make_terrain(int triangles) {
  // The land gets six tenths of the triangles, two per quad; the wood and the boulders get the rest.
  constexpr float kLandFraction = 0.6f;
  Scene scene;
  scene.name = "terrain";
  const Relief eroded = eroded_field();
  const Materials m = add_materials(scene, eroded);
  const int n = std::max(int(std::sqrt(0.5f * kLandFraction * float(triangles))), 16);
  const Relief field = mesh_field(eroded, n + 1);
  add_land(scene, m, field);
  add_cover(scene, m, field, std::max(triangles - 2 * n * n, 0));
  // The sun, and the bright part of the sky opposite to it.
  scene.lights = {{.direction = glm::normalize(vec3(-0.72f, 0.52f, 0.30f)),
                   .color = {1.12f, 1.02f, 0.86f},
                   .angle_deg = kSunAngleDeg,
                   .casts_shadow = true},
                  {.direction = glm::normalize(vec3(0.5f, 0.6f, 0.5f)),
                   .color = {0.08f, 0.09f, 0.12f},
                   .angle_deg = kFillAngleDeg}};
  scene.ambient = {0.34f, 0.40f, 0.50f};
  scene.views = {{.eye = {110.0f, 300.0f, 620.0f}, .target = {-10.0f, 50.0f, -60.0f}, .angle_deg = 40.0f},
                 {.eye = {-330.0f, 150.0f, 250.0f}, .target = {80.0f, 70.0f, -120.0f}, .angle_deg = 45.0f}};
  return scene;
}

}  // namespace umbrage
