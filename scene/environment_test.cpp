// Ambient light of skies whose irradiance has a closed form: radiance that is a polynomial of the direction.
#include "scene/environment.h"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <glm/vec3.hpp>
#include <vector>

namespace umbrage {
namespace {

using glm::dvec3;

/// Radiance as a function of the direction, its mean over all directions, and the differences from it of the radiance
/// of a white diffuse surface: of the first degree 2/3 remains, of the second 1/4 [Ramamoorthi and Hanrahan 2001].
struct Sky {
  const char* name;
  std::function<dvec3(dvec3 d)> radiance;
  dvec3 mean;
  std::function<dvec3(dvec3 n)> reflected;
  std::array<float, 3 * kSkyFactors> factors;  ///< per colour: of x, y, z, xx, yy, zz, and half those of xy, yz, zx
};

constexpr double kThird = 1.0 / 3.0;
constexpr float kThirds = 1.0f / 3.0f;

const Sky kSkies[] = {{"linear",
                       [](dvec3 d) { return dvec3(1.0 + 0.9 * d.x, 1.0 + 0.6 * d.y, 1.0 - 0.3 * d.z); },
                       dvec3(1.0),
                       [](dvec3 n) { return dvec3(0.6 * n.x, 0.4 * n.y, -0.2 * n.z); },
                       {0.9f, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.6f, 0, 0, 0, 0, 0, 0, 0, 0, 0, -0.3f, 0, 0, 0, 0, 0, 0}},
                      {"products",
                       [](dvec3 d) { return dvec3(1.0 + d.x * d.y, 1.0 - d.y * d.z, 1.0 + d.z * d.x); },
                       dvec3(1.0),
                       [](dvec3 n) { return 0.25 * dvec3(n.x * n.y, -n.y * n.z, n.z * n.x); },
                       {0, 0, 0, 0, 0, 0, 0.5f, 0, 0, 0, 0, 0, 0, 0, 0, 0, -0.5f, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.5f}},
                      {"squares",
                       [](dvec3 d) { return d * d; },
                       dvec3(kThird),
                       [](dvec3 n) { return 0.25 * (n * n - kThird); },
                       {0, 0, 0, 2 * kThirds, -kThirds,    -kThirds,    0, 0, 0,  //
                        0, 0, 0, -kThirds,    2 * kThirds, -kThirds,    0, 0, 0,  //
                        0, 0, 0, -kThirds,    -kThirds,    2 * kThirds, 0, 0, 0}}};

std::vector<dvec3> directions_all_around() {
  std::vector<dvec3> directions;
  for (int j = 0; j <= 6; ++j)
    for (int i = 0; i < 10; ++i)
      directions.emplace_back(panorama_direction((float(i) + 0.3f) / 10.0f, float(j) / 6.0f));
  return directions;
}

Panorama panorama_of(const Sky& sky) {
  constexpr int kWidth = 512, kHeight = 256;
  Panorama panorama{sky.name, kWidth, kHeight, {}};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const dvec3 color =
          sky.radiance(dvec3(panorama_direction((float(x) + 0.5f) / kWidth, (float(y) + 0.5f) / kHeight)));
      for (int c = 0; c < 3; ++c) panorama.rgb.push_back(float(color[c]));
    }
  return panorama;
}

TEST(EnvironmentSky, PolynomialsHaveTheIrradianceOfTheClosedForm) {
  for (const Sky& sky : kSkies) {
    const EnvironmentLight light = environment_light(panorama_of(sky));
    EXPECT_TRUE(light.lights.empty()) << sky.name;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(light.ambient[c], sky.mean[c], 1e-4) << sky.name << ' ' << c;
    for (const dvec3& n : directions_all_around()) {
      const glm::vec3 reflected = light.shape.at(glm::vec3(n));
      const dvec3 expected = sky.reflected(n);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(reflected[c], expected[c], 1e-4) << sky.name << ' ' << c;
    }
  }
}

TEST(EnvironmentSky, FactorsOfPolynomialsAreTheirCoefficients) {
  for (const Sky& sky : kSkies) {
    const auto factors = sky_factors(environment_light(panorama_of(sky)).shape);
    for (int k = 0; k < 3 * kSkyFactors; ++k) {
      EXPECT_NEAR(factors[std::size_t(k)], sky.factors[std::size_t(k)], 4e-4) << sky.name << ' ' << k;
    }
    for (const dvec3& d : directions_all_around()) {
      const glm::vec3 radiance = sky_radiance(factors, glm::vec3(d));
      const dvec3 expected = sky.radiance(d) - sky.mean;
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(radiance[c], expected[c], 1e-3) << sky.name << ' ' << c;
      const glm::vec3 reflected = sky_radiance(factors, glm::vec3(d), 2.0f / 3.0f, 0.25f);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(reflected[c], sky.reflected(d)[c], 1e-3) << sky.name << ' ' << c;
    }
  }
}

}  // namespace
}  // namespace umbrage
