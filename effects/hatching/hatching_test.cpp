// Tests `hatching`: its tone, its directions on cylinders, the spacing of its lines, and that lines stay on surfaces.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "core/color.h"
#include "devices/cpu/cpu_device.h"
#include "effects/hatching/hatching_strokes.h"
#include "effects/outline/outline_test_scenes.h"
#include "generators/builtin.h"
#include "renderer/draw.h"
#include "run_effect.h"
#include "support.h"

namespace umbrage {
namespace {

using namespace test;

const Effect& hatching() { return *find_effect("hatching"); }

/// Adds light whose display value is `tone` to all pixels.
GBuffer lit_by(GBuffer g, float tone) {
  for (const char* name : kLit) g.layers[0].add(name) = Plane(g.info.width, g.info.height, linear_from_srgb(tone));
  return g;
}

GBuffer wall(int width, int height, float tone) {
  return lit_by(seen({.width = width, .height = height, .orthographic = true}, ground(70.0, 0.0)), tone);
}

double mean_inside(const Plane& plane, int margin) {
  double sum = 0.0;
  long count = 0;
  for (int y = margin; y < plane.height - margin; ++y)
    for (int x = margin; x < plane.width - margin; ++x) sum += plane.at(x, y), ++count;
  return sum / double(count);
}

// ---- tone

TEST(Hatching, WidthsOfAllRanksAddUpToTheInk) {
  constexpr float kSpacing = 6.0f, kWidth = 1.5f;
  std::array<float, 3> before{};
  for (int k = 0; k <= 22; ++k) {
    const float ink = float(k) / 22.0f;
    std::array<float, 3> width{};
    for (int rank = 0; rank < kHatchingRanks; ++rank) width[rank] = hatching_width(float(rank), ink, kSpacing, kWidth);
    // Four spacings contain one line of rank 0, one of rank 1 and two of rank 2.
    EXPECT_NEAR((width[0] + width[1] + 2.0f * width[2]) / (4.0f * kSpacing), ink, 1e-6) << ink;
    for (int rank = 0; rank < kHatchingRanks; ++rank) EXPECT_GE(width[rank], before[rank]) << ink;
    for (int rank = 1; rank < kHatchingRanks; ++rank)
      if (width[rank] > 0.0f) {
        EXPECT_GE(width[rank - 1], kWidth * 0.9999f) << "a line is among those of all darker tones";
      }
    before = width;
  }
}

TEST(Hatching, LinesCoverTheInkThatTheToneNeeds) {
  double worst = 0.0;
  for (const float tone : {0.96f, 0.9f, 0.8f, 0.7f, 0.6f, 0.5f, 0.4f, 0.3f, 0.2f, 0.1f}) {
    const Image image = run_effect(hatching(), wall(192, 192, tone), {{"spacing", "6"}, {"width", "1.5"}}, {});
    const double ink = mean_inside(image.plane("outline"), 24);  // of 144 x 144 pixels
    EXPECT_NEAR(ink, 1.0 - tone, 0.02) << "tone " << tone;
    worst = std::max(worst, std::abs(ink - (1.0 - tone)));
    EXPECT_EQ(image.plane("lit.g").at(90, 90), 1.0f) << "the paper";
  }
  RecordProperty("worst_error_of_ink", std::to_string(worst));
}

TEST(Hatching, OneSetOfStraightLinesIsExact) {
  for (const float tone : {0.9f, 0.5f}) {
    const Image image =
        run_effect(hatching(), wall(192, 192, tone), {{"spacing", "6"}, {"width", "1.5"}, {"cross", "1"}}, {});
    EXPECT_NEAR(mean_inside(image.plane("outline"), 24), 1.0 - tone, 0.005);
  }
}

TEST(Hatching, WhiteHasNoLinesAndBlackIsFilled) {
  const Image white = run_effect(hatching(), wall(96, 96, 1.0f), {}, {});
  EXPECT_EQ(mean_inside(white.plane("outline"), 0), 0.0);
  const Image black = run_effect(hatching(), wall(96, 96, 0.0f), {}, {});
  EXPECT_GT(mean_inside(black.plane("outline"), 8), 0.97);
  const Image inverse = run_effect(hatching(), wall(96, 96, 0.0f), {{"strokes", "light"}}, {});
  EXPECT_EQ(mean_inside(inverse.plane("outline"), 0), 0.0);
  const Image brighter = run_effect(hatching(), wall(96, 96, 0.5f), {{"exposure", "4"}}, {});
  EXPECT_EQ(mean_inside(brighter.plane("outline"), 0), 0.0);
}

TEST(Hatching, LinesOfOthersRemain) {
  GBuffer g = wall(96, 96, 0.9f);
  g.layers[0].add("outline") = Plane(96, 96, 0.25f);
  const Image image = run_effect(hatching(), g, {{"spacing", "8"}, {"width", "2"}}, {});
  const Plane& outline = image.plane("outline");
  float min = 1.0f, max = 0.0f;
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) min = std::min(min, outline.at(x, y)), max = std::max(max, outline.at(x, y));
  EXPECT_EQ(min, 0.25f);
  EXPECT_GT(max, 0.9f);
}

TEST(Hatching, DarkMaterialsAreDarker) {
  const auto ink = [](float albedo, const char* material) {
    GBuffer g = wall(192, 192, 0.8f);
    for (const char* name : kAlbedo) g.layers[0].add(name) = Plane(192, 192, linear_from_srgb(albedo));
    const Image image = run_effect(hatching(), g, {{"spacing", "6"}, {"width", "1.5"}, {"material", material}}, {});
    return mean_inside(image.plane("outline"), 24);
  };
  const float clay = 0.9063f;  // as display value
  EXPECT_NEAR(ink(clay, "1"), 0.2, 0.02);
  EXPECT_NEAR(ink(0.5f * clay, "1"), 0.6, 0.02);
  EXPECT_NEAR(ink(0.5f * clay, "0.5"), 0.4, 0.02);
  EXPECT_NEAR(ink(0.5f * clay, "0"), 0.2, 0.02);
  EXPECT_NEAR(ink(1.0f, "1"), 0.2, 0.02) << "brighter than clay";
}

// ---- directions

/// Returns a cylinder along z rotated by `turn`.
RayScene cylinder(dvec3 center, dmat3 turn, double radius) {
  return [=](const dvec3& origin, const dvec3& direction) {
    const dvec3 o = (origin - center) * turn, d = direction * turn;
    const double a = d.x * d.x + d.y * d.y, b = o.x * d.x + o.y * d.y, c = o.x * o.x + o.y * o.y - radius * radius;
    const double root = b * b - a * c;
    if (root <= 0.0) return Hit{};
    const double t = (-b - std::sqrt(root)) / a;
    const dvec3 p = o + d * t;
    return Hit{t, turn * dvec3(p.x / radius, p.y / radius, 0.0), 0, 0};
  };
}

/// Returns the angle in degrees between two directions without sign that are given as (cos 2a, sin 2a).
double angle_between(double x, double y, double u, double v) {
  const double cosine = (x * u + y * v) / (std::hypot(x, y) * std::hypot(u, v));
  return 0.5 * std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

/// Calls `visit` with every pixel of the cylinder that faces the camera by 25 degrees or more, and its direction around
/// the cylinder on the picture, as (cos 2a, sin 2a).
template <class Visit>
void for_directions_around(const GBuffer& g, const dvec3& axis, const Visit& visit) {
  const Image& image = g.layers[0];
  const double pixel = g.info.pixel_width();
  for (int y = 0; y < g.info.height; ++y)
    for (int x = 0; x < g.info.width; ++x) {
      const double z = image.plane("depth").at(x, y);
      if (!(z < 1e9)) continue;
      const dvec3 n = {image.plane("normal.x").at(x, y), image.plane("normal.y").at(x, y),
                       image.plane("normal.z").at(x, y)};
      const dvec3 p = {(g.info.camera.left + (x + 0.5) * pixel) * z, (g.info.camera.top - (y + 0.5) * pixel) * z, -z};
      if (-glm::dot(n, glm::normalize(p)) < std::sin(radians(25.0))) continue;
      // The picture of p + h d, minus that of p.
      const dvec3 around = glm::normalize(glm::cross(axis, n));
      const double right = around.x / z + p.x * around.z / (z * z), down = -(around.y / z + p.y * around.z / (z * z));
      visit(x, y, right * right - down * down, 2.0 * right * down);
    }
}

double percentile(std::vector<double> values, double fraction) {
  std::sort(values.begin(), values.end());
  return values[std::size_t(fraction * double(values.size() - 1))];
}

TEST(Hatching, CurvatureOfACylinderRunsAroundIt) {
  for (const double tilt_deg : {0.0, 35.0, 60.0}) {
    const dmat3 turn = rotation(90.0 + 0.3 * tilt_deg, 0.0, tilt_deg);
    const GBuffer g = lit_by(seen({}, cylinder({0.2, 0.1, -6.0}, turn, 1.2)), 0.5f);
    // The filter is off. What the fixed direction adds is that of the setting without curvature.
    // Both fixed directions are the same where the axis is at a right angle to the view.
    const Settings own = {{"smoothness", "0"}, {"tilt", "0"}}, fixed = joined(own, {{"direction", "fixed"}});
    const Image with = run_effect(hatching(), g, own, {}), without = run_effect(hatching(), g, fixed, {});
    std::vector<double> errors, weights;
    for_directions_around(g, turn[2], [&](int x, int y, double u, double v) {
      const double dx = with.plane("hatching_raw_x").at(x, y) - without.plane("hatching_raw_x").at(x, y);
      const double dy = with.plane("hatching_raw_y").at(x, y) - without.plane("hatching_raw_y").at(x, y);
      weights.push_back(std::hypot(dx, dy));
      errors.push_back(angle_between(dx, dy, u, v));
    });
    ASSERT_GT(errors.size(), 5000u);
    EXPECT_LT(percentile(errors, 0.99), 0.1) << tilt_deg;
    EXPECT_GT(percentile(weights, 0.01), 0.1) << "the curvature is distinct";
  }
}

TEST(Hatching, CrossingLinesRunAlongTheCylinder) {
  const dmat3 turn = rotation(110.0, 0.0, 30.0);
  const GBuffer g = lit_by(seen({}, cylinder({0.0, 0.0, -6.0}, turn, 1.2)), 0.5f);
  const Image image = run_effect(hatching(), g, {}, {});
  std::vector<double> errors;
  for_directions_around(g, turn[2], [&](int x, int y, double, double) {
    const double z = g.layers[0].plane("depth").at(x, y), pixel = g.info.pixel_width();
    const dvec3 axis = turn[2];
    const double px = (g.info.camera.left + (x + 0.5) * pixel), py = (g.info.camera.top - (y + 0.5) * pixel);
    const double right = (axis.x + px * axis.z) / z, down = -(axis.y + py * axis.z) / z;
    errors.push_back(angle_between(image.plane("hatching_cross_x").at(x, y), image.plane("hatching_cross_y").at(x, y),
                                   right * right - down * down, 2.0 * right * down));
  });
  EXPECT_LT(percentile(errors, 0.5), 4.0);
  EXPECT_LT(percentile(errors, 0.99), 12.0);
}

// Lines run around thick cylinders and along thin ones.
TEST(Hatching, LinesRunAlongThinParts) {
  for (const double tilt_deg : {10.0, 40.0, 75.0}) {
    const dmat3 turn = rotation(90.0, 0.0, tilt_deg);
    const auto median = [&](double radius_px) {
      const GBuffer empty = seen({}, cylinder({0.0, 0.0, -6.0}, turn, 1.0));
      const GBuffer g =
          lit_by(seen({}, cylinder({0.0, 0.0, -6.0}, turn, radius_px * 6.0 * empty.info.pixel_width())), 0.5f);
      const Image image = run_effect(hatching(), g, {{"spacing", "4"}}, {});
      std::vector<double> errors;
      const dvec3 axis = turn[2];  // across the view
      for (int y = 0; y < g.info.height; ++y)
        for (int x = 0; x < g.info.width; ++x)
          if (g.layers[0].plane("depth").at(x, y) < 1e9f)
            errors.push_back(angle_between(image.plane("hatching_x").at(x, y), image.plane("hatching_y").at(x, y),
                                           axis.x * axis.x - axis.y * axis.y, -2.0 * axis.x * axis.y));
      EXPECT_GT(errors.size(), 300u);
      return percentile(errors, 0.5);
    };
    EXPECT_LT(median(2.5), 6.0) << tilt_deg;
    EXPECT_GT(median(20.0), 75.0) << tilt_deg;
  }
}

// On a sphere of triangles, with normals that are a little off, lines lie in parallel planes.
TEST(Hatching, TrianglesOfASphereDoNotTurnLines) {
  const GBuffer exact = lit_by(seen({}, sphere({0.0, 0.0, -6.0}, 1.2, 0)), 0.5f);
  GBuffer g = exact;
  for (int y = 0; y < g.info.height; ++y)
    for (int x = 0; x < g.info.width; ++x) {
      const double phase_x = 0.35 * x, phase_y = 0.35 * y;  // triangles of 18 pixels
      g.layers[0].plane("normal.x").at(x, y) += float(0.012 * std::sin(phase_x) * std::cos(phase_y));
      g.layers[0].plane("normal.y").at(x, y) += float(0.012 * std::cos(0.7 * phase_x + phase_y));
    }
  const Image image = run_effect(hatching(), g, {{"tilt", "0"}}, {});
  const Image planes = run_effect(hatching(), exact, {{"tilt", "0"}, {"direction", "fixed"}}, {});
  std::vector<double> errors;
  for (int y = 0; y < g.info.height; ++y)
    for (int x = 0; x < g.info.width; ++x)
      if (g.layers[0].plane("depth").at(x, y) < 1e9f)
        errors.push_back(angle_between(image.plane("hatching_x").at(x, y), image.plane("hatching_y").at(x, y),
                                       planes.plane("hatching_x").at(x, y), planes.plane("hatching_y").at(x, y)));
  ASSERT_GT(errors.size(), 3000u);
  RecordProperty("median", std::to_string(percentile(errors, 0.5)));
  EXPECT_LT(percentile(errors, 0.5), 8.0);
  EXPECT_LT(percentile(errors, 0.9), 20.0);
}

TEST(Hatching, RoundedNormalsAreSmoothed) {
  // With tilt 0 the fixed direction, around the y axis, agrees with the curvature.
  const dmat3 turn = rotation(90.0, 0.0);
  GBuffer g = lit_by(seen({}, cylinder({0.0, 0.0, -6.0}, turn, 1.2)), 0.5f);
  const GBuffer exact = g;
  for (const char* name : kNormal)
    for (int y = 0; y < g.info.height; ++y)
      for (int x = 0; x < g.info.width; ++x) {
        float& v = g.layers[0].plane(name).at(x, y);
        v = std::round((0.5f * v + 0.5f) * 255.0f) / 255.0f * 2.0f - 1.0f;
      }
  const auto median = [&](const Settings& settings) {
    const Image image = run_effect(hatching(), g, settings, {});
    std::vector<double> errors;
    for_directions_around(exact, turn[2], [&](int x, int y, double u, double v) {
      errors.push_back(angle_between(image.plane("hatching_x").at(x, y), image.plane("hatching_y").at(x, y), u, v));
    });
    return percentile(errors, 0.5);
  };
  EXPECT_GT(median({{"smoothness", "0"}, {"tilt", "0"}}), 0.02);
  EXPECT_LT(median({{"smoothness", "3.5"}, {"tilt", "0"}}), 0.5);
}

// ---- lines

/// A field of directions, with the memory of its planes.
struct OwnField {
  std::vector<float> x, y, breaks;
  HatchingField field;
};

/// `angle` returns the direction at a pixel, radians from right to down.
template <class Angle>
OwnField field_of(int size, float spacing_px, const Angle& angle) {
  OwnField own;
  const auto count = std::size_t(size) * std::size_t(size);
  own.x.resize(count), own.y.resize(count), own.breaks.resize(count);
  for (int k = 0; k < int(count); ++k) {
    const double a = 2.0 * angle(k % size + 0.5, k / size + 0.5);
    own.x[k] = float(std::cos(a)), own.y[k] = float(std::sin(a));
  }
  own.field = {size,      size, {"", own.x.data(), size}, {"", own.y.data(), size}, {"", own.breaks.data(), size},
               spacing_px};
  return own;
}

double length_of(const HatchingLine& line) {
  double sum = 0.0;
  for (std::size_t k = 1; k < line.points.size(); ++k)
    sum += std::hypot(line.points[k].x - line.points[k - 1].x, line.points[k].y - line.points[k - 1].y);
  return sum;
}

TEST(Hatching, LinesAreOneSpacingApart) {
  constexpr int kSize = 384;
  constexpr float kSpacing = 6.0f;
  const auto density = [&](const auto& angle) {
    const OwnField own = field_of(kSize, kSpacing, angle);
    double sum = 0.0;
    for (const HatchingLine& line : trace_hatching(own.field, {{{{190.0f, 190.0f}}, {}, {}}})) sum += length_of(line);
    return sum * kSpacing / (double(kSize) * kSize);
  };
  EXPECT_NEAR(density([](double, double) { return 0.3; }), 1.0, 0.03) << "parallel";
  const double wavy = density([](double x, double y) { return 0.8 * std::sin(x / 40.0) * std::cos(y / 55.0); });
  EXPECT_GE(wavy, 0.97);
  EXPECT_LE(wavy, 1.1);
}

TEST(Hatching, RanksHalveTheirDistance) {
  const OwnField own = field_of(384, 6.0f, [](double, double) { return 0.0; });
  std::array<double, kHatchingRanks> lengths{};
  const auto lines = trace_hatching(own.field, {{{{190.0f, 190.0f}}, {}, {}}});
  for (const HatchingLine& line : lines) lengths[line.rank] += length_of(line);
  EXPECT_NEAR(lengths[0] * 24.0 / (384.0 * 384.0), 1.0, 0.05);
  EXPECT_NEAR(lengths[1] / lengths[0], 1.0, 0.05);
  EXPECT_NEAR(lengths[2] / lengths[0], 2.0, 0.1);
}

// Lines that meet in the distance go on with a higher level, so that each level keeps its distance.
TEST(Hatching, LevelsKeepTheirDistanceAndLinesGoOn) {
  const OwnField own = field_of(256, 6.0f, [](double x, double y) { return std::atan2(y - 128.0, x + 64.0); });
  const auto lines = trace_hatching(own.field, {{{{250.0f, 128.0f}}, {}, {}}});
  long pairs = 0, near = 0, raised = 0, ends = 0, wide = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].rank == 0) ++wide, ends += lines[i].free_start, raised += lines[i].level.front() > 0.5f;
    ASSERT_EQ(lines[i].level.size(), lines[i].points.size());
    for (std::size_t k = 0; k < lines[i].points.size(); k += 3) {
      const float level = lines[i].level[k], min = 12.0f * std::exp2(-level);
      for (std::size_t j = 0; j < i; ++j)
        for (std::size_t m = 0; m < lines[j].points.size(); m += 3) {
          if (lines[j].level[m] > level) continue;
          const float dx = lines[j].points[m].x - lines[i].points[k].x,
                      dy = lines[j].points[m].y - lines[i].points[k].y;
          ++pairs, near += dx * dx + dy * dy < 0.7f * min * min;
        }
    }
  }
  EXPECT_GT(pairs, 100000);
  EXPECT_LE(near, 4) << "of millions";
  EXPECT_GT(wide, 6);
  EXPECT_GT(raised, wide / 4);
  EXPECT_LE(ends, wide / 4);
}

