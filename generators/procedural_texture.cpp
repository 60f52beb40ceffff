// Textures as functions of the texture coordinate, from periodic noise.
#include "generators/procedural_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "core/color.h"
#include "generators/noise.h"

namespace umbrage::procedural {

namespace {

using glm::vec2;
using glm::vec3;
using glm::vec4;

constexpr float kPi = std::numbers::pi_v<float>;

/// Converts a linear value to an sRGB byte with a table, since calling pow for each texel would take most of the time.
std::uint8_t srgb_byte(float linear) {
  constexpr int kSteps = 4096;
  static const std::array<std::uint8_t, kSteps + 1> table = [] {
    std::array<std::uint8_t, kSteps + 1> values{};
    for (int i = 0; i <= kSteps; ++i) {
      // The index is the square root of the value, so that there are more entries at the dark end, where the curve is
      // steep.
      const float root = float(i) / kSteps, x = root * root;
      values[std::size_t(i)] = std::uint8_t(std::lround(255.0f * srgb_from_linear(x)));
    }
    return values;
  }();
  return table[std::size_t(std::lround(kSteps * std::sqrt(std::clamp(linear, 0.0f, 1.0f))))];
}

float fract(float x) { return x - std::floor(x); }

/// Returns 1 inside |x| < edge, 0 outside, with a soft edge.
float band(float x, float edge, float soft) { return 1.0f - glm::smoothstep(edge - soft, edge + soft, std::abs(x)); }

vec4 opaque(vec3 color) { return vec4(color, 1.0f); }

/// Returns the brightness of woven threads, about 1.
float threads(vec2 uv, int count, float contrast) {
  const float x = uv.x * float(count), y = uv.y * float(count);
  const bool over = ((int(std::floor(x)) + int(std::floor(y))) & 1) == 0;
  const float across = over ? fract(y) : fract(x);
  return 1.0f + contrast * (std::sin(kPi * across) - 0.64f) + (over ? 0.25f : -0.25f) * contrast;
}

}  // namespace

Texture paint(std::string name, int width, int height, const std::function<vec4(vec2)>& color) {
  Texture texture{std::move(name), width, height, {}};
  texture.rgba.resize(std::size_t(width) * std::size_t(height) * 4);
  std::uint8_t* out = texture.rgba.data();
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const vec4 c = color({(float(x) + 0.5f) / float(width), 1.0f - (float(y) + 0.5f) / float(height)});
      *out++ = srgb_byte(c.x);
      *out++ = srgb_byte(c.y);
      *out++ = srgb_byte(c.z);
      *out++ = std::uint8_t(std::lround(255.0f * std::clamp(c.w, 0.0f, 1.0f)));
    }
  return texture;
}

Texture stone_blocks(int size, int columns, int rows, vec3 stone, vec3 mortar, float joint, std::uint32_t seed) {
  return paint("stone blocks", size, size, [=](vec2 uv) {
    const float y = uv.y * float(rows);
    const int row = int(std::floor(y));
    const float x = uv.x * float(columns) + 0.5f * float(row & 1);
    const int column = int(std::floor(x)) % columns;
    const std::uint32_t id = noise::hash(column, row, seed);
    const float mottle = noise::fractal(uv * 8.0f, 4, seed + 1, 8);
    const float grain = noise::gradient(uv * 128.0f, seed + 2, 128);
    const float shade = 1.0f + 0.16f * (noise::unit(id) - 0.5f) + 0.22f * mottle + 0.05f * grain;
    const vec3 tint(1.0f + 0.04f * (noise::unit(noise::hash(id)) - 0.5f), 1.0f, 1.0f - 0.06f * mottle);
    const float aspect = float(rows) / float(columns);  // width of a block over its height
    const float to_edge = std::min({fract(y), 1.0f - fract(y), aspect * fract(x), aspect * (1.0f - fract(x))});
    const float rough = joint * (1.0f + 0.5f * mottle);
    const float in_stone = joint > 0.0f ? glm::smoothstep(0.35f * rough, 0.8f * rough, to_edge) : 1.0f;
    const float worn = joint > 0.0f ? 0.9f + 0.1f * glm::smoothstep(0.0f, 5.0f * joint, to_edge) : 1.0f;
    return opaque(glm::mix(mortar * (1.0f + 0.2f * mottle), stone * tint * shade * worn, in_stone));
  });
}

