#include "apps/figures/bleeding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "apps/figures/drawing.h"
#include "apps/figures/measure.h"
#include "effects/hemisphere/hemisphere.h"

namespace umbrage {
namespace {

using glm::vec2;
using glm::vec3;

constexpr vec3 kPixel{0.85f, 0.15f, 0.1f}, kSample{0.0f, 0.35f, 0.1f}, kSurface{0.35f, 0.75f, 0.3f};
constexpr vec3 kOpen{0.62f}, kSolid{0.9f}, kLight{0.95f, 0.6f, 0.1f}, kNormal{0.2f, 0.3f, 0.75f};
constexpr float kPi = std::numbers::pi_v<float>;
constexpr double kAnything = 1e30;
constexpr std::string_view kFewPoints = "hemisphere.samples=24", kSmallRadius = "hemisphere.radius=1%";
constexpr float kRounding = 2e-6f;  // min relative difference of two depths, as in hemisphere.kernel.h

/// Returns the width of thin lines for a diagram of `size` pixels per side.
float line_width(int size) { return std::max(1.0f, float(size) / 350.0f); }
/// Returns the scale of text for a diagram of `size` pixels per side.
int text_scale(int size) { return std::max(1, size / 380); }

void write_centered(Image& image, float x, float y, std::string text, vec3 color = kInk) {
  const int scale = text_scale(image.width);
  const int left = std::clamp(int(x) - text_width(text, scale) / 2, 2, image.width - text_width(text, scale) - 2);
  write_text(image, left, int(y) - 4 * scale, scale, std::move(text), color);
}

/// Returns the constants of `hemisphere`, with its sample tables, for these settings.
Result<HemisphereConstants> tables_of(const Request& draw, const PictureInfo& info) {
  const auto recipe = make_recipe(draw);
  if (!recipe) return recipe.error();
  HemisphereConstants c;
  const Effect& effect = effect_with<HemisphereParams>();
  effect.constants(params_of(recipe->settings, effect.name), info, &c);
  return c;
}

/// Returns sample point k in a basis whose z axis is the normal, in units of the radius, for a pixel whose
/// samples are not shifted.
vec3 sample_point(const HemisphereConstants& c, int k) {
  return vec3(c.points[5 * k], c.points[5 * k + 1], c.points[5 * k + 2]) * (c.even ? c.points[5 * k + 3] : 1.0f);
}

FigurePicture points_diagram(const HemisphereConstants& c, int size, std::string file, std::string caption) {
  Image image = blank_paper(size, size);
  const float line = line_width(size), radius = 0.42f * float(size);
  const vec2 center(0.5f * float(size), 0.66f * float(size));
  fill(image, int(0.04f * float(size)), int(center.y), int(0.96f * float(size)), int(center.y + 0.06f * float(size)),
       kSolid);
  draw_line(image, {0.04f * float(size), center.y}, {0.96f * float(size), center.y}, 2.0f * line, kInk);
  draw_arc(image, center, radius, 0.0f, kPi, line, kOpen);
  draw_arrow(image, center, center - vec2(0.0f, 1.2f * radius), 2.0f * line, kNormal);
  write_centered(image, center.x, center.y - 1.27f * radius, "normal", kNormal);
  // Farther points are paler.
  for (int k = 0; k < c.samples; ++k) {
    const vec3 p = sample_point(c, k);
    draw_disc(image, center + radius * vec2(p.x, -p.z), 3.0f * line,
              glm::mix(kSample, glm::mix(kSample, vec3(1.0f), 0.7f), 0.5f + 0.5f * p.y));
  }
  draw_disc(image, center, 4.0f * line, kPixel);
  write_centered(image, center.x, center.y + 0.1f * float(size),
                 fmt::format("{} sample points, from the side", c.samples));
  return {std::move(file), std::move(caption), "", std::move(image)};
}

Image shrunk(const Image& image, int side) {
  const Image small = downsample(image, (image.width + side - 1) / side);
  Image out = blank_paper(side, side);
  paste(out, small, (side - small.width) / 2, (side - small.height) / 2, side);
  return out;
}

/// Returns three planes as an image: factor * value + offset.
Image planes_as_image(const Shot& shot, std::array<const char*, 3> planes, float factor, float offset) {
  Image out(shot.image.width, shot.image.height);
  constexpr std::array kChannels = {"color.r", "color.g", "color.b"};
  for (std::size_t k = 0; k < 3; ++k) {
    Plane& plane = out.add(kChannels[k]) = shot.image.plane(planes[k]);
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x) plane.at(x, y) = factor * plane.at(x, y) + offset;
  }
  return out;
}

/// Returns the world position of each pixel's surface as a colour, normalized to the bounds of the visible surfaces.
Image position_picture(const Shot& shot) {
  Image out = blank_paper(shot.image.width, shot.image.height);
  vec3 low(1e30f), high(-1e30f);
  const auto visit = [&](const auto& each) {
    for (int y = 0; y < out.height; ++y)
      for (int x = 0; x < out.width; ++x)
        if (shot.surface(x, y)) each(x, y, shot.world(x, y));
  };
  visit([&](int, int, vec3 p) { low = glm::min(low, p), high = glm::max(high, p); });
  visit([&](int x, int y, vec3 p) {
    const vec3 fraction = (p - low) / glm::max(high - low, vec3(1e-6f));
    out.plane("color.r").at(x, y) = fraction.x, out.plane("color.g").at(x, y) = fraction.y;
    out.plane("color.b").at(x, y) = fraction.z;
  });
  return out;
}

/// Returns the depth as an image: near is bright.
Image depth_picture(const Shot& shot) {
  Image out = blank_paper(shot.image.width, shot.image.height);
  float min = 1e30f, max = 0.0f;
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      if (shot.surface(x, y)) {
        min = std::min(min, shot.value("depth", x, y));
        max = std::max(max, shot.value("depth", x, y));
      }
  for (Plane& plane : out.planes)
    for (int y = 0; y < out.height; ++y)
      for (int x = 0; x < out.width; ++x)
        plane.at(x, y) =
            shot.surface(x, y) ? 1.0f - (shot.value("depth", x, y) - min) / std::max(max - min, 1e-6f) : 0.0f;
  return out;
}

/// Returns the noise tile as an image: the tangents of the pixels of one flat face.
Image noise_tile(const Shot& shot, int tile, int side) {
  Image out = blank_paper(side, side);
  // On a face of constant normal the tangents are points of one circle, so one tile of any flat face shows all of them.
  const int cell = side / tile, width = shot.image.width, height = shot.image.height;
  const VectorPlanes normal(shot.image, "normal"), tangent(shot.image, "tangent");
  const auto flat = [&](int x, int y) {
    for (int j = 0; j < tile; ++j)
      for (int i = 0; i < tile; ++i)
        if (normal.at(x + i, y + j) != normal.at(x, y)) return false;
    return shot.surface(x, y);
  };
  for (int y = 0; y + tile <= height; y += tile)
    for (int x = 0; x + tile <= width; x += tile) {
      if (!flat(x, y)) continue;
      for (int j = 0; j < tile; ++j)
        for (int i = 0; i < tile; ++i) {
          const vec3 t = tangent.at(x + i, y + j);
          fill(out, i * cell, j * cell, (i + 1) * cell, (j + 1) * cell, 0.5f * t + 0.5f);
        }
      return out;
    }
  return out;
}

FigurePicture pipeline_diagram(const Shot& raw, const Shot& blurred, const Image& kernel) {
  const int size = raw.image.width, gap = size / 18, label = kLetterHeight * text_scale(size);
  const int side = (size - 5 * gap) / 4, row = side + 2 * label + gap / 2;
  const int top = (size - 3 * row) / 2;
  Image image = blank_paper(size, size);
  const auto left_of = [&](int column) { return gap + column * (side + gap); };
  const auto top_of = [&](int line) { return top + line * row; };
  const auto place = [&](int column, int line, const Image& picture, const char* name) {
    paste(image, shrunk(picture, side), left_of(column), top_of(line), side);
    write_centered(image, float(left_of(column)) + 0.5f * float(side), float(top_of(line) + side + label), name);
  };
  constexpr float kBrighten = 2.0f;  // brightens indirect light, which is dim
  place(0, 0, position_picture(raw), "position");
  place(0, 1, planes_as_image(raw, {"normal.x", "normal.y", "normal.z"}, 0.5f, 0.5f), "normal");
  place(0, 2, depth_picture(raw), "depth");
  place(1, 0, kernel, "kernel");
  place(1, 1, noise_tile(raw, 4, side), "noise");
  place(1, 2, planes_as_image(raw, {"direct.r", "direct.g", "direct.b"}, 1.0f, 0.0f), "direct light");
  place(2, 0, planes_as_image(raw, {"ao", "ao", "ao"}, 1.0f, 0.0f), "occlusion");
  place(2, 1, planes_as_image(raw, {"indirect.r", "indirect.g", "indirect.b"}, kBrighten, 0.0f), "bleeding, x2");
  place(3, 0, planes_as_image(blurred, {"ao", "ao", "ao"}, 1.0f, 0.0f), "blurred");
  place(3, 1, planes_as_image(blurred, {"indirect.r", "indirect.g", "indirect.b"}, kBrighten, 0.0f), "blurred, x2");
  place(3, 2, planes_as_image(blurred, {"color.r", "color.g", "color.b"}, 1.0f, 0.0f), "result");
  const float line = 2.0f * line_width(size), pad = 0.12f * float(gap);
  const auto across = [&](int from, int to, int at) {
    const float y = float(top_of(at)) + 0.5f * float(side);
    draw_arrow(image, {float(left_of(from) + side) + pad, y}, {float(left_of(to)) - pad, y}, line, kInk);
  };
  for (const int at : {0, 1}) {
    across(0, 1, at), across(1, 2, at), across(2, 3, at);
  }
  across(1, 3, 2);
  const float x = float(left_of(3)) + 0.5f * float(side);
  draw_arrow(image, {x, float(top_of(1) + side + 2 * label)}, {x, float(top_of(2)) - pad}, line, kInk);
  // Direct light is the source of the indirect light.
  draw_arrow(image, {float(left_of(1) + side) + pad, float(top_of(2)) + 0.2f * float(side)},
             {float(left_of(2)) + 0.15f * float(side), float(top_of(1) + side + 2 * label)}, line, kInk);
  return {"bleeding-3-pipeline.png", "3: the steps", "", std::move(image)};
}

/// A sample point of a pixel, as the kernel places it.
struct Tap {
  vec3 point;         // view space
  vec3 seen, facing;  // position and normal of the visible surface at the point's pixel, view space
  bool inside = false, occluded = false;
  float cos_emitter = 0.0f, cos_receiver = 0.0f;
  bool contributes_light() const { return occluded && cos_emitter > 0.0f && cos_receiver > 0.0f; }
};
/// A pixel with its sample points. Position and normal are in view space.
struct Gathered {
  int x = 0, y = 0;
  vec3 position, normal;
  std::vector<Tap> taps;
};

vec3 view_position(const Shot& shot, int x, int y) {
  const Camera& camera = shot.info.camera;
  const float d = shot.value("depth", x, y);
  return {(camera.left + (float(x) + 0.5f) / float(shot.info.width) * (camera.right - camera.left)) * d,
          (camera.top - (float(y) + 0.5f) / float(shot.info.height) * (camera.top - camera.bottom)) * d, -d};
}

Gathered gather(const Shot& shot, const HemisphereConstants& c, int x, int y) {
  const VectorPlanes normals(shot.image, "normal");
  Gathered g{x, y, view_position(shot, x, y), normals.at(x, y), {}};
  const vec3 tangent = VectorPlanes(shot.image, "tangent").at(x, y), across = glm::cross(g.normal, tangent);
  for (int k = 0; k < c.samples; ++k) {
    const vec3 p = sample_point(c, k);
    Tap tap;
    tap.point = g.position + c.radius * (p.x * tangent + p.y * across + p.z * g.normal);
    const int u = int(std::floor(tap.point.x / -tap.point.z * c.scale_x[0] + c.offset_x[0]));
    const int v = int(std::floor(tap.point.y / -tap.point.z * c.scale_y[0] + c.offset_y[0]));
    tap.inside = tap.point.z < 0.0f && u >= 0 && v >= 0 && u < shot.info.width && v < shot.info.height;
    if (tap.inside && shot.surface(u, v)) {
      tap.seen = view_position(shot, u, v);
      tap.facing = normals.at(u, v);
      const auto window = [&](float depth) {
        return c.window_one - c.window_inverse / std::clamp(depth, c.near_depth, c.far_depth);
      };
      const float fall = c.depth_at_limit / -g.position.z;  // the quadratic range
      tap.occluded = tap.point.z < tap.seen.z - kRounding * -g.position.z &&
                     std::abs(window(-g.position.z) - window(-tap.seen.z)) < c.limit * fall * fall;
      const vec3 way = glm::normalize(tap.seen - g.position);
      tap.cos_emitter = -glm::dot(way, tap.facing), tap.cos_receiver = glm::dot(way, g.normal);
    }
    g.taps.push_back(tap);
  }
  return g;
}

/// Returns the normal of the section, which is the plane through the camera and the pixel's row.
vec3 section_normal(const Gathered& g) { return glm::normalize(vec3(0.0f, 1.0f, g.position.y / -g.position.z)); }

/// Returns whether a sample point is close enough to the section to be drawn in it.
bool is_near_section(const Gathered& g, const Tap& tap, float radius) {
  constexpr float kNear = 0.3f;  // max distance, relative to the radius
  return std::abs(glm::dot(tap.point - g.position, section_normal(g))) < kNear * radius;
}

FigurePicture section_diagram(const Shot& shot, const HemisphereConstants& c, const Gathered& g) {
  const int size = shot.info.width, y = g.y;
  Image image = blank_paper(size, size);
  const float line = line_width(size), scale = 0.36f * float(size) / c.radius;
  const float pixel_depth = -g.position.z;
  // The view is from above: x to the right, the camera below.
  const vec2 center(0.5f * float(size), 0.385f * float(size));  // above the legend
  const auto at = [&](vec3 p) { return center + scale * vec2(p.x - g.position.x, p.z - g.position.z); };
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      const float px = (float(i) + 0.5f - center.x) / scale + g.position.x;
      const float d = pixel_depth - (float(j) + 0.5f - center.y) / scale;
      const int u = int(std::floor(px / d * c.scale_x[0] + c.offset_x[0]));
      if (d <= 0.0f || u < 0 || u >= size || !(d > shot.value("depth", u, y))) continue;
      for (Plane& plane : image.planes) plane.at(i, j) = kSolid.x;
    }
  for (int u = 0; u + 1 < size; ++u) {
    if (!shot.surface(u, y) || !shot.surface(u + 1, y)) continue;
    const vec3 a = view_position(shot, u, y), b = view_position(shot, u + 1, y);
    constexpr float kOneSurface = 0.02f;  // max depth difference within one surface, relative to the radius
    if (std::abs(a.z - b.z) < kOneSurface * c.radius + 4.0f * std::abs(a.x - b.x))
      draw_line(image, at(a), at(b), 2.0f * line, kInk);
  }
  // The section of the sphere that contains the sample points.
  draw_arc(image, center, scale * c.radius, 0.0f, 2.0f * kPi, line, kOpen);
  for (const Tap& tap : g.taps) {
    if (!is_near_section(g, tap, c.radius)) continue;
    if (tap.occluded) {
      draw_line(image, at(tap.point), at(tap.seen), line, kSurface);
      const vec2 to(tap.facing.x, tap.facing.z);
      draw_arrow(image, at(tap.seen), at(tap.seen) + 0.09f * float(size) * to, 1.5f * line, kNormal);
      if (tap.contributes_light())
        draw_arrow(image, at(tap.seen), glm::mix(at(tap.seen), center, 0.93f), 1.5f * line, kLight);
      draw_disc(image, at(tap.seen), 3.5f * line, kSurface);
    }
    draw_disc(image, at(tap.point), 3.5f * line, tap.occluded ? kSample : kOpen);
  }
  draw_arrow(image, center, center + 0.14f * float(size) * vec2(g.normal.x, g.normal.z), 2.0f * line, kPixel);
  draw_disc(image, center, 5.0f * line, kPixel);
  const int scale_text = text_scale(size), step = int(1.2f * float(kLetterHeight * scale_text));
  int text_y = size - 5 * step - step / 2;
  fill(image, 0, text_y - step / 2, 3 * step + text_width("its occluder, with its normal", scale_text), size,
       vec3(1.0f));
  for (const auto& [text, color] : {std::pair{"the pixel and its normal", kPixel},
                                    {"sample point, occluded", kSample},
                                    {"its occluder, with its normal", kSurface},
                                    {"light that it reflects", kLight},
                                    {"sample point, open", kOpen}}) {
    draw_disc(image, {float(step), float(text_y) + 4.0f * float(scale_text)}, 3.5f * line, color);
    write_text(image, 2 * step, text_y, scale_text, text);
    text_y += step;
  }
  return {"bleeding-4-section.png", "4: one row of depths", "", std::move(image)};
}