TEST(Hatching, LinesEndWhereTheSurfaceEnds) {
  OwnField own = field_of(128, 6.0f, [](double, double) { return 0.2; });
  for (int y = 0; y < 128; ++y) own.breaks[std::size_t(y) * 128 + 63] = float(kHatchingBreakRight);
  for (int k = 0; k < 128 * 20; ++k) own.x[k] = own.y[k] = 0.0f;  // background above
  const auto lines = trace_hatching(own.field, {{{{30.0f, 64.0f}, {100.0f, 64.0f}}, {}, {}}});
  EXPECT_GT(lines.size(), 20u);
  for (const HatchingLine& line : lines)
    for (const HatchingLine::Point& p : line.points) {
      EXPECT_GE(p.y, 20.0f);
      EXPECT_EQ(p.x < 64.0f, line.points[0].x < 64.0f);
    }
}

// Lines that meet in the distance end where there is no place for them. In dark parts their ends leave no light spot.
TEST(Hatching, EndsOfLinesInDarkPartsAreNotLight) {
  const GBuffer g = lit_by(seen({}, ground(25.0, 0.0)), 0.15f);
  const Settings settings = {
      {"spacing", "6"}, {"width", "1.5"}, {"cross", "1"}, {"direction", "fixed"}, {"tilt", "90"}};
  const Image image = run_effect(hatching(), g, settings, {});
  long light = 0, all = 0;
  for (int y = 8; y < g.info.height - 8; ++y)
    for (int x = 8; x < g.info.width - 8; ++x)
      if (g.layers[0].plane("depth").at(x, y) < 1e9f) {
        bool blank = true;  // a spot of 2 x 2 pixels
        for (int k = 0; k < 4; ++k) blank &= image.plane("outline").at(x + k % 2, y + k / 2) < 0.3f;
        ++all, light += blank;
      }
  ASSERT_GT(all, 10000);
  EXPECT_LT(double(light), 0.008 * double(all));
}