Texture marble_tiles(int size, vec3 light, vec3 dark, vec3 inlay, std::uint32_t seed) {
  return paint("marble tiles", size, size, [=](vec2 uv) {
    const vec2 p = 2.0f * uv;
    const int i = int(std::floor(p.x)), j = int(std::floor(p.y));
    const vec2 f(fract(p.x), fract(p.y));
    const vec2 from_corner(0.5f - std::abs(f.x - 0.5f), 0.5f - std::abs(f.y - 0.5f));
    const float diamond = from_corner.x + from_corner.y;
    constexpr float kDiamond = 0.2f, kJoint = 0.008f;
    const float soft = 1.0f / float(size);
    const std::uint32_t slab = diamond < kDiamond ? 99u : noise::hash(i, j, seed) & 0xffu;
    const vec2 bent = uv * 6.0f + 0.8f * vec2(noise::gradient(uv * 4.0f, seed + slab, 4),
                                              noise::gradient(uv * 4.0f, seed + slab + 7, 4));
    const float cloud = noise::fractal(bent, 4, seed + slab, 6);
    const float vein = std::exp(-18.0f * std::abs(noise::gradient(bent, seed + 3 + slab, 6)));
    const vec3 base = diamond < kDiamond ? inlay : ((i + j) & 1) ? dark : light;
    const float shade = 1.0f + 0.12f * cloud + 0.08f * (noise::unit(noise::hash(slab)) - 0.5f);
    const vec3 stone = base * shade * (1.0f - 0.22f * vein);
    const float joint = std::min(std::min(from_corner.x, from_corner.y) + (diamond < kDiamond ? 1.0f : 0.0f),
                                 std::abs(diamond - kDiamond) * 0.7f);
    return opaque(stone * glm::mix(0.45f, 1.0f, glm::smoothstep(kJoint - soft, kJoint + 2.0f * soft, joint)));
  });
}

Texture plaster(int size, vec3 color, float contrast, std::uint32_t seed) {
  return paint("plaster", size, size, [=](vec2 uv) {
    const float cloud = noise::fractal(uv * 3.0f, 5, seed, 3);
    const float grain = noise::gradient(uv * 96.0f, seed + 9, 96);
    return opaque(color * (1.0f + contrast * (1.6f * cloud + 0.25f * grain)));
  });
}

Texture wood(int size, int boards, vec3 light, vec3 dark, std::uint32_t seed) {
  return paint("wood", size, size, [=](vec2 uv) {
    const float y = uv.y * float(boards);
    const int row = int(std::floor(y));
    const float shift = boards > 1 ? noise::unit(noise::hash(row, 1, seed)) : 0.0f;
    const float x = uv.x + shift;
    const std::uint32_t id = noise::hash(row, boards > 1 ? int(std::floor(2.0f * x)) % 2 : 0, seed);
    const float offset = 8.0f * noise::unit(noise::hash(id));
    // Rings stretched along the board; noise bends them around knots.
    const float bend = noise::gradient({uv.x * 4.0f, y * 1.5f + offset}, seed + (id & 15u), 0);
    // A single plank shows many fine rings; one board of several shows a few.
    const float count = boards > 1 ? 3.5f : 14.0f, sway = boards > 1 ? 0.2f : 0.07f;
    const float rings = fract(count * (fract(y) + sway * bend * std::sin(2.0f * kPi * uv.x + offset)) + offset);
    const float early = glm::smoothstep(0.0f, 0.75f, rings) * (1.0f - glm::smoothstep(0.85f, 1.0f, rings));
    const float fibre = noise::fractal({uv.x * 16.0f, uv.y * float(boards) * 40.0f}, 2, seed + 5);
    float tone = 0.55f * early + 0.3f * fibre + 0.45f * (noise::unit(id) - 0.5f);
    tone = std::clamp(0.35f + 0.6f * tone, 0.0f, 1.0f);
    vec3 color = glm::mix(light, dark, tone);
    if (boards > 1) {
      const float from_side = std::min(fract(y), 1.0f - fract(y)) / float(boards);
      const float from_end = std::min(fract(2.0f * x), 1.0f - fract(2.0f * x)) * 0.5f;
      const float gap = glm::smoothstep(0.0008f, 0.0035f, std::min(from_side, from_end));
      color *= 0.35f + 0.65f * gap;
    }
    return opaque(color);
  });
}

