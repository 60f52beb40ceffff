#include "effects/composite/composite.h"

#include <cstddef>

#include "core/effect.h"
#include "kernel/kernel_frame.h"

namespace umbrage {

UMBRAGE_DECLARE_KERNEL(composite)

namespace {

constexpr std::uint32_t kSpirv[] = {
#include "spirv/composite.inc"
};

constexpr double kMostFactor = 10.0;
constexpr double kDamping = 0.1;  // the paper gives no number: what is lit by ambient light alone has none

const std::vector<Parameter> kTable = {
    {.name = "mode",
     .help = "how occlusion meets light: on the ambient part, subtracted, multiplied, modulating colour, or alone; "
             "bleeding: on the ambient part, with bounced light damped where little direct light arrives",
     .type = ParameterType::kChoice,
     .offset = offsetof(CompositeParams, mode),
     .choices = {"ambient", "subtract", "multiply", "modulate", "occlusion", "bleeding"}},
    {.name = "darkness",
     .help = "mode modulate: how much of the mask is added to brightness",
     .offset = offsetof(CompositeParams, darkness),
     .initial = 1.0,
     .most = kMostFactor},
    {.name = "chroma",
     .help = "mode modulate: how much the mask changes the strength of colours",
     .offset = offsetof(CompositeParams, chroma),
     .initial = 0.0,
     .least = -kMostFactor,
     .most = kMostFactor},
    {.name = "contrast",
     .help = "mode modulate: how much the mask changes contrast about middle grey",
     .offset = offsetof(CompositeParams, contrast),
     .initial = 0.0,
     .least = -kMostFactor,
     .most = kMostFactor},
    {.name = "damping",
     .help = "mode bleeding: luminance of the direct light from which on bounced light is whole; with less it fades",
     .offset = offsetof(CompositeParams, damping),
     .initial = kDamping,
     .most = kMostFactor,
     .zero_means = "off"},
    {.name = "albedo",
     .help = "what reflects bounced light: the albedo, or the albedo as a display shows it (for output.transfer=none)",
     .type = ParameterType::kChoice,
     .offset = offsetof(CompositeParams, albedo),
     .choices = {"texture", "display"}},
    {.name = "tint",
     .help = "modes ambient and bleeding: how much of the ambient light that occlusion keeps out comes back from "
             "surfaces of the same colour",
     .offset = offsetof(CompositeParams, tint),
     .most = 1.0,
     .zero_means = "off"},
};

void fill_constants(const ParameterBytes& bytes, const PictureInfo&, void* out) {
  const auto& params = as<CompositeParams>(bytes);
  *static_cast<CompositeConstants*>(out) = {params.mode,    params.darkness, params.chroma, params.contrast,
                                            params.damping, params.albedo,   params.tint};
}

}  // namespace

const Effect& effect_composite() {
  static const Effect effect = {
      .name = "composite",
      .summary = "joins direct, ambient and bounced light with occlusion",
      .source = "Luft 2006",
      .kind = EffectKind::kShading,
      .parameters = kTable,
      .params_size = sizeof(CompositeParams),
      .constants_size = sizeof(CompositeConstants),
      .constants = fill_constants,
      .passes = {{.name = "composite",
                  .inputs = {"direct.r", "direct.g", "direct.b", "ambient.r", "ambient.g", "ambient.b", "indirect.r",
                             "indirect.g", "indirect.b", "albedo.r", "albedo.g", "albedo.b", "ao"},
                  .outputs = {"lit.r", "lit.g", "lit.b"},
                  .scalar = run_scalar_composite,
                  .lanes = run_lanes_composite,
                  .spirv = kSpirv,
                  .reach = own_row}},
  };
  return effect;
}

}  // namespace umbrage
