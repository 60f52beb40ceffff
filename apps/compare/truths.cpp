// The ground truths of a picture.
#include <fmt/format.h>

#include <glm/matrix.hpp>
#include <map>

#include "apps/compare/environments.h"
#include "apps/compare/run.h"
#include "reference/reference.h"

namespace umbrage {

Result<std::vector<Truth>> trace_truths(Run& run, const TracedScene& traced, const PictureInfo& info, float radius,
                                        const ClassMap& classes, const glm::mat3& axes, const std::string& what) {
  const auto& reference = as<ReferenceParams>(params_of(run.recipe.settings, "reference"));
  const int half = run.settings.samples / 2;
  OcclusionSettings occlusion_settings{.samples = half,
                                       .radius = radius,
                                       .falloff = Falloff(reference.falloff),
                                       .normal = HemisphereNormal(reference.normal),
                                       .occluders = Occluders(reference.occluders)};
  for (std::size_t e = 0; run.settings.light && e < environments().size(); ++e)
    occlusion_settings.skies.push_back([&environment = environments()[e], local = glm::transpose(axes)](
                                           glm::vec3 direction) { return environment.radiance(local * direction); });
  std::map<std::uint32_t, Image> halves;  // by seed: all planes
  const auto truth_of = [&](const OcclusionSettings& with) {
    return trace_truth(Quantity::kOcclusion, info, classes, [&](std::uint32_t seed) {
      OcclusionSettings seeded = with;
      seeded.seed = seed;
      auto traced_half = trace_occlusion(traced, info, seeded, run.control(what + ", truth", half));
      run.done += half;
      if (traced_half && !with.skies.empty()) halves[seed] = *traced_half;
      return traced_half;
    });
  };
  auto occlusion = truth_of(occlusion_settings);
  if (!occlusion) return occlusion.error();
  if (occlusion->pixels == 0)
    return usage_error("nothing of '{}' is in view: move the camera or omit the camera options", what);
  run.error_sum += occlusion->error;
  ++run.pictures;
  run.truth_sum += occlusion->sum;
  run.pixels += occlusion->pixels;
  if (run.settings.budget) {
    OcclusionSettings of_layers = occlusion_settings;
    of_layers.occluders = Occluders::kLayers;
    of_layers.skies.clear();
    auto of_view = truth_of(of_layers);
    if (!of_view) return of_view.error();
    occlusion->of_view = std::move(of_view->planes);
  }
  std::vector<Truth> truths;
  truths.push_back(std::move(*occlusion));
  if (!run.settings.light) return truths;
  auto light = trace_truth(Quantity::kLight, info, classes, [&](std::uint32_t seed) {
    auto traced_half = trace_light(
        traced, info, {.samples = half, .direct = false, .reach = radius, .captured_shadows = true, .seed = seed},
        run.control(what + ", truth of light", half));
    run.done += half;
    return traced_half;
  });
  if (!light) return light.error();
  const double mean = mean_of(light->planes, classes);
  if (!(mean > 0.0)) {
    run.result.warnings.push_back(fmt::format(
        "'{}': no surface receives indirect light within {:.4g} scene units: its light is not compared", what, radius));
  } else {
    run.light_error_sum += light->error / (mean * mean);
    ++run.light_pictures;
    truths.push_back(std::move(*light));
  }
  for (int q = kFirstEnvironment; q < kQuantities; ++q) {
    auto of_sky =
        trace_truth(Quantity(q), info, classes, [&](std::uint32_t seed) -> Result<Image> { return halves.at(seed); });
    if (!of_sky) return of_sky.error();
    if (!(mean_of(of_sky->planes, classes) > 0.0)) {
      run.result.warnings.push_back(fmt::format(
          "'{}': everything is occluded within {:.4g} scene units: the light of the environment '{}' is not compared",
          what, radius, kQuantityNames[std::size_t(q)]));
      continue;
    }
    truths.push_back(std::move(*of_sky));
  }
  return truths;
}

}  // namespace umbrage
