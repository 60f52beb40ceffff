// Figures 15 and 16 of [Colliander and Törnquist 2015], and what the figures of this paper share.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "apps/figures/bleeding.h"
#include "apps/figures/measure.h"
#include "core/check.h"

namespace umbrage {
namespace {

constexpr double kAnything = 1e30;
constexpr float kCell = 0.1f;  // of ClothGrid, metres

bool is_cloth(const Mesh& mesh) {
  return mesh.name == "curtain" || mesh.name == "upper curtain" || mesh.name == "banner";
}

/// Returns the mean distance in pixels from a drape's silhouette to the first pixel on its left that receives red
/// indirect light. A distance is at most an eighth of the picture. Only silhouette pixels with a surface near the drape
/// on their left count.
double uncolored_distance_px(const Shot& shot, const ClothGrid& cloths) {
  constexpr float kReach = 0.3f;              // metres
  constexpr float kMin = 0.05f, kRed = 1.5f;  // min red light, and min ratio of red to green
  const Image& image = shot.image;
  const Plane &red = image.plane("indirect.r"), &green = image.plane("indirect.g"), &id = image.plane("object_id");
  long edges = 0, pixels = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 1; x < image.width; ++x) {
      if (!cloths.has_object(id.at(x, y)) || cloths.has_object(id.at(x - 1, y))) continue;
      if (!shot.surface(x - 1, y) || !cloths.near(shot.world(x - 1, y), kReach)) continue;
      ++edges;
      for (int k = 1; k <= image.width / 8 && k <= x; ++k) {
        const float r = red.at(x - k, y);
        if (r > kMin && r > kRed * green.at(x - k, y)) break;
        ++pixels;
      }
    }
  return edges > 0 ? double(pixels) / double(edges) : std::nan("");
}

/// Returns the red light that a picture adds to another across the side of the corner pier in bleeding_range(), which
/// is upright in it: the mean of each column, from the drape to the pier's front.
std::vector<double> light_across_pier(const Shot& shot, const Shot& without, float pier) {
  constexpr float kSide = -11.58f, kFront = -4.09f, kLow = 6.9f, kHigh = 8.1f, kNear = 0.01f;  // metres
  const auto tint = [](const Shot& from, int x, int y) {
    const auto value = [&](const char* plane) { return std::clamp(from.value(plane, x, y), 0.0f, 1.0f); };
    return double(value("color.r") - value("color.g"));
  };
  std::vector<double> profile;
  for (int x = 0; x < shot.image.width; ++x) {
    double sum = 0.0;
    long count = 0;
    for (int y = 0; y < shot.image.height; ++y) {
      if (shot.value("object_id", x, y) != pier || !shot.surface(x, y)) continue;
      const glm::vec3 p = shot.world(x, y);
      if (std::abs(p.z - kSide) > kNear || p.x > kFront || p.y < kLow || p.y > kHigh) continue;
      sum += tint(shot, x, y) - tint(without, x, y);
      ++count;
    }
    if (count > 0) profile.push_back(sum / double(count));
  }
  return profile;
}

}  // namespace

const std::vector<std::string>& bleeding_planes() {
  static const std::vector<std::string> planes = {"object_id",  "normal.x",   "normal.y",  "normal.z",
                                                  "indirect.r", "indirect.g", "indirect.b"};
  return planes;
}

Framing bleeding_view(glm::vec3 eye, glm::vec3 target, float angle_deg, std::optional<glm::vec2> light_deg) {
  return {.position = eye, .focal_point = target, .view_angle_deg = angle_deg, .light_deg = light_deg};
}

Framing unlit_drape_view() { return bleeding_view({-2.9f, 2.4f, -11.0f}, {-4.6f, 1.6f, -9.2f}, 45.0f); }

float object_of(const Studio& studio, std::string_view mesh_name) {
  for (const Mesh& mesh : studio.scene->meshes)
    if (mesh.name == mesh_name) return float(mesh.object);
  fail_check(fmt::format("{} has no mesh '{}'", kAtrium, mesh_name));
}

double spark_count(const Shot& shot, const Shot* without) {
  constexpr float kMinMedian = 0.02f;  // five steps of an 8-bit picture
  Plane values(shot.image.width, shot.image.height);
  for_each_pixel(shot.image, nullptr, [&](int x, int y) {
    const double base = without ? brightness(without->image, x, y) : 0.0;
    values.at(x, y) = float(brightness(shot.image, x, y) - base);
  });
  return double(count_sparks(values, kMinMedian));
}

ClothGrid::ClothGrid(const Scene& scene) {
  for (const Mesh& mesh : scene.meshes) {
    if (!is_cloth(mesh)) continue;
    objects_.insert(mesh.object);
    for (const glm::vec3& p : mesh.positions) cells_.insert(cell(p));
  }
}

bool ClothGrid::near(glm::vec3 p, float reach) const {
  const int steps = int(std::ceil(reach / kCell));
  const auto [x, y, z] = cell(p);
  for (int i = -steps; i <= steps; ++i)
    for (int j = -steps; j <= steps; ++j)
      for (int k = -steps; k <= steps; ++k)
        if (i * i + j * j + k * k <= steps * steps && cells_.contains({x + i, y + j, z + k})) return true;
  return false;
}

ClothGrid::Cell ClothGrid::cell(glm::vec3 p) {
  p = glm::floor(p / kCell);
  return {int(p.x), int(p.y), int(p.z)};
}

