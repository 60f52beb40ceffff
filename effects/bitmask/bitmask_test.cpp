// `bitmask` against quadrature and closed forms: infinite walls at every tilt of the camera, corners, slabs, spheres,
// the light of a wall; and what must not change it.
#include "effects/bitmask/bitmask.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "machine/kernel_frame.h"
#include "run_effect.h"
#include "scene/builtin.h"
#include "scene/framing.h"
#include "support.h"

namespace umbrage {
namespace {

using test::Settings;

constexpr double kPi = std::numbers::pi;
constexpr double kRadian = kPi / 180.0;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

Settings joined(Settings first, const Settings& second) {
  for (const auto& [name, value] : second) {
    std::erase_if(first, [&](const auto& pair) { return pair.first == name; });
    first.push_back({name, value});
  }
  return first;
}

/// The nearest of some planes along a ray, as a depth buffer holds it.
struct Wall {
  glm::dvec3 point, normal;
  std::function<bool(glm::dvec3)> holds = [](glm::dvec3) { return true; };  ///< whether the plane reaches that far
};

struct Ray {
  glm::dvec3 origin, direction;  ///< direction.z is -1: its length counts depth
};

Ray ray_of(const Camera& camera, int width, int height, int x, int y) {
  const double u = camera.left + (camera.right - camera.left) * (x + 0.5) / width;
  const double v = camera.top - (camera.top - camera.bottom) * (y + 0.5) / height;
  if (camera.projection == Projection::kOrthographic) return {{u, v, 0.0}, {0.0, 0.0, -1.0}};
  return {{0.0, 0.0, 0.0}, {u, v, -1.0}};
}

/// A G-buffer of walls given in view space.
GBuffer picture(int width, int height, const Camera& camera, const std::vector<Wall>& walls) {
  GBuffer g = test::empty_gbuffer(width, height);
  g.info.camera = camera;
  Image& image = g.layers[0];
  for (const char* name : {"depth", "normal.x", "normal.y", "normal.z"}) image.add(name);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Ray ray = ray_of(camera, width, height, x, y);
      double nearest = kInfinity;
      glm::dvec3 normal(0.0);
      for (const Wall& wall : walls) {
        const double depth = glm::dot(wall.point - ray.origin, wall.normal) / glm::dot(ray.direction, wall.normal);
        if (!(depth > 1e-6 && depth < nearest) || !wall.holds(ray.origin + depth * ray.direction)) continue;
        nearest = depth;
        normal = glm::dot(wall.normal, ray.direction) < 0.0 ? wall.normal : -wall.normal;
      }
      image.planes[0].at(x, y) = nearest < 1e6 ? float(nearest) : kInfinity;
      for (int k = 0; k < 3; ++k) image.planes[1 + k].at(x, y) = nearest < 1e6 ? float(normal[k]) : 0.0f;
    }
  return g;
}

Camera camera_of(bool orthographic, double height_at_5, int width, int height) {
  const float aspect = float(width) / float(height);
  if (orthographic) return orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, float(height_at_5), aspect);
  return perspective_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, float(2.0 * std::atan(height_at_5 / 10.0) / kRadian),
                            aspect);
}

// ---- infinite walls
// ------------------------------------------------------------------------------------------

constexpr int kWide = 2049;     // the one pixel that is looked at lies in its middle
constexpr double kAway = 5.0;   // depth of that pixel
constexpr double kGap = 850.0;  // pixels around it in which there is nothing: at the taps beyond, one pixel is no angle

/// A surface through the middle pixel, seen at `tilt` from its normal, and a wall that rises from there at `elevation`.
/// The camera looks toward it where `tilt` is above 0.
GBuffer wall_picture(double elevation_deg, double tilt_deg, bool orthographic) {
  const double tilt = tilt_deg * kRadian, elevation = elevation_deg * kRadian;
  // At right angles to the crease, x and the line of sight: the eye in the direction `tilt` from the normal, away from
  // the wall, which is on the side +x.
  const glm::dvec3 normal(std::sin(tilt), 0.0, std::cos(tilt)), along(std::cos(tilt), 0.0, -std::sin(tilt));
  const glm::dvec3 up_the_wall = std::cos(elevation) * along + std::sin(elevation) * normal;
  const glm::dvec3 wall_normal = std::cos(elevation) * normal - std::sin(elevation) * along;
  const glm::dvec3 middle(0.0, 0.0, -kAway);
  const Camera camera = camera_of(orthographic, 0.5, kWide, kWide);
  GBuffer g = picture(kWide, kWide, camera,
                      {{middle, wall_normal, [=](glm::dvec3 p) { return glm::dot(p - middle, up_the_wall) > 0.0; }}});
  const int m = kWide / 2;
  for (int y = 0; y < kWide; ++y)
    for (int x = 0; x < kWide; ++x)
      if ((x - m) * (x - m) + (y - m) * (y - m) < kGap * kGap) g.layers[0].planes[0].at(x, y) = kInfinity;
  g.layers[0].planes[0].at(m, m) = float(kAway);
  for (int k = 0; k < 3; ++k) g.layers[0].planes[1 + k].at(m, m) = float(normal[k]);
  return g;
}