// ---- motion

struct Turned {
  Image image;
  PictureInfo info;
};

/// Returns the look's picture of the knot and others, turned around by the camera.
Turned turned(float azimuth_deg) {
  Scene scene = *make_builtin_scene("scene:solids?detail=20000");
  const auto device = make_cpu_device();
  Request request;
  request.width = request.height = 400;
  request.look = "hatching";
  request.camera.azimuth_deg = azimuth_deg;
  request.settings = {"outline.opacity=0", "hatching.spacing=6", "hatching.width=1.5"};
  request.passes = {"color", "outline", "depth", "hatching_x", "hatching_y"};
  StageTimes times;
  EXPECT_TRUE(device->prepare(scene));
  const auto frame = draw(*device, scene, request, times);
  EXPECT_TRUE(frame) << (frame ? "" : frame.error().message);
  return {*device->download(*frame, {"outline", "depth", "hatching_x", "hatching_y"}), inner_info(frame->info)};
}

/// Returns the value at a point between the centres of pixels.
float value_at(const Plane& plane, float u, float v) {
  const float px = std::clamp(u - 0.5f, 0.0f, float(plane.width) - 1.001f), fx = px - std::floor(px);
  const float py = std::clamp(v - 0.5f, 0.0f, float(plane.height) - 1.001f), fy = py - std::floor(py);
  const int x = int(px), y = int(py);
  return (1.0f - fy) * ((1.0f - fx) * plane.at(x, y) + fx * plane.at(x + 1, y)) +
         fy * ((1.0f - fx) * plane.at(x, y + 1) + fx * plane.at(x + 1, y + 1));
}