FigurePicture angles_diagram(const Gathered& g, const Tap& tap, int size) {
  Image image = blank_paper(size, size);
  const float line = line_width(size), s = float(size);
  // Drawn in the plane of the receiver's normal and the connecting direction; the emitter's normal is rotated into it.
  const float receiver = std::acos(std::clamp(tap.cos_receiver, -1.0f, 1.0f));
  const float emitter = std::acos(std::clamp(tap.cos_emitter, -1.0f, 1.0f));
  const vec2 p(0.2f * s, 0.75f * s);
  const auto toward = [](float angle_rad) { return vec2(std::cos(angle_rad), -std::sin(angle_rad)); };
  const float up = 0.5f * kPi, way = std::max(up - receiver, 0.12f * kPi);
  const float normal = way + receiver;  // direction of the receiver's normal
  const vec2 q = p + 0.58f * s * toward(way);
  const float back = way + kPi, facing = back - emitter;
  const auto surface = [&](vec2 at, float normal_rad) {
    const vec2 along = 0.13f * s * toward(normal_rad + up);
    draw_line(image, at - along, at + along, 3.0f * line, kInk);
    draw_arrow(image, at, at + 0.2f * s * toward(normal_rad), 2.0f * line, kNormal);
  };
  surface(p, normal);
  surface(q, facing);
  draw_arrow(image, q, p + 0.02f * s * toward(way), 2.0f * line, kLight);
  draw_arc(image, p, 0.12f * s, way, normal, 1.5f * line, kPixel);
  draw_arc(image, q, 0.12f * s, facing, back, 1.5f * line, kPixel);
  draw_disc(image, p, 4.0f * line, kPixel);
  draw_disc(image, q, 4.0f * line, kSample);
  const auto degrees = [](float rad) { return rad * 180.0f / kPi; };
  const auto label_at = [&](float angle_rad) { return (angle_rad < 0.9f ? 0.27f : 0.19f) * s; };
  const vec2 at_p = p + label_at(receiver) * toward(0.5f * (way + normal)),
             at_q = q + label_at(emitter) * toward(0.5f * (facing + back));
  write_centered(image, at_p.x, at_p.y, fmt::format("{:.0f} deg", degrees(receiver)), kPixel);
  write_centered(image, at_q.x, at_q.y, fmt::format("{:.0f} deg", degrees(emitter)), kPixel);
  write_centered(image, p.x, p.y + 0.13f * s, "original fragment");
  const vec2 behind = q - 0.08f * s * toward(facing), middle = 0.5f * (p + q) - 0.13f * s * toward(way + up);
  write_centered(image, behind.x + 0.1f * s, behind.y, "occluding fragment");
  write_centered(image, middle.x, middle.y, fmt::format("d = {:.2f} m", glm::length(tap.seen - g.position)));
  return {"bleeding-6-angles.png", "6: angles of a real pair", "", std::move(image)};
}

