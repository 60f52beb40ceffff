// The parameter table, kernel constants and dispatch of `composite` [Luft 2006].
#include "effects/composite/composite.h"

#include "core/effect.h"
#include "kernels/composite.h"
#include "kernels/composite_parts.h"

namespace umbrage {
namespace {

constexpr double kMaxFactor = 10.0;
// The paper gives no value. A surface lit by ambient light alone gets no bounced light.
constexpr double kDamping = 0.1;

const std::vector<Parameter> kCompositeTable = {
    choice_row(
        "mode", &CompositeParams::mode, 0,
        {"ambient", "subtract", "multiply", "modulate", "occlusion", "bleeding", "albedo"},
        "how occlusion is applied: to the ambient part, subtracted, multiplied, modulating colour, or shown alone; "
        "bleeding: to the ambient part, with bounced light damped where direct light is weak; albedo: multiplied with "
        "the colours of surfaces, without light"),
    real_row("darkness", &CompositeParams::darkness, {.initial = 1, .max = kMaxFactor},
             "mode modulate: how much of the mask is added to brightness"),
    real_row("chroma", &CompositeParams::chroma, {.min = -kMaxFactor, .max = kMaxFactor},
             "mode modulate: above 0 occluded places lose colour, below 0 they gain it"),
    real_row("contrast", &CompositeParams::contrast, {.min = -kMaxFactor, .max = kMaxFactor},
             "mode modulate: above 0 occluded places lose contrast about middle grey, below 0 they gain it"),
    real_row("damping", &CompositeParams::damping, {.initial = kDamping, .max = kMaxFactor, .zero_means = "off"},
             "mode bleeding: luminance of direct light below which bounced light fades out"),
    choice_row("albedo", &CompositeParams::albedo, 0, {"texture", "display"},
               "albedo that reflects bounced light: linear, or as a display shows it (for output.transfer=none)"),
    real_row(
        "tint", &CompositeParams::tint, {.max = 1, .zero_means = "off"},
        "modes ambient and bleeding: how much of the occluded ambient light returns by bounces between surfaces of "
        "the same colour"),
    real_row("direct", &CompositeParams::direct, {.max = 1, .zero_means = "off"},
             "modes ambient and bleeding: how much occlusion darkens direct light too"),
    real_row("occlusion", &CompositeParams::occlusion,
             {.initial = 1, .max = kMaxFactor, .factor = "occlusion_strength"},
             "factor for the occlusion, 1 - ao, of any technique; `occlusion_strength` multiplies it"),
    bool_row("parts", &CompositeParams::parts, false,
             "also write `lit_direct` and `lit_indirect`, parts of the light; `passes` sets it"),
};

void fill_composite(const CompositeParams& params, const PictureInfo&, CompositeConstants& c) {
  c = {params.mode,   params.darkness, params.chroma, params.contrast, params.damping,
       params.albedo, params.tint,     params.direct, params.occlusion};
}

bool writes_parts(const ParameterBytes& params) { return as<CompositeParams>(params).parts != 0; }

}  // namespace

Effect effect_composite() {
  return shading_effect<fill_composite>(
      kCompositeTable,
      {.name = "composite",
       .summary = "combine direct, ambient and bounced light with occlusion",
       .source = "Luft 2006",
       .neutral = {{"lit_direct", 0.0f}, {"lit_indirect", 0.0f}},
       .dispatches = {{.inputs = {"direct.r", "direct.g", "direct.b", "ambient.r", "ambient.g", "ambient.b",
                                  "indirect.r", "indirect.g", "indirect.b", "albedo.r", "albedo.g", "albedo.b", "ao"},
                       .outputs = {"lit.r", "lit.g", "lit.b"},
                       .kernel = composite_kernel(),
                       .reach = own_pixel},
                      {.name = "composite_parts",
                       .inputs = {"direct.r", "direct.g", "direct.b", "ambient.r", "ambient.g", "ambient.b",
                                  "indirect.r", "indirect.g", "indirect.b", "albedo.r", "albedo.g", "albedo.b", "ao"},
                       .outputs = {"lit_direct.r", "lit_direct.g", "lit_direct.b", "lit_indirect.r", "lit_indirect.g",
                                   "lit_indirect.b"},
                       .kernel = composite_parts_kernel(),
                       .needed = writes_parts,
                       .reach = own_pixel}}});
}

}  // namespace umbrage
