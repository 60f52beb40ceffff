// The parameter table, kernel constants and dispatches of `ssdo` [Ritschel et al. 2009].
#include "effects/ssdo/ssdo.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "core/effect.h"
#include "core/hash.h"
#include "core/parameters.h"
#include "effects/hemisphere/layer_views.h"
#include "effects/hemisphere/sent_planes.h"
#include "kernels/ssdo_light.h"
#include "kernels/ssdo_occlusion.h"
#include "kernels/ssdo_sent.h"

namespace umbrage {
namespace {

// The settings of the paper.
constexpr std::string_view kPaper =
    "directions=paper lengths=linear steps=1 thickness=0 border=open difference=off bounce=sender";
constexpr float kAssumedVisibility = 0.7f;  // of ambient light, where it is not computed: typical of a room

const std::vector<Parameter> kSsdoTable = {
    int_row("samples", &SsdoParams::samples, {.initial = 16, .min = 1, .max = kSsdoMaxSamples}, "directions per pixel"),
    int_row("steps", &SsdoParams::steps, {.initial = 2, .min = 1, .max = 16},
            "sample points along each direction; the nearest hidden one hides the direction"),
    radius_row("radius", &SsdoParams::radius,
               "max distance of a sample point, in scene units or in percent of the bounding-sphere radius; "
               "`occlusion_radius` sets it"),
    choice_row("directions", &SsdoParams::directions, kSsdoCosine, {"cosine", "uniform", "paper"},
               "stratified, with a density proportional to the cosine, or uniform; or uniform and random, with weights "
               "that are not normalized"),
    choice_row("lengths", &SsdoParams::lengths, kSsdoRoot, {"root", "linear"},
               "distances of sample points, for uniform numbers t: R sqrt(t), or R t, which misses more occluders"),
    int_row("seed", &SsdoParams::seed, {.max = 1e6}, "seed of the directions and of the noise"),
    int_row("noise", &SsdoParams::noise,
            {.initial = 4, .max = 64, .unit = "px", .zero_means = "as large as the picture"},
            "side of the noise tile that rotates the directions; 1: none"),
    real_row("thickness", &SsdoParams::thickness, {.initial = 1, .max = 1e6, .zero_means = "infinite"},
             "assumed thickness of surfaces, as a fraction of the radius"),
    real_row("bias", &SsdoParams::bias, {.initial = 0.01, .max = 1},
             "occluders that rise less than this fraction of the radius above the surface's plane do not count"),
    choice_row("border", &SsdoParams::border, kSsdoSkip, {"skip", "open"},
               "directions outside the picture: left out of the estimate, or open"),
    real_row("directional", &SsdoParams::directional, {.initial = 1, .max = 10, .zero_means = "off"},
             "factor for the direction of ambient light: open directions take the light that comes from there; as the "
             "factor of ambient light, lighting.ambient"),
    bool_row("difference", &SsdoParams::difference, true,
             "compare open directions with all sampled directions, which keeps open surfaces free of noise; off: with "
             "the whole hemisphere, as in the paper"),
    real_row("bleeding", &SsdoParams::bleeding, {.max = 100, .zero_means = "off"},
             "factor for the light from the surfaces that hide directions"),
    choice_row("bounce", &SsdoParams::bounce, kSsdoRadiance, {"radiance", "sender"},
               "a hidden direction brings the radiance of the surface there; or, by the paper's form factor, that "
               "surface sends the light of a patch of fixed size"),
    real_row("min_distance", &SsdoParams::min_distance, {.initial = 0.2, .max = 1},
             "bounce sender: min distance of a sender, as a fraction of the radius; avoids bright spots"),
    real_row("ambient_bounce", &SsdoParams::ambient_bounce, {.initial = 1, .max = 10},
             "factor for the ambient light that surfaces reflect"),
    int_row("bounces", &SsdoParams::bounces, {.initial = 1, .min = 1, .max = 16},
            "number of bounces; each reflects the indirect light of the one before"),
    int_row("layers", &SsdoParams::layers, {.max = kLayersRead, .zero_means = "all"},
            "number of captured depth layers in which occluders are searched"),
};

// With a single sample, a flip of this sample changes occlusion and light from none to full: two quanta.
constexpr double kSsdoQuantum = 0.5;

/// Fills in SsdoConstants::points. Azimuths and lengths are those of the golden ratio's sequence in two dimensions
/// [Roberts 2018]; directions `paper`: random numbers.
void fill_points(const SsdoParams& params, float* points) {
  std::mt19937 random(std::uint32_t(params.seed) + 1u);
  const auto uniform = [&] { return random() * 0x1p-32; };
  for (int k = 0; k < params.samples; ++k) {
    double turn = fractional_part(0.5 + (k + 1) / kPlasticNumber);
    double length = fractional_part(0.5 + (k + 1) / (kPlasticNumber * kPlasticNumber));
    double place = fractional_part((k + 1) * std::numbers::phi);
    if (params.directions == kSsdoPaper) turn = uniform(), length = uniform(), place = uniform();
    const double angle = 2.0 * std::numbers::pi * turn;
    const double row[kSsdoPointValues] = {params.directions == kSsdoPaper ? 0.0 : k, place, std::cos(angle),
                                          std::sin(angle), length};
    for (int i = 0; i < kSsdoPointValues; ++i) points[kSsdoPointValues * k + i] = float(row[i]);
  }
}

void fill_ssdo(const SsdoParams& params, const PictureInfo& info, SsdoConstants& c) {
  c.samples = params.samples;
  c.steps = params.steps;
  c.one_over_steps = 1.0f / float(params.steps);
  c.radius = std::clamp(absolute_length(params.radius, info.scene_radius), 1e-15f, 1e15f);  // its square stays finite
  c.stratum = params.directions == kSsdoPaper ? 1.0f : 1.0f / float(params.samples);
  c.cosine = params.directions == kSsdoCosine ? 1 : 0;
  c.normalized = params.directions == kSsdoPaper ? 0 : 1;
  c.root = params.lengths == kSsdoRoot ? 1 : 0;
  c.even = 1;
  c.seed = params.seed;
  c.noise = params.noise;
  c.one_over_noise = 1.0f / float(std::max(1, params.noise));
  c.thickness = params.thickness > 0.0f ? params.thickness * c.radius : std::numeric_limits<float>::max();
  c.min_height = params.bias * c.radius;
  c.skip_outside = params.border == kSsdoSkip ? 1 : 0;
  c.directional = info.ambient_shape.even() ? 0.0f : params.directional;
  c.difference = params.difference;
  c.bleeding = params.bleeding;
  c.radiance = params.bounce == kSsdoRadiance ? 1 : 0;
  c.min_distance2 = std::max(params.min_distance * params.min_distance * c.radius * c.radius, 1e-30f);
  c.radius2 = c.radius * c.radius;
  c.ambient_bounce = params.ambient_bounce;
  c.assumed_visibility = kAssumedVisibility;
  fill_layer_views(params.layers, info, c);
  const auto factors = sky_factors(info.ambient_shape);
  std::copy(factors.begin(), factors.end(), c.sky);
  fill_points(params, c.points);
}

bool gathers_light(const ParameterBytes& bytes) {
  const auto& params = as<SsdoParams>(bytes);
  return params.bleeding > 0.0f || params.directional > 0.0f;
}
bool gathers_no_light(const ParameterBytes& bytes) { return !gathers_light(bytes); }
int ssdo_rounds(const ParameterBytes& bytes, const PictureInfo&) {
  return as<SsdoParams>(bytes).bleeding > 0.0f ? as<SsdoParams>(bytes).bounces : 1;
}

/// Returns a dispatch that reads the planes `searched` anywhere in the picture, and writes `ao` and `more_outputs`.
Dispatch search_dispatch(std::string_view name, const Kernel& kernel, bool (*needed)(const ParameterBytes&),
                         const PlaneNames& searched, const PlaneNames& more_outputs) {
  return {.name = name,
          .inputs = joined(searched, {"normal.x", "normal.y", "normal.z"}),
          .outputs = joined({"ao"}, more_outputs),
          .kernel = kernel,
          .needed = needed,
          .tile = kSquareTile,
          .reach = own_row,
          .unbounded_inputs = searched};
}

}  // namespace

Effect effect_ssdo() {
  return occlusion_effect<fill_ssdo>(
      kSsdoTable,
      {.name = "ssdo",
       .summary = "directional occlusion: the light of open directions, and of the surfaces that hide the others",
       .source = "Ritschel et al. 2009",
       .set_radius = set_radius_of<&SsdoParams::radius>,
       .noise = "seed",
       .tunable = {"samples", "steps", "lengths", "thickness", "bias"},
       .variants = {"", "samples=8", "samples=32 steps=4", "bleeding=1", kPaper},
       .quantum = kSsdoQuantum,
       .dispatches = {{.name = "sent",
                       .inputs = sent_inputs(),
                       .outputs = packed_planes(),
                       .later_inputs = sent_later_inputs(),
                       .kernel = ssdo_sent_kernel(),
                       .needed = gathers_light,
                       .reach = own_row},
                      search_dispatch("occlusion", ssdo_occlusion_kernel(), gathers_no_light, of_all_layers({"depth"}),
                                      {}),
                      search_dispatch("light", ssdo_light_kernel(), gathers_light, outgoing_light_planes(),
                                      {"indirect.r", "indirect.g", "indirect.b"})},
       .rounds = ssdo_rounds});
}

}  // namespace umbrage
