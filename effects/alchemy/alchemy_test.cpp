// Compares `alchemy` with a literal port of the papers' formulas in double, and tests it on planes.
#include "effects/alchemy/alchemy.h"

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

/// Returns `ao` of a pixel by the formulas of the papers.
double published_ao(const GBuffer& g, const AlchemyConstants& c, const AlchemyParams& params, double radius, int x,
                    int y) {
  const glm::dvec3 at = position(g, x, y), n = normal(g, x, y);
  const Camera& camera = g.info.camera;
  const double spread = camera.projection == Projection::kOrthographic ? 1.0 : -at.z;
  const double radius_px = radius / (spread * (double(camera.right) - camera.left) / g.info.width);
  const unsigned hash = ((3u * unsigned(x)) ^ (unsigned(y) + unsigned(x) * unsigned(y)));
  const double angle = 10.0 * hash + std::numbers::pi;  // direction_of_turn() subtracts half a turn
  double sum = 0.0;
  for (int i = 0; i < params.samples; ++i) {
    const double px = c.points[2 * i], py = c.points[2 * i + 1];
    const double dx = radius_px * (px * std::cos(angle) - py * std::sin(angle));
    const double dy = radius_px * (px * std::sin(angle) + py * std::cos(angle));
    const glm::ivec2 tap = pixel_at(g, x + 0.5 + dx, y + 0.5 - dy);
    if (!std::isfinite(g.layers[0].planes[0].at(tap.x, tap.y))) continue;
    const glm::dvec3 v = position(g, tap.x, tap.y) - at;
    const double vv = glm::dot(v, v), vn = glm::dot(v, n);
    double term = std::max(0.0, vn + at.z * params.bias) / (vv + params.epsilon * radius * radius);
    if (params.formula == 1) term *= std::pow(std::max(0.0, radius * radius - vv), 3.0) / std::pow(radius, 6.0);
    sum += term;
  }
  const double a = 1.0 - (params.formula == 1 ? 5.0 : 2.0) * params.strength * radius / params.samples * sum;
  return std::pow(std::max(0.0, a), double(params.contrast));
}

TEST(Alchemy, BothFormulasMatchThePapers) {
  const Effect& effect = *find_effect("alchemy");
  for (const bool orthographic : {false, true})
    for (const Settings& base : {Settings{}, Settings{{"formula", "scalable"}, {"bias", "0"}},
                                 Settings{{"contrast", "2"}, {"samples", "32"}, {"turns", "13"}}}) {
      Settings settings = base;
      settings.push_back({"radius", "0.6"});
      const GBuffer g = waves(128, 96, orthographic);
      const ParameterBytes params = parameters_of(effect, settings);
      const auto c = constants_of<AlchemyConstants>("alchemy", g.info, settings);
      on_every_target("alchemy", g, settings, [&](const Image& image) {
        expect_matches_formula(g, image.plane("ao"), 0.8, 300,
                               [&](int x, int y) { return published_ao(g, c, as<AlchemyParams>(params), 0.6, x, y); });
      });
    }
}

TEST(Alchemy, PlanesAreUnoccluded) {
  for (const double tilt : {0.0, 0.6, 1.2}) {
    const GBuffer g = tilted_plane(96, 64, tilt);
    const Plane ao = run_effect(*find_effect("alchemy"), g, {{"radius", "0.5"}}, {}).planes[0];
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 96; ++x) ASSERT_EQ(ao.at(x, y), 1.0f) << tilt << ' ' << x << ' ' << y;
  }
}

}  // namespace
}  // namespace umbrage