/// Returns the correlation of two lists.
double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const auto n = double(a.size());
  double sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    sa += a[k], sb += b[k], saa += a[k] * a[k], sbb += b[k] * b[k], sab += a[k] * b[k];
  return (sab - sa * sb / n) / std::sqrt((saa - sa * sa / n) * (sbb - sb * sb / n));
}

TEST(Hatching, LinesMoveWithTheSurface) {
  const Turned before = turned(0.0f), after = turned(1.0f);
  const glm::mat4 to_after = after.info.camera.view_from_world * glm::inverse(before.info.camera.view_from_world);
  std::vector<double> own, with_surface, at_pixel;
  const Plane &depth = before.image.plane("depth"), &other_depth = after.image.plane("depth");
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      const float z = depth.at(x, y);
      if (!std::isfinite(z)) continue;
      const Camera& c = before.info.camera;
      const float wx = c.left + (float(x) + 0.5f) * before.info.pixel_width();
      const float wy = c.top - (float(y) + 0.5f) * before.info.pixel_height();
      const glm::vec4 there = to_after * glm::vec4(wx * z, wy * z, -z, 1.0f);
      const float u = (there.x / -there.z - c.left) / after.info.pixel_width();
      const float v = (c.top - there.y / -there.z) / after.info.pixel_height();
      if (u < 0.0f || v < 0.0f || u >= float(depth.width) || v >= float(depth.height)) continue;
      if (std::abs(other_depth.at(int(u), int(v)) + there.z) > 0.01f * z) continue;
      // Only where the surface moves across the lines, by 1.5 to 4.5 pixels of their 6.
      const float dx = u - 0.5f - float(x), dy = v - 0.5f - float(y);
      const float cosine = before.image.plane("hatching_x").at(x, y), sine = before.image.plane("hatching_y").at(x, y);
      const float across_squared = 0.5f * ((dx * dx + dy * dy) - (dx * dx - dy * dy) * cosine - 2.0f * dx * dy * sine);
      if (across_squared < 1.5f * 1.5f || across_squared > 4.5f * 4.5f) continue;
      own.push_back(before.image.plane("outline").at(x, y));
      with_surface.push_back(value_at(after.image.plane("outline"), u, v));
      at_pixel.push_back(after.image.plane("outline").at(x, y));
    }
  ASSERT_GT(own.size(), 3000u);
  const double moving = correlation(own, with_surface), resting = correlation(own, at_pixel);
  RecordProperty("correlation_on_the_surface", std::to_string(moving));
  RecordProperty("correlation_at_the_pixel", std::to_string(resting));
  EXPECT_GT(moving, 0.45);
  EXPECT_GT(moving, resting + 0.3);
}

}  // namespace
}  // namespace umbrage