Texture damask(int size, vec3 ground, vec3 figure) {
  return paint("damask", size, size, [=](vec2 uv) {
    // One field in the middle of the repeat and an equal one around its corners.
    float ink = 0.0f;
    for (const vec2 centre :
         {vec2(0.5f, 0.5f), vec2(0.0f, 0.0f), vec2(1.0f, 0.0f), vec2(0.0f, 1.0f), vec2(1.0f, 1.0f)}) {
      const vec2 p = uv - centre;
      constexpr vec2 kField(0.18f, 0.35f);  // extent of a flower
      if (std::abs(p.x) > kField.x || std::abs(p.y) > kField.y) continue;
      const float radius = glm::length(p), angle = std::atan2(p.x, p.y);
      const float petals = 0.115f + 0.055f * std::cos(6.0f * angle);
      ink = std::max(ink, band(radius, petals, 0.008f) * (1.0f - band(radius, 0.045f, 0.006f)));
      ink = std::max(ink, band(radius, 0.026f, 0.006f));
      // A stem above and below with a bud at its end.
      const float curl = 0.02f * std::sin(26.0f * p.y);
      ink = std::max(ink, band(p.x - curl, 0.008f, 0.004f) * band(std::abs(p.y) - 0.22f, 0.07f, 0.01f));
      const vec2 bud(p.x, std::abs(p.y) - 0.30f);
      ink = std::max(ink, band(glm::length(bud * vec2(1.5f, 1.0f)), 0.035f, 0.006f));
    }
    // The ogee net between the fields consists of two waves that meet.
    const float wave = 0.25f * std::cos(2.0f * kPi * uv.y);
    for (const float line : {0.25f + wave * 0.85f, 0.75f - wave * 0.85f}) {
      const float offset = fract(uv.x - line + 0.5f) - 0.5f;
      ink = std::max(ink, band(std::abs(offset) - 0.03f, 0.009f, 0.004f));
    }
    return opaque(glm::mix(ground, figure, ink) * threads(uv, 96, 0.16f));
  });
}

Texture weave(int size, int count, vec3 color, float contrast, std::uint32_t seed) {
  return paint("weave", size, size, [=](vec2 uv) {
    const float uneven = noise::fractal(uv * 6.0f, 3, seed, 6);
    return opaque(color * threads(uv, count, contrast) * (1.0f + 0.5f * contrast * uneven));
  });
}

Texture stripes(int size, std::span<const vec3> colors, std::uint32_t seed) {
  const std::vector<vec3> palette(colors.begin(), colors.end());
  return paint("stripes", size, size, [=](vec2 uv) {
    const float x = uv.x * float(palette.size());
    const vec3 color = palette[std::size_t(std::floor(x)) % palette.size()];
    return opaque(color * threads(uv, 64, 0.15f) * (1.0f + 0.06f * noise::fractal(uv * 6.0f, 3, seed, 6)));
  });
}

