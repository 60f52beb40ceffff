// Compares `hbao` with a literal port of the paper's formula in double, and tests it on planes.
#include "effects/hbao/hbao.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "run_effect.h"
#include "support.h"
#include "waves.h"

namespace umbrage {
namespace {

using namespace test;

unsigned scrambled(unsigned v) {
  v = (v ^ (v >> 16)) * 0x7feb352du;
  v = (v ^ (v >> 15)) * 0x846ca68bu;
  return v ^ (v >> 16);
}

/// Returns `ao` of a pixel by section 3 of the paper, with angles instead of sines and cosines. Differs: the angle of a
/// tap above the tangent is measured in the tap's own direction, see hbao.kernel.h.
double published_ao(const GBuffer& g, const HbaoParams& params, double radius, int x, int y) {
  const glm::dvec3 at = position(g, x, y), n = normal(g, x, y);
  const Camera& camera = g.info.camera;
  const double spread = camera.projection == Projection::kOrthographic ? 1.0 : -at.z;
  const double radius_px = radius / (spread * (double(camera.right) - camera.left) / g.info.width);
  const unsigned first = scrambled(unsigned(x) ^ scrambled(unsigned(y) + 0x9e3779b9u));
  const double turn = (first >> 8) * 0x1p-24, jitter = (scrambled(first + 1u) >> 8) * 0x1p-24;
  double sum = 0.0;
  for (int i = 0; i < params.directions; ++i) {
    const double theta = 2.0 * std::numbers::pi * (turn + i) / params.directions - std::numbers::pi;
    const double dx = std::cos(theta), dy = std::sin(theta);
    const auto tangent = [&](double x, double y) { return std::atan(-(n.x * x + n.y * y) / n.z / std::hypot(x, y)); };
    const double bias = params.angle_bias * std::numbers::pi / 180.0, zenith = std::numbers::pi / 2.0;
    double horizon = std::min(tangent(dx, dy) + bias, zenith);
    for (int k = 0; k < params.steps; ++k) {
      const double offset_px = (jitter + k) / params.steps * radius_px + 1.0;
      const glm::ivec2 tap = pixel_at(g, x + 0.5 + dx * offset_px, y + 0.5 - dy * offset_px);
      if (!std::isfinite(g.layers[0].planes[0].at(tap.x, tap.y))) continue;
      const glm::dvec3 v = position(g, tap.x, tap.y) - at;
      const double length = glm::length(v);
      if (length >= radius || length == 0.0) continue;
      const double above = std::atan2(v.z, std::hypot(v.x, v.y)) - tangent(v.x, v.y);
      const double elevation = std::min(tangent(dx, dy) + above, zenith);
      if (elevation <= horizon) continue;
      const double weight = params.attenuation ? 1.0 - length * length / (radius * radius) : 1.0;
      sum += weight * (std::sin(elevation) - std::sin(horizon));
      horizon = elevation;
    }
  }
  return std::max(0.0, 1.0 - params.strength * sum / params.directions);
}

TEST(Hbao, MatchesTheFormulaOfThePaper) {
  const Effect& effect = *find_effect("hbao");
  for (const bool orthographic : {false, true})
    for (const Settings& base :
         {Settings{}, Settings{{"angle_bias", "30"}}, Settings{{"attenuation", "off"}, {"directions", "5"}}}) {
      Settings settings = base;
      settings.push_back({"radius", "0.6"});
      const GBuffer g = waves(128, 96, orthographic);
      const ParameterBytes params = parameters_of(effect, settings);
      on_every_target("hbao", g, settings, [&](const Image& image) {
        expect_matches_formula(g, image.plane("ao"), 0.9, 200,
                               [&](int x, int y) { return published_ao(g, as<HbaoParams>(params), 0.6, x, y); });
      });
    }
}

TEST(Hbao, PlanesAreUnoccludedAtAnyTilt) {
  for (const double tilt : {0.0, 0.5, 1.0, 1.3, 1.5, 1.55})
    for (const char* radius : {"2", "0.3"}) {
      const GBuffer g = tilted_plane(96, 64, tilt);
      on_every_target("hbao", g, {{"radius", radius}}, [&](const Image& image) {
        double min = 1.0;
        for (int y = 0; y < 64; ++y)
          for (int x = 0; x < 96; ++x) min = std::min(min, double(image.plane("ao").at(x, y)));
        EXPECT_EQ(min, 1.0) << tilt << " " << radius;
      });
    }
}

}  // namespace
}  // namespace umbrage