/// What the kernels of the passes that these settings need write at the middle of the picture: one tile of 16 pixels is
/// computed, not the whole picture.
std::vector<double> at_middle(GBuffer& g, const Settings& settings, std::vector<std::string> wanted, bool scalar) {
  const Effect& effect = *find_effect("bitmask");
  const ParameterBytes params = test::parameters_of(effect, settings);
  BitmaskConstants constants;
  effect.constants(params, g.info, &constants);
  const Camera& camera = g.info.camera;
  const int width = g.info.width, height = g.info.height;
  Image& image = g.layers[0];
  std::vector<double> found(wanted.size());
  for (const Pass& pass : effect.passes) {
    if (pass.needed && !pass.needed(params)) continue;
    std::vector<KernelPlane> planes;
    const auto add = [&](std::string_view name) {
      if (!image.find(name)) {
        Plane fresh(width, height, name.ends_with("depth") ? kInfinity : 0.0f);
        image.add(name) = std::move(fresh);
      }
    };
    for (std::string_view name : pass.inputs) add(name);
    for (std::string_view name : pass.outputs) add(name);
    for (std::string_view name : pass.inputs) planes.push_back({name, image.plane(name).data()});
    for (std::string_view name : pass.outputs)
      planes.push_back({name, name.starts_with("layer") ? nullptr : image.plane(name).data()});
    const FrameConstants frame = {.width = width,
                                  .height = height,
                                  .stride = image.planes[0].stride,
                                  .orthographic = camera.projection == Projection::kOrthographic ? 1 : 0,
                                  .round = 0,
                                  .ray_scale_x = (camera.right - camera.left) / float(width),
                                  .ray_offset_x = camera.left,
                                  .ray_scale_y = -(camera.top - camera.bottom) / float(height),
                                  .ray_offset_y = camera.top};
    const int m = height / 2, x0 = width / 2 / 16 * 16;
    const KernelFrame kernel_frame{frame, &constants, planes};
    const bool gathers = pass.name != "mips" && pass.name != "sent";
    const Tile tile = gathers ? Tile{x0, m, x0 + 16, m + 1} : Tile{0, 0, width, height};
    (scalar ? pass.scalar : pass.lanes)(kernel_frame, tile);
  }
  for (std::size_t k = 0; k < wanted.size(); ++k) found[k] = image.plane(wanted[k]).at(width / 2, height / 2);
  return found;
}

/// The mean over jittered frames.
std::vector<double> mean_at_middle(GBuffer g, const Settings& settings, const std::vector<std::string>& wanted,
                                   bool scalar = false) {
  std::vector<double> sum(wanted.size(), 0.0);
  constexpr int kFrames = 8;
  for (int frame = 0; frame < kFrames; ++frame) {
    const auto one = at_middle(g, joined(settings, {{"frame", std::to_string(frame)}}), wanted, scalar);
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += one[k] / kFrames;
  }
  return sum;
}

const Settings kMany = {{"slices", "64"}, {"steps", "512"},   {"distribution", "3"}, {"mips", "off"},
                        {"radius", "2"},  {"border", "open"}, {"slope", "0"},        {"thickness", "1e2"}};