/// Returns the pixel for the section: in the middle rows, the one that receives the most indirect light from surfaces
/// that are perpendicular to the section. It has no taps if no such pixel exists.
Gathered best_section(const Shot& folds, const HemisphereConstants& c) {
  const int size = folds.info.width;
  Gathered best;
  float max = 0.0f;
  for (int y = size / 4; y < size * 3 / 4; y += std::max(1, size / 64))
    for (int x = 0; x < size; x += std::max(1, size / 128)) {
      if (!folds.surface(x, y)) continue;
      Gathered g = gather(folds, c, x, y);
      if (!std::all_of(g.taps.begin(), g.taps.end(), [](const Tap& tap) { return tap.inside; })) continue;
      const vec3 off = section_normal(g);
      float worth = 0.0f;
      for (const Tap& tap : g.taps)
        if (tap.contributes_light() && is_near_section(g, tap, c.radius))
          worth += tap.cos_emitter * (1.0f - std::abs(glm::dot(tap.facing, off)));
      worth *= 1.0f - std::abs(glm::dot(g.normal, off));
      if (worth <= max) continue;
      max = worth;
      best = std::move(g);
    }
  return best;
}

/// Returns the tap that makes the clearest diagram: both angles far from 0 and from 90 degrees.
const Tap& clearest_pair(const Gathered& g) {
  const auto clear = [](float cosine) { return cosine * std::sqrt(std::max(1.0f - cosine * cosine, 0.0f)); };
  const auto worth = [&](const Tap& tap) {
    return tap.contributes_light() ? std::min(clear(tap.cos_emitter), clear(tap.cos_receiver)) : -1.0f;
  };
  return *std::max_element(g.taps.begin(), g.taps.end(),
                           [&](const Tap& a, const Tap& b) { return worth(a) < worth(b); });
}