Texture carpet(int width, int height, vec3 field, vec3 border, vec3 figure, std::uint32_t seed) {
  const float aspect = float(width) / float(height);
  return paint("carpet", width, height, [=](vec2 uv) {
    const vec2 p((uv.x - 0.5f) * aspect, uv.y - 0.5f);
    const vec2 from_edge(0.5f * aspect - std::abs(p.x), 0.5f - std::abs(p.y));
    const float edge = std::min(from_edge.x, from_edge.y);
    const float along = from_edge.x < from_edge.y ? p.y : p.x;
    const vec3 deep = field * 0.35f;
    vec3 color = field;
    if (edge < 0.025f) {  // NOLINT(bugprone-branch-clone)
      color = deep;
    } else if (edge < 0.05f) {  // NOLINT(bugprone-branch-clone): stripes, from the edge inwards
      color = figure;
    } else if (edge < 0.15f) {  // rosettes in a row
      const float x = fract(along * 12.0f) - 0.5f, y = (edge - 0.1f) * 12.0f;
      const float r = std::sqrt(x * x + y * y), a = std::atan2(y, x);
      color = glm::mix(border, figure, band(r, 0.3f + 0.08f * std::cos(8.0f * a), 0.03f));
      color = glm::mix(color, deep, band(r, 0.12f, 0.03f));
    } else if (edge < 0.165f) {
      color = figure;
    } else if (edge < 0.18f) {
      color = deep;
    } else {
      // Small diamonds scattered in a grid, and a medallion of lobed rings over them.
      const vec2 g(fract(p.x * 14.0f) - 0.5f, fract(p.y * 14.0f) - 0.5f);
      color = glm::mix(field, border * 1.1f, band(std::abs(g.x) + std::abs(g.y), 0.2f, 0.03f));
      const vec2 q(p.x / std::min(aspect, 1.5f) * 1.15f, p.y * 1.15f);
      const float r = glm::length(q), a = std::atan2(q.y, q.x);
      const float lobes = 0.24f + 0.022f * std::abs(std::cos(8.0f * a));
      if (r < lobes) color = border;
      if (std::abs(r - lobes) < 0.006f) color = figure;
      if (r < 0.19f)
        color = glm::mix(border, figure, band(std::abs(r - 0.15f) - 0.02f * std::cos(16.0f * a), 0.012f, 0.004f));
      if (r < 0.09f + 0.02f * std::cos(8.0f * a)) color = field * 0.6f;
      if (r < 0.045f) color = figure;
    }
    const float pile = noise::fractal(uv * vec2(90.0f, 60.0f), 2, seed);
    return opaque(color * (0.95f + 0.22f * pile + 0.05f * std::sin(uv.y * 240.0f * kPi)));
  });
}

Texture leaf(int size, vec3 color, vec3 vein) {
  return paint("leaf", size, size, [=](vec2 uv) {
    const float x = uv.x - 0.5f, t = uv.y;
    const float width = 0.46f * std::pow(std::sin(kPi * std::pow(std::clamp(t, 0.0f, 1.0f), 0.75f)), 0.8f);
    const float inside = width - std::abs(x);
    const float rib = band(x, 0.012f + 0.012f * (1.0f - t), 0.006f);
    const float side = std::abs(fract(9.0f * (t - 0.55f * std::abs(x))) - 0.5f);
    const float veins = 0.55f * band(side, 0.045f, 0.04f) * band(x, 0.4f, 0.1f);
    const float shade = 0.85f + 0.25f * t + 0.5f * std::abs(x) + 0.15f * noise::fractal(uv * 9.0f, 3, 5u);
    // The colour continues beyond the edge, so that filtering does not blend with black.
    return vec4(glm::mix(color * shade, vein, std::max(rib, veins)), 0.5f + 40.0f * inside);
  });
}

Texture frond(int width, int height, vec3 color, vec3 rib) {
  return paint("frond", width, height, [=](vec2 uv) {
    const float x = std::abs(2.0f * uv.x - 1.0f), t = uv.y;
    const float reach = 0.97f * std::pow(std::sin(kPi * std::clamp(0.12f + 0.88f * t, 0.0f, 1.0f)), 0.55f);
    // Leaflets lean towards the tip; each is a spindle around its own axis.
    const float along = 17.0f * (t - 0.16f * x) + (uv.x < 0.5f ? 0.5f : 0.0f);
    const float fraction = x / std::max(reach, 0.01f);
    const float half = 0.44f * std::sqrt(std::max(1.0f - fraction, 0.0f)) * (0.5f + 1.2f * std::min(fraction, 0.42f));
    const float inside = std::max(half - std::abs(fract(along) - 0.5f), 0.0f) * (fraction < 1.0f ? 1.0f : 0.0f);
    const float on_rib = 0.035f + 0.02f * (1.0f - t) - x;
    const float shade = 0.8f + 0.35f * t + 0.25f * std::abs(fract(along) - 0.5f) * 2.0f;
    const vec3 c = on_rib > 0.0f ? rib : color * shade;
    return vec4(c, std::max(inside * 12.0f, on_rib > 0.0f && t < 0.98f ? 1.0f : 0.0f));
  });
}

Texture lattice(int size, int cells, float bar, vec3 color) {
  return paint("lattice", size, size, [=](vec2 uv) {
    const float a = fract(float(cells) * (uv.x + uv.y)) - 0.5f, b = fract(float(cells) * (uv.x - uv.y)) - 0.5f;
    const float to_bar = std::min(std::abs(a), std::abs(b));
    const float to_rivet = glm::length(vec2(a, b)) - 0.9f * bar;  // rivets project from the bars
    const float outside = std::min(to_bar, to_rivet) - bar;
    return vec4(color * (1.2f - 0.4f * to_bar / bar), outside < 0.0f ? 1.0f : 0.5f - 20.0f * outside);
  });
}

