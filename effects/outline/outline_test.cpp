// `outline` on scenes whose edges are known: G-buffers are traced in double from half-spaces and spheres. Mode `paper`
// is held to listing 3 of [Lajzer and Nottingham], ported literally.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <limits>
#include <numbers>

#include "run_effect.h"
#include "support.h"

namespace umbrage {
namespace {

using glm::dmat3;
using glm::dvec3;
using test::Settings;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTanHalfView = 0.36397023426620234;  // of 40 degrees, as empty_gbuffer has it
constexpr double kLine = 0.02;                        // cover from which on a pixel counts as one of a line

double radians(double deg) { return deg * std::numbers::pi / 180.0; }

dmat3 rotation(double about_x_deg, double about_y_deg, double about_z_deg = 0.0) {
  const double a = radians(about_x_deg), b = radians(about_y_deg), c = radians(about_z_deg);
  const dmat3 x(1, 0, 0, 0, std::cos(a), std::sin(a), 0, -std::sin(a), std::cos(a));
  const dmat3 y(std::cos(b), 0, -std::sin(b), 0, 1, 0, std::sin(b), 0, std::cos(b));
  const dmat3 z(std::cos(c), std::sin(c), 0, -std::sin(c), std::cos(c), 0, 0, 0, 1);
  return z * x * y;
}

// --- scenes -------------------------------------------------------------------------------------------------------

/// What a ray meets. `distance` counts in directions, whose z is -1: it is the view depth.
struct Hit {
  double distance = kInfinity;
  dvec3 normal{0.0};
  int object = -1, material = -1;
};
using Scene = std::function<Hit(const dvec3& origin, const dvec3& direction)>;

/// The points for which dot(normal, p) < offset.
struct HalfSpace {
  dvec3 normal;
  double offset;
};

/// The part that all half-spaces share. Seen from inside, its walls are what is hit.
Scene convex_solid(std::vector<HalfSpace> sides, int object = 0, bool from_inside = false) {
  return [=](const dvec3& origin, const dvec3& direction) {
    Hit in{.distance = -kInfinity, .object = object, .material = object}, out = in;
    out.distance = kInfinity;
    for (const HalfSpace& side : sides) {
      const double speed = glm::dot(side.normal, direction);
      const double gap = side.offset - glm::dot(side.normal, origin);
      if (speed == 0.0) {
        if (gap < 0.0) return Hit{};
        continue;
      }
      const double t = gap / speed;
      if (speed < 0.0 && t > in.distance) in.distance = t, in.normal = side.normal;
      if (speed > 0.0 && t < out.distance) out.distance = t, out.normal = -side.normal;
    }
    if (from_inside) return out;
    return in.distance > 0.0 && in.distance < out.distance ? in : Hit{};
  };
}

Scene sphere(dvec3 center, double radius, int object) {
  return [=](const dvec3& origin, const dvec3& direction) {
    const dvec3 from = origin - center;
    const double a = glm::dot(direction, direction), b = glm::dot(from, direction),
                 c = glm::dot(from, from) - radius * radius;
    const double root = b * b - a * c;
    if (root <= 0.0) return Hit{};
    const double t = (-b - std::sqrt(root)) / a;
    if (t <= 0.0) return Hit{};
    return Hit{t, (from + direction * t) / radius, object, object};
  };
}

/// The nearest of several.
Scene together(std::vector<Scene> scenes) {
  return [=](const dvec3& origin, const dvec3& direction) {
    Hit nearest;
    for (const Scene& scene : scenes)
      if (const Hit hit = scene(origin, direction); hit.distance < nearest.distance) nearest = hit;
    return nearest;
  };
}

/// A box, and, where `bevel` is above 0, with its edges cut off so that the cuts are that wide.
Scene box(dvec3 center, dmat3 turn, double half, double bevel = 0.0, int object = 0) {
  std::vector<HalfSpace> sides;
  const auto add = [&](const dvec3& n, double offset) {
    const dvec3 normal = turn * n;
    sides.push_back({normal, offset + glm::dot(normal, center)});
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int sign : {-1, 1}) {
      dvec3 n(0.0);
      n[axis] = sign;
      add(n, half);
    }
  if (bevel > 0.0)
    for (int axis = 0; axis < 3; ++axis)
      for (int s : {-1, 1})
        for (int t : {-1, 1}) {
          dvec3 n(0.0);
          n[(axis + 1) % 3] = s * std::sqrt(0.5);
          n[(axis + 2) % 3] = t * std::sqrt(0.5);
          add(n, std::sqrt(2.0) * half - 0.5 * bevel);
        }
  return convex_solid(sides, object);
}

/// A scene without perspective shows at depth kFocus what one with it does.
constexpr double kFocus = 6.0;

struct Lens {
  int width = 256, height = 256;
  bool orthographic = false;
  double shift_x_px = 0.0, shift_y_px = 0.0;  // of the window, to the right and up

