// `alchemy` against its paper's formula, ported literally in double, and on planes.
#include "effects/alchemy/alchemy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "run_effect.h"
#include "support.h"
#include "waves.h"

namespace umbrage {
namespace {

using test::normal;
using test::pixel_at;
using test::position;
using test::Settings;
using test::waves;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

double listing(const GBuffer& g, const AlchemyConstants& c, const AlchemyParams& params, double radius, int x, int y) {
  const glm::dvec3 at = position(g, x, y), n = normal(g, x, y);
  const Camera& camera = g.info.camera;
  const double spread = camera.projection == Projection::kOrthographic ? 1.0 : -at.z;
  const double reach = radius / (spread * (double(camera.right) - camera.left) / g.info.width);
  const unsigned hash = ((3u * unsigned(x)) ^ (unsigned(y) + unsigned(x) * unsigned(y)));
  const double angle = 10.0 * hash + std::numbers::pi;  // ours counts from half a turn
  double sum = 0.0;
  for (int i = 0; i < params.samples; ++i) {
    const double px = c.points[2 * i], py = c.points[2 * i + 1];
    const double dx = reach * (px * std::cos(angle) - py * std::sin(angle));
    const double dy = reach * (px * std::sin(angle) + py * std::cos(angle));
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

TEST(Alchemy, BothFormulasAreTheirPapers) {
  const Effect& effect = *find_effect("alchemy");
  for (const bool orthographic : {false, true})
    for (const Settings& more : {Settings{}, Settings{{"formula", "scalable"}, {"bias", "0"}},
                                 Settings{{"contrast", "2"}, {"samples", "32"}, {"turns", "13"}}}) {
      Settings settings = more;
      settings.push_back({"radius", "0.6"});
      const GBuffer g = waves(128, 96, orthographic);
      const ParameterBytes params = test::parameters_of(effect, settings);
      AlchemyConstants c;
      effect.constants(params, g.info, &c);
      test::on_every_target("alchemy", g, settings, [&](const Image& image) {
        long off = 0, dark = 0, compared = 0;
        for (int y = 0; y < 96; ++y)
          for (int x = 0; x < 128; ++x) {
            if (!std::isfinite(g.layers[0].planes[0].at(x, y))) continue;
            const double truth = listing(g, c, as<AlchemyParams>(params), 0.6, x, y);
            off += std::fabs(image.plane("ao").at(x, y) - truth) > 2e-4;
            dark += truth < 0.8;
            ++compared;
          }
        EXPECT_LE(off, compared / 200) << "samples on a pixel's border fall to either side";
        EXPECT_GT(dark, 300);
      });
    }
}

TEST(Alchemy, PlanesAreOpen) {
  for (const double tilt : {0.0, 0.6, 1.2}) {
    GBuffer g = test::empty_gbuffer(96, 64);
    for (const char* name : {"depth", "normal.x", "normal.y", "normal.z"}) g.layers[0].add(name);
    const glm::dvec3 n(std::sin(tilt), 0.0, std::cos(tilt));
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 96; ++x) {
        const double u = (2.0 * (x + 0.5) / 96 - 1.0) * g.info.camera.right;
        const double depth = 5.0 * n.z / (n.z - n.x * u);
        g.layers[0].planes[0].at(x, y) = depth > 0.0 && depth < 1e4 ? float(depth) : kInfinity;
        for (int k = 0; k < 3; ++k) g.layers[0].planes[1 + k].at(x, y) = float(n[k]);
      }
    const Plane ao = test::run_effect(*find_effect("alchemy"), g, {{"radius", "0.5"}}, {}).planes[0];
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 96; ++x) ASSERT_EQ(ao.at(x, y), 1.0f) << tilt << ' ' << x << ' ' << y;
  }
}

}  // namespace
}  // namespace umbrage
