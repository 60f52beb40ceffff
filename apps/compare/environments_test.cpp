// Tests of the environments: their harmonics, and the order of techniques under them.
#include "apps/compare/environments.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "apps/compare/compare_support.h"

namespace umbrage {
namespace {

using glm::vec3;
using test::compared;

vec3 harmonic_sky(vec3 d) { return {1.0f + d.z, 0.5f + 0.25f * d.x, 2.0f + d.x * d.y}; }

/// Returns the cosine-weighted mean radiance of the hemisphere of a normal, by quadrature.
vec3 irradiance(const Environment& environment, vec3 normal) {
  constexpr int kRows = 256, kColumns = 512;
  glm::dvec3 sum(0.0);
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      const float z = 1.0f - 2.0f * (float(row) + 0.5f) / kRows, across = std::sqrt(1.0f - z * z);
      const float angle = 2.0f * std::numbers::pi_v<float> * float(column) / kColumns;
      const vec3 direction(across * std::cos(angle), across * std::sin(angle), z);
      sum += glm::dvec3(environment.radiance(direction)) * double(std::max(glm::dot(direction, normal), 0.0f));
    }
  return vec3(sum * 4.0 / double(kRows * kColumns));
}

TEST(Environments, HarmonicsAreTheIrradiance) {
  const glm::mat3 axes(vec3(0, 0, 1), vec3(1, 0, 0), vec3(0, 1, 0));
  const auto expect_near = [&](const Environment& environment, float tolerance) {
    const EnvironmentAmbient ambient = ambient_of(environment, axes);
    for (const vec3 normal : {vec3(0, 0, 1), vec3(0, 0, -1), vec3(1, 0, 0), glm::normalize(vec3(1, -2, 0.5f))}) {
      const vec3 expected = irradiance(environment, normal), got = ambient.mean + ambient.shape.at(axes * normal);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], expected[c], tolerance) << environment.name << c;
    }
  };
  expect_near({"harmonic", harmonic_sky}, 1e-3f);
  // Irradiance beyond the second degree is small [Ramamoorthi and Hanrahan 2001].
  for (const Environment& environment : environments()) expect_near(environment, 0.05f);
}

TEST(Environments, OpenDirectionsAreCloserToTheTruthThanOcclusionAlone) {
  CompareSettings settings;
  settings.models = {"scene:atrium?detail=20000", "scene:room?detail=20000"};
  settings.sizes = {{240, 135}};
  settings.techniques = {"bitmask", "ssdo"};
  settings.cameras = 1;
  settings.samples = 64;
  settings.runs = 1;
  settings.light = true;
  settings.filter = kNoFilter;
  const Comparison comparison = compared(settings);
  const auto is_paper = [](const std::string& setting) {
    return setting.find("directions=paper") != std::string::npos;
  };
  double bitmask = 0.0, papers = 0.0, occlusion = 0.0;  // squared errors under the clear sky
  for (const ComparedView& view : comparison.views) {
    if (view.quantity != Quantity::kClearSky) continue;
    for (const ComparedView& other : comparison.views)
      if (other.quantity == Quantity::kOcclusion && other.scene == view.scene)
        for (const auto& technique : other.techniques)
          if (technique.name == "bitmask" && technique.setting.empty()) {
            Image light(view.truth.width, view.truth.height);
            for (std::size_t c = 0; c < 3; ++c) {
              // Occlusion times the mean light of the sky.
              Plane& plane = light.add(view.truth.names[c]) = technique.picture.plane("ao");
              const float factor = ambient_of(environments()[0], glm::mat3(1.0f)).mean[int(c)];
              for (int y = 0; y < plane.height; ++y)
                for (int x = 0; x < plane.width; ++x) plane.at(x, y) *= factor;
            }
            occlusion += std::pow(score_light(light, view.truth, view.classes).covered.rmse, 2.0);
          }
  }
  for (const Score& score : comparison.scores) {
    if (score.quantity != Quantity::kClearSky) continue;
    if (score.technique == "bitmask" && score.setting.empty()) bitmask += std::pow(score.card.covered.rmse, 2.0);
    if (score.technique == "ssdo" && is_paper(score.setting)) papers += std::pow(score.card.covered.rmse, 2.0);
  }
  bitmask = std::sqrt(bitmask / 2.0), papers = std::sqrt(papers / 2.0), occlusion = std::sqrt(occlusion / 2.0);
  RecordProperty("bitmask", std::to_string(bitmask));
  RecordProperty("ssdo", std::to_string(papers));
  RecordProperty("occlusion", std::to_string(occlusion));
  EXPECT_LT(bitmask, 0.6 * papers);
  EXPECT_LT(papers, occlusion);
}

}  // namespace
}  // namespace umbrage
