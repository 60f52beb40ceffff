#include "reference/reference.h"

#include <limits>

namespace umbrage {
namespace {

constexpr int kSamples = 64;
constexpr double kMaxSeed = 1e6;

const std::vector<Parameter> kTable = {
    int_row("samples", &ReferenceParams::samples, {.initial = kSamples, .min = 1, .max = kMaxSamples},
            "rays per pixel; with `light` also per pixel and large light, and for the bounce"),
    radius_row("radius", &ReferenceParams::radius,
               "max distance of an occluder, in scene units or in percent of the bounding-sphere radius; 200% is the "
               "whole scene"),
    choice_row("falloff", &ReferenceParams::falloff, 0, {"none", "linear", "smooth"},
               "weight of an occluder within the radius: 1, or falling with distance"),
    choice_row("normal", &ReferenceParams::normal, 0, {"triangle", "shading"},
               "normal of the hemisphere: that of the triangle, or the interpolated one"),
    choice_row("occluders", &ReferenceParams::occluders, 0, {"all", "window", "layers"},
               "occluders that count: all, those of the first layer inside the picture, or those of all its layers"),
    choice_row("light", &ReferenceParams::light, 0, {"off", "direct", "bounce"},
               "also trace the lights with soft shadows, and one bounce of their light"),
    choice_row("bounce_from", &ReferenceParams::bounce_from, 0, {"anywhere", "radius"},
               "with light=bounce: where bounced light comes from: surfaces at any distance, or within the radius"),
    choice_row("shadows", &ReferenceParams::shadows, 0, {"soft", "captured"},
               "shadows of the lights: soft, from every light; or captured, from point lights and only those whose "
               "shadow is captured, as for screen-space techniques"),
    real_row("sun_angle", &ReferenceParams::sun_angle_deg,
             {.max = 90, .unit = "deg", .zero_means = "that of the light"},
             "angular diameter of directional lights: the larger, the softer their shadows"),
    int_row("seed", &ReferenceParams::seed, {.max = kMaxSeed}, "seed of the noise"),
};

}  // namespace

const Effect& reference_effect() {
  static const Effect effect = {
      .name = "reference",
      .summary = "ground truth by ray tracing: slow; the reference for all techniques",
      .source = "Zhukov et al. 1998",
      .kind = EffectKind::kOcclusion,
      .parameters = kTable,
      .params_size = sizeof(ReferenceParams),
      .set_radius = set_radius_of<&ReferenceParams::radius>,
      .noise = "seed",
      .variants = {"", "samples=1", "samples=4", "samples=16"},
      .dispatches = {{.name = "trace",
                      .outputs = {"ao", "bent_normal.x", "bent_normal.y", "bent_normal.z", "direct.r", "direct.g",
                                  "direct.b", "shadow", "indirect.r", "indirect.g", "indirect.b"}}},
  };
  return effect;
}

Result<Image> trace_reference(const TracedScene& scene, const PictureInfo& info, const ParameterBytes& bytes,
                              const TraceControl& control) {
  const auto& params = as<ReferenceParams>(bytes);
  const auto radius = radius_in_scene("reference.radius", params.radius, info);
  if (!radius) return radius.error();
  // Both traces report one progress, divided by the approximate number of rays of each.
  const bool light = params.light != kReferenceOcclusion, bounce = params.light == kReferenceBounce;
  const double occlusion_fraction = light ? bounce ? 0.2 : 0.5 : 1.0;
  TraceControl occlusion_control = control, light_control = control;
  occlusion_control.progress = [&](double done) { return control.progress(occlusion_fraction * done); };
  light_control.progress = [&](double done) {
    return control.progress(occlusion_fraction + (1.0 - occlusion_fraction) * done);
  };
  auto image = trace_occlusion(scene, info,
                               {.samples = params.samples,
                                .radius = *radius,
                                .falloff = Falloff(params.falloff),
                                .normal = HemisphereNormal(params.normal),
                                .occluders = Occluders(params.occluders),
                                .seed = std::uint32_t(params.seed)},
                               occlusion_control);
  if (!image || !light) return image;
  auto lit = trace_light(
      scene, info,
      {.samples = params.samples,
       .bounce = bounce,
       .reach = params.bounce_from == kReferenceFromRadius ? *radius : std::numeric_limits<float>::infinity(),
       .captured_shadows = params.shadows == kReferenceCapturedShadows,
       .sun_angle_deg = params.sun_angle_deg,
       .seed = std::uint32_t(params.seed)},
      light_control);
  if (!lit) return lit;
  for (std::size_t p = 0; p < lit->planes.size(); ++p) image->add(lit->names[p]) = std::move(lit->planes[p]);
  return image;
}

}  // namespace umbrage