Texture book_spines(int width, int height, int books, std::uint32_t seed) {
  static constexpr vec3 kCloth[] = {{0.24f, 0.03f, 0.03f}, {0.04f, 0.09f, 0.22f}, {0.03f, 0.13f, 0.07f},
                                    {0.36f, 0.24f, 0.10f}, {0.10f, 0.05f, 0.03f}, {0.50f, 0.44f, 0.32f},
                                    {0.30f, 0.10f, 0.03f}, {0.06f, 0.13f, 0.15f}, {0.42f, 0.08f, 0.06f}};
  static constexpr vec3 kGold(0.62f, 0.42f, 0.13f);
  return paint("book spines", width, height, [=](vec2 uv) {
    const float x = uv.x * float(books);
    const int book = int(std::floor(x));
    const std::uint32_t id = noise::hash(book, 3, seed);
    vec3 color = kCloth[id % std::size(kCloth)];
    const float lines = 1.0f + float((id >> 8) % 3u);
    const float band_at = 0.08f + 0.1f * noise::unit(noise::hash(id));
    const float edge = std::min(uv.y, 1.0f - uv.y);
    if (std::abs(edge - band_at) < 0.012f * lines && fract((edge - band_at) / 0.016f) > 0.4f) color = kGold;
    // A title: a label with a few strokes.
    const bool label = (id >> 16) % 2u == 0;
    if (std::abs(uv.y - 0.66f) < 0.11f && std::abs(fract(x) - 0.5f) < 0.33f) {
      if (label) color *= 0.45f;
      const int row = int(std::floor(uv.y * 46.0f)), glyph = int(std::floor(fract(x) * 13.0f));
      if (row % 2 == 0 && noise::unit(noise::hash(row, glyph, id)) > 0.4f) color = kGold;
    }
    return opaque(color * (0.9f + 0.25f * noise::fractal(uv * vec2(float(books) * 4.0f, 24.0f), 3, seed)));
  });
}

Texture landscape_painting(int width, int height, std::uint32_t seed) {
  return paint("landscape painting", width, height, [=](vec2 uv) {
    // Brush strokes: the lookup position is offset in streaks.
    const vec2 p = uv + 0.012f * vec2(noise::fractal(uv * vec2(40.0f, 90.0f), 2, seed + 20),
                                      noise::fractal(uv * vec2(60.0f, 60.0f), 2, seed + 24));
    const float cloud = glm::smoothstep(0.0f, 0.5f, noise::fractal(p * vec2(3.0f, 7.0f), 4, seed));
    vec3 color = glm::mix(vec3(0.80f, 0.66f, 0.46f), vec3(0.20f, 0.38f, 0.62f), glm::smoothstep(0.45f, 1.0f, p.y));
    color = glm::mix(color, vec3(0.88f, 0.82f, 0.74f), 0.8f * cloud);
    constexpr int kRanges = 4;
    for (int i = 0; i < kRanges; ++i) {
      const float near = float(i) / float(kRanges - 1);
      const float top = 0.62f - 0.36f * near +
                        (0.16f - 0.05f * near) * noise::fractal({p.x * (2.5f + near) + 5.0f * float(i), 0.5f}, 4,
                                                                seed + 30 + std::uint32_t(i));
      if (p.y < top)
        color = glm::mix(vec3(0.36f, 0.44f, 0.56f), vec3(0.10f, 0.16f, 0.05f), near) *
                (0.9f + 0.5f * noise::fractal(p * vec2(30.0f, 50.0f), 2, seed + 40));
    }
    if (p.y < 0.2f)
      color = glm::mix(vec3(0.55f, 0.38f, 0.08f), vec3(0.20f, 0.20f, 0.04f),
                       0.5f + 0.9f * noise::fractal(p * vec2(6.0f, 40.0f), 3, seed + 50));
    return opaque(color * (0.92f + 0.2f * noise::fractal(uv * vec2(90.0f, 130.0f), 2, seed + 60)));
  });
}

}  // namespace umbrage::procedural