Result<Figure> bleeding_range(Studio& studio) {
  // The camera faces the drape, so that all of it is equally far, and the pier's side comes from it towards the camera.
  // Samples of a wide hemisphere find the drape from all of this side.
  const auto settings = [](std::initializer_list<const char*> range) {
    std::vector<std::string> all = {"hemisphere.samples=256", "hemisphere.radius=8", "hemisphere.range_factor=0.0175"};
    all.insert(all.end(), range.begin(), range.end());
    return all;
  };
  constexpr const char* kStrength = "hemisphere.bleeding=0.06";
  studio.draw.look = std::string(kBleedingPaper.look);
  studio.framing = bleeding_view({-3.35f, 7.5f, -11.15f}, {-4.5f, 7.5f, -11.1501f}, 76.0f, glm::vec2(-14.0f, 50.0f));
  const auto& planes = bleeding_planes();
  const auto without = studio.shoot(settings({"hemisphere.bleeding=0"}), "", planes);
  const auto quadratic = studio.shoot(settings({kStrength}), "", planes);
  const auto smooth =
      studio.shoot(settings({kStrength, "hemisphere.range=smoothstep", "hemisphere.range_depth=view"}), "", planes);
  if (const auto error = error_of(without, quadratic, smooth)) return *error;
  const float pier = object_of(studio, "mouldings and balustrade");
  const double sharp_px = width_of_fall(light_across_pier(*quadratic, *without, pier));
  const double smooth_px = width_of_fall(light_across_pier(*smooth, *without, pier));
  return Figure{
      "15,16",
      "A pier before a drape; bleeding strengthened",
      {quadratic->picture("bleeding-15-quadratic.png", "15: quadratic range"),
       smooth->picture("bleeding-16-smoothstep.png", "16: smoothstep")},
      {{"15: pixels in which light on the pier falls from 90 to 10 %", sharp_px, 0.0, 0.03 * studio.draw.width},
       {"16: the same, times that of 15", smooth_px / sharp_px, 4.0, kAnything},
       {"15: sparks, above 8 times the median of 5 x 5", spark_count(*quadratic), 0.0, 0.0},
       {"16: the same", spark_count(*smooth), 0.0, 0.0}}};
}

Result<Figure> bleeding_behind_drape(Studio& studio, const ClothGrid& cloths) {
  struct Variant {
    const char *file, *caption;
    std::string_view look;
    std::vector<std::string> settings;
    std::optional<int> extra_views;
  };
  const std::vector<std::string> strong = {"hemisphere.samples=64", "hemisphere.bleeding=0.5",
                                           "hemisphere.range_factor=0.25", "composite.damping=0"};
  const std::vector<Variant> variants = {
      {"behind-1-quadratic", "quadratic range", kBleedingPaper.look, strong, {}},
      {"behind-2-smoothstep",
       "smoothstep",
       kBleedingPaper.look,
       {strong[0], strong[1], strong[2], strong[3], "hemisphere.range=smoothstep", "hemisphere.range_depth=view"},
       {}},
      {"beyond-1-one-layer",
       "ours, first layer",
       kBleedingOurs.look,
       {"hemisphere.bleeding=3", "hemisphere.layers=1"},
       {}},
      {"beyond-2-layers", "ours, layers and back sides", kBleedingOurs.look, {"hemisphere.bleeding=3"}, {}},
      {"beyond-3-views", "two further cameras", kBleedingOurs.look, {"hemisphere.bleeding=3"}, 2}};
  std::vector<double> distances_px;
  double sparks = 0.0;
  Figure figure{"behind", "Behind a drape whose lit side faces away; bleeding strengthened", {}, {}};
  studio.framing = unlit_drape_view();
  for (const Variant& variant : variants) {
    studio.draw.look = std::string(variant.look);
    studio.draw.extra_views = variant.extra_views;
    const auto shot = studio.shoot(variant.settings, "", bleeding_planes());
    studio.draw.extra_views.reset();
    if (!shot) return shot.error();
    if (distances_px.empty()) {
      std::vector<std::string> settings = variant.settings;
      settings.push_back("hemisphere.bleeding=0");
      const auto without = studio.shoot(settings);
      if (!without) return without.error();
      sparks = spark_count(*shot, &*without);
    }
    figure.pictures.push_back(shot->picture(fmt::format("bleeding-{}.png", variant.file), variant.caption));
    distances_px.push_back(uncolored_distance_px(*shot, cloths));
  }
  // With the paper's quadratic range, at least 2 % of the picture's width beside the drape receives none of its colour.
  const double quadratic = distances_px[0], smoothstep = distances_px[1];
  figure.numbers = {
      {"quadratic range: pixels beside the drape without its colour", quadratic, 0.02 * studio.draw.width, kAnything},
      {"the same, smoothstep", smoothstep, 0.0, quadratic},
      {"the same, ours with the first layer alone", distances_px[2], 0.02 * studio.draw.width, kAnything},
      {"the same, ours with layers and back sides", distances_px[3], 0.0, 0.25 * smoothstep},
      {"the same, ours with two further cameras too", distances_px[4], 0.0, 0.25 * smoothstep},
      {"quadratic range: sparks of added light, above 8 times the median of 5 x 5", sparks, 0.0, 0.0}};
  return figure;
}

}  // namespace umbrage