TEST(Bitmask, WallsAsTheirMeasuresHaveThem) {
  // The table of the measures, by quadrature.
  struct Row {
    double elevation_deg, tilt_deg, exact, uniform, sectors;
  };
  for (const Row& row : {Row{30, 0, .9330, .8905, .9647}, Row{30, 75, .9330, .8335, .9263},
                         Row{60, 0, .7500, .7560, .8432}, Row{90, 60, .5000, .6466, .6561}}) {
    SCOPED_TRACE(fmt::format("wall of {} degrees, camera tilted by {}", row.elevation_deg, row.tilt_deg));
    const GBuffer g = wall_picture(row.elevation_deg, row.tilt_deg, false);
    const auto ao = [&](const Settings& settings) { return mean_at_middle(g, joined(kMany, settings), {"ao"})[0]; };
    EXPECT_NEAR(ao({{"measure", "exact"}}), row.exact, 1e-3);
    EXPECT_NEAR(ao({{"measure", "exact"}, {"mode", "infinite"}}), row.exact, 1e-3) << "by the horizon";
    EXPECT_NEAR(ao({{"measure", "uniform"}}), row.uniform, 1e-3);
    EXPECT_NEAR(ao({{"measure", "sectors"}}), row.sectors, 1e-3);
  }
}

TEST(Bitmask, MeanOpenDirectionBesideAWall) {
  // Of a quarter of a ball, by the cosine: 2/3 away from the wall, pi/3 along the normal.
  const double length = std::hypot(2.0 / 3.0, kPi / 3.0);
  for (const double tilt : {20.0, 45.0, 70.0}) {
    const auto bent =
        mean_at_middle(wall_picture(90, tilt, false), joined(kMany, {{"bent", "on"}}), {"bent.x", "bent.y", "bent.z"});
    const double s = std::sin(tilt * kRadian), c = std::cos(tilt * kRadian);
    EXPECT_NEAR(bent[0], (s * kPi / 3.0 - c * 2.0 / 3.0) / length, 0.02) << tilt;
    EXPECT_NEAR(bent[1], 0.0, 0.01) << tilt;
    EXPECT_NEAR(bent[2], (c * kPi / 3.0 + s * 2.0 / 3.0) / length, 0.02) << tilt;
  }
}

TEST(Bitmask, LightOfAWallIsExact) {
  for (const auto& [elevation, tilt] : {std::pair{90.0, 20.0}, {90.0, 45.0}, {90.0, 70.0}, {60.0, 0.0}, {60.0, 60.0}}) {
    GBuffer g = wall_picture(elevation, tilt, false);
    for (const char* name : {"direct.r", "direct.g", "direct.b"}) {
      Plane light(kWide, kWide, name == std::string("direct.g") ? 2.0f : 0.5f);
      g.layers[0].add(name) = std::move(light);
    }
    const auto light =
        mean_at_middle(g, joined(kMany, {{"bleeding", "1"}}), {"indirect.r", "indirect.g", "indirect.b", "ao"});
    const double share = (1.0 - std::cos(elevation * kRadian)) / 2.0;
    EXPECT_NEAR(light[0] / (0.5 * share), 1.0, 0.01) << elevation << ' ' << tilt;
    EXPECT_NEAR(light[1] / (2.0 * share), 1.0, 0.01) << elevation << ' ' << tilt;
    EXPECT_NEAR(light[2] / (0.5 * share), 1.0, 0.01) << elevation << ' ' << tilt;
    EXPECT_NEAR(light[3], 1.0 - share, 2e-3) << elevation << ' ' << tilt;
  }
}

// ---- planes
// ------------------------------------------------------------------------------------------

TEST(Bitmask, PlanesAreOpenAtEveryTilt) {
  for (const bool orthographic : {false, true})
    for (const double tilt_deg : {0.0, 35.0, 70.0, 84.0}) {
      const double tilt = tilt_deg * kRadian, turn = 0.6;
      const glm::dvec3 normal(std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt));
      const Camera camera = camera_of(orthographic, 4.0, 157, 123);
      const GBuffer g = picture(157, 123, camera, {{{0.0, 0.0, -5.0}, normal}});
      for (const Settings& settings :
           {Settings{}, Settings{{"mode", "infinite"}}, Settings{{"measure", "uniform"}},
            Settings{{"noise", "hash"}, {"slices", "3"}}, Settings{{"mode", "layers"}}, Settings{{"bent", "on"}}})
        test::on_every_target("bitmask", g, joined(settings, {{"radius", "1.5"}}), [&](const Image& image) {
          const Plane& ao = image.plane("ao");
          long off = 0;
          for (int y = 0; y < ao.height; ++y)
            for (int x = 0; x < ao.width; ++x) off += std::fabs(ao.at(x, y) - 1.0f) > 1e-6f;
          EXPECT_EQ(off, 0) << "tilt " << tilt_deg << (orthographic ? ", no perspective, " : ", ")
                            << (settings.empty() ? "" : settings[0].second);
        });
    }
}

}  // namespace
}  // namespace umbrage