/// Returns the fraction of the sample points for which `part` is true.
template <class Part>
double fraction_of_points(const HemisphereConstants& c, const Part& part) {
  int count = 0;
  for (int k = 0; k < c.samples; ++k) count += part(sample_point(c, k));
  return double(count) / c.samples;
}
bool is_above(vec3 p) { return p.z >= 0.0f && glm::length(p) <= 1.0f; }
bool is_inner(vec3 p) { return glm::length(p) < 0.5f; }

}  // namespace

Result<Figure> bleeding_diagrams(Studio& studio, const Framing& view) {
  studio.framing = view;
  const std::vector<std::string> planes = {"normal.x",  "normal.y",   "normal.z",   "tangent.x",  "tangent.y",
                                           "tangent.z", "indirect.r", "indirect.g", "indirect.b", "direct.r",
                                           "direct.g",  "direct.b",   "ao"};
  const int size = studio.draw.width;
  Request request = studio.draw;  // more sample points make a clearer picture
  request.settings.push_back("hemisphere.samples=64");
  request.look = "bleeding";
  const auto ours = tables_of(request, PictureInfo{});
  if (!ours) return ours.error();
  request.look = studio.draw.look = "bleeding-paper";
  const auto raw = studio.shoot({"hemisphere.tangents=on", "hemisphere.samples=64", "box.size=1"}, "", planes);
  const auto blurred = studio.shoot({"hemisphere.samples=64"}, "", {planes.begin() + 6, planes.end()});
  if (const auto error = error_of(raw, blurred)) return *error;
  const auto paper = tables_of(request, raw->info);
  if (!paper) return paper.error();
  // The section cuts the folds of a drape. The radius is about the size of a fold; few points keep the diagram
  // readable.
  request.settings = {std::string(kFewPoints), std::string(kSmallRadius)};
  const auto folds = studio.shoot(
      {"hemisphere.tangents=on", std::string(kFewPoints), std::string(kSmallRadius), "box.size=1"}, "", planes);
  if (!folds) return folds.error();
  const auto small = tables_of(request, folds->info);
  if (!small) return small.error();

  Figure figure{"2,3,4,6", "Diagrams, drawn from the real tables and planes", {}, {}};
  figure.pictures.push_back(points_diagram(*paper, size, "bleeding-2-points.png", "2: points (paper preset)"));
  figure.pictures.push_back(points_diagram(*ours, size, "bleeding-2-points-ours.png", "2: points (our own)"));
  figure.pictures.push_back(pipeline_diagram(*raw, *blurred, figure.pictures[0].image));

  const Gathered best = best_section(*folds, *small);
  if (best.taps.empty())
    return Error{ErrorKind::kInternal, "no pixel in the rows of the section receives light from its neighbours"};
  figure.pictures.push_back(section_diagram(*folds, *small, best));
  const Tap& pair = clearest_pair(best);
  figure.pictures.push_back(angles_diagram(best, pair, size));
  for (FigurePicture& picture : figure.pictures)
    picture.command = fmt::format("umbrage figures --paper bleeding --size {}", size);

  const auto occluded = std::count_if(best.taps.begin(), best.taps.end(), [](const Tap& tap) { return tap.occluded; });
  const double drawn_ao = 1.0 - double(occluded) / small->samples, plane_ao = folds->value("ao", best.x, best.y);
  figure.numbers = {
      {"2: fraction of the points not below the surface, within the radius (paper preset)",
       fraction_of_points(*paper, is_above), 1.0, 1.0},
      {"2: the same (our own)", fraction_of_points(*ours, is_above), 1.0, 1.0},
      {"2: fraction within half of the radius: points are dense near the centre (paper preset)",
       fraction_of_points(*paper, is_inner), 0.6, 1.0},
      {"4: occlusion of the pixel as drawn, against the plane's", std::abs(drawn_ao - plane_ao), 0.0, 1e-5},
      {"4: sample points that send light to the pixel",
       double(
           std::count_if(best.taps.begin(), best.taps.end(), [](const Tap& tap) { return tap.contributes_light(); })),
       1.0, kAnything},
      {"6: cosines of the pair, the smaller one", std::min(pair.cos_emitter, pair.cos_receiver), 1e-3, 1.0}};
  return figure;
}

}  // namespace umbrage