  double pixel() const { return 2.0 * kTanHalfView * (orthographic ? kFocus : 1.0) / height; }
  double left() const { return -0.5 * width * pixel() + shift_x_px * pixel(); }
  double top() const { return 0.5 * height * pixel() + shift_y_px * pixel(); }
};

GBuffer seen(const Lens& lens, const Scene& scene) {
  GBuffer g = test::empty_gbuffer(lens.width, lens.height);
  g.info.camera.projection = lens.orthographic ? Projection::kOrthographic : Projection::kPerspective;
  g.info.camera.left = float(lens.left());
  g.info.camera.right = float(lens.left() + lens.width * lens.pixel());
  g.info.camera.top = float(lens.top());
  g.info.camera.bottom = float(lens.top() - lens.height * lens.pixel());
  Image& image = g.layers[0];
  for (const char* name : {"depth", "normal.x", "normal.y", "normal.z", "object_id", "material_id"}) image.add(name);
  for (int y = 0; y < lens.height; ++y)
    for (int x = 0; x < lens.width; ++x) {
      const double wx = lens.left() + (x + 0.5) * lens.pixel(), wy = lens.top() - (y + 0.5) * lens.pixel();
      const Hit hit = lens.orthographic ? scene({wx, wy, 0.0}, {0, 0, -1}) : scene(dvec3(0.0), {wx, wy, -1.0});
      image.planes[0].at(x, y) = float(hit.distance);
      for (int c = 0; c < 3; ++c) image.planes[1 + c].at(x, y) = float(hit.normal[c]);
      image.planes[4].at(x, y) = float(hit.object);
      image.planes[5].at(x, y) = float(hit.material);
    }
  return g;
}

Plane lines_of(const GBuffer& g, const Settings& settings = {}) {
  return test::run_effect(*find_effect("outline"), g, settings, {}).plane("outline");
}

long count(
    const Plane& lines, const std::function<bool(int, int)>& where = [](int, int) { return true; }) {
  long n = 0;
  for (int y = 0; y < lines.height; ++y)
    for (int x = 0; x < lines.width; ++x) n += lines.at(x, y) > kLine && where(x, y);
  return n;
}

// --- what must have no line ----------------------------------------------------------------------------------------

/// A plane seen at so many degrees in the middle of the picture, there at a depth, with smooth errors of its normals.
Scene ground(double elevation_deg, double error_deg, double depth = kFocus, int object = 0) {
  const dvec3 normal(0.0, std::cos(radians(elevation_deg)), std::sin(radians(elevation_deg)));
  const Scene plane = convex_solid({{normal, glm::dot(normal, dvec3(0, 0, -depth))}}, object);
  return [=](const dvec3& origin, const dvec3& direction) {
    Hit hit = plane(origin, direction);
    if (error_deg > 0.0 && hit.distance < kInfinity) {
      const dvec3 p = origin + direction * hit.distance;
      const double angle = 5.0 * p.x + 1.7 * p.z, most = std::tan(radians(error_deg));
      hit.normal = glm::normalize(hit.normal + most * dvec3(std::cos(angle), 0.0, std::sin(angle)));
    }
    return hit;
  };
}

TEST(Outline, BackgroundAloneHasNoLine) {
  const GBuffer g = seen({67, 29}, [](const dvec3&, const dvec3&) { return Hit{}; });
  for (const char* mode : {"robust", "paper"})
    test::on_every_target("outline", g, {{"mode", mode}}, [&](const Image& image) {
      for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) ASSERT_EQ(image.plane("outline").at(x, y), 0.0f);
    });
}

TEST(Outline, TinyPicturesAreFine) {
  for (const auto& [width, height] : {std::pair(1, 1), {3, 2}, {2, 17}})
    for (const char* mode : {"robust", "paper"})
      for (const bool orthographic : {false, true}) {
        const GBuffer g = seen({width, height, orthographic}, box({0, 0, -kFocus}, rotation(33, 38), 0.8));
        test::on_every_target("outline", g, {{"mode", mode}, {"width", "16"}},
                              [&, w = width, h = height](const Image& image) {
                                for (int y = 0; y < h; ++y)
                                  for (int x = 0; x < w; ++x) {
                                    ASSERT_GE(image.plane("outline").at(x, y), 0.0f);
                                    ASSERT_LE(image.plane("outline").at(x, y), 1.0f);
                                  }
                              });
      }
}

// `output` draws what covers nothing nowhere, and lines without planes of colour black.
TEST(Outline, ColourAndOpacityAreHandedOn) {
  const GBuffer g = seen({96, 96}, box({0, 0, -kFocus}, rotation(33, 38), 1.0));
  const Effect& effect = *find_effect("outline");
  for (const char* mode : {"robust", "paper"}) {
    const Plane full = lines_of(g, {{"mode", mode}});
    EXPECT_GT(count(full), 100);
    const Settings half = {{"mode", mode}, {"r", "0.5"}, {"b", "0.25"}, {"opacity", "0.5"}};
    test::on_every_target("outline", g, half, [&](const Image& image) {
      for (int y = 0; y < 96; ++y)
        for (int x = 0; x < 96; ++x) {
          ASSERT_EQ(image.plane("outline").at(x, y), 0.5f * full.at(x, y));
          ASSERT_EQ(image.plane("line.r").at(x, y), 0.5f);
          ASSERT_EQ(image.plane("line.g").at(x, y), 0.0f);
          ASSERT_EQ(image.plane("line.b").at(x, y), 0.25f);
        }
    });
    const auto made = [&](const Settings& settings) {
      return test::made_planes(effect, test::parameters_of(effect, settings));
    };
    const auto black = made({{"mode", mode}});
    EXPECT_EQ(std::count(black.begin(), black.end(), "line.r"), 0);
    EXPECT_TRUE(made({{"mode", mode}, {"r", "0.5"}, {"opacity", "0"}}).empty());
  }
}

// --- the paper -----------------------------------------------------------------------------------------------------

/// Listing 3, in double; a texture's edge pixels go on outside. `close` is true where rounding may decide.
struct Listing3 {
  double illum;
  bool close;
};
Listing3 toon_outlining(const GBuffer& g, int px, int py) {
  const Image& image = g.layers[0];
  const double far_plane = g.info.depth_max / 0.9, near_plane = far_plane * 2.0 / 15.0;
  const auto s_depth = [&](int x, int y) {
    const double z = image.planes[0].at(std::clamp(x, 0, image.width - 1), std::clamp(y, 0, image.height - 1));
    if (!std::isfinite(z)) return 1.0;
    const double clipped = std::clamp(z, near_plane, far_plane);
    const double linear = (clipped - near_plane) / (far_plane - near_plane);
    return g.info.camera.projection == Projection::kOrthographic ? linear : linear * far_plane / clipped;
  };
  const auto s_norm = [&](int x, int y) {
    x = std::clamp(x, 0, image.width - 1);
    y = std::clamp(y, 0, image.height - 1);
    return dvec3(image.planes[1].at(x, y), image.planes[2].at(x, y), image.planes[3].at(x, y));
  };
  const auto cleared = [&](int x, int y) { return s_norm(x, y) == dvec3(0.0); };

  double darkness_depth = 0.0, darkness_norm = 0.0;
  bool close = false;
  const double base_depth = s_depth(px, py);
  const dvec3 base_norm = s_norm(px, py);
  const double threshold_depth = 0.05 * (1.0 - base_depth), threshold_norm = 0.95;
  const int offsets[8][2] = {{-1, -1}, {-1, 0}, {-1, 1}, {0, -1}, {0, 1}, {1, -1}, {1, 0}, {1, 1}};
  for (const auto& offset : offsets) {
    const double depth = s_depth(px + offset[0], py + offset[1]);
    const dvec3 norm = s_norm(px + offset[0], py + offset[1]);
    const double apart = std::fabs(depth - base_depth), alike = glm::dot(norm, base_norm);
    if (apart > threshold_depth) darkness_depth += 1.0;
    // Where neither is a surface the listing normalizes zero.
    const bool neither = cleared(px, py) && cleared(px + offset[0], py + offset[1]);
    if (!neither && alike < threshold_norm) darkness_norm += 1.0;
    const bool both_far = apart == 0.0 && threshold_depth == 0.0;
    close |= (!both_far && std::fabs(apart - threshold_depth) < 2e-6) || std::fabs(alike - threshold_norm) < 2e-6;
  }
  return {std::max(0.0, 1.0 - (darkness_depth + darkness_norm)), close};
}

TEST(Outline, PaperIsListing3) {
  for (const bool orthographic : {false, true}) {
    const Lens lens{190, 140, orthographic};
    GBuffer traced = seen(lens, together({box({-0.6, 0.3, -kFocus}, rotation(33, 38, 7), 0.7),
                                          sphere({0.8, -0.3, -5.0}, 0.6, 1), ground(12.0, 0.0, 12.0, 2)}));
    traced.info.depth_max = 12.0f;
    GBuffer bumpy = test::bumpy_gbuffer(97, 61, 5);
    bumpy.info.camera.projection = traced.info.camera.projection;
    for (const GBuffer* g : {&traced, &bumpy})
      test::on_every_target("outline", *g, {{"mode", "paper"}}, [&](const Image& image) {
        long wrong = 0, black = 0, close = 0;
        for (int y = 0; y < image.height; ++y)
          for (int x = 0; x < image.width; ++x) {
            const Listing3 listing = toon_outlining(*g, x, y);
            black += listing.illum < 1.0;
            close += listing.close;
            wrong += !listing.close && 1.0 - image.plane("outline").at(x, y) != listing.illum;
          }
        EXPECT_EQ(wrong, 0);
        EXPECT_GT(black, 500);
        EXPECT_LT(close, 100);
      });
  }
}

TEST(Outline, PaperThresholdsAreParameters) {
  const GBuffer g = seen({128, 128}, box({0, 0, -kFocus}, rotation(33, 38), 1.0));
  const auto drawn = [&](const char* depth, const char* normal) {
    return count(lines_of(g, {{"mode", "paper"}, {"paper_depth", depth}, {"paper_normal", normal}}));
  };
  const long usual = drawn("0.05", "0.95"), rims = drawn("0.05", "-1"), creases = drawn("1", "0.95");
  EXPECT_GT(rims, 100);
  EXPECT_GT(creases, rims);  // normals part the cube from the background, too
  EXPECT_GE(usual, creases);
  EXPECT_LT(rims, usual);
}

}  // namespace
}  // namespace umbrage
