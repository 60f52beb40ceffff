// The parameter table, kernel constants and dispatch of `relight`.
#include "effects/relight/relight.h"

#include "core/effect.h"
#include "kernels/relight.h"

namespace umbrage {
namespace {

// Without a plane of ambient light. Chosen by eye on path-traced interiors and photographs with depth: contacts are as
// dark as those that occlusion of the known ambient part gives, and sunlit surfaces keep their contrast.
constexpr double kFraction = 0.7;
// White in direct light has a luminance of about 1.
constexpr double kHighlights = 1.0;

const std::vector<Parameter> kRelightTable = {
    choice_row("source", &RelightParams::source, kRelightEstimate, {"estimate", "planes"},
               "the ambient part of the picture: estimated from its brightness, or the planes `ambient`, if the file "
               "has them"),
    real_row("fraction", &RelightParams::fraction, {.initial = kFraction, .max = 1},
             "estimate: fraction of dark light that is ambient"),
    real_row("highlights", &RelightParams::highlights, {.initial = kHighlights, .max = 1e6, .zero_means = "off"},
             "estimate: luminance at which half as much is ambient, and less above it"),
};

void fill_relight(const RelightParams& params, const PictureInfo&, RelightConstants& c) {
  c = {.source = params.source,
       .fraction = params.fraction,
       .one_over_highlights = params.highlights > 0.0f ? 1.0f / params.highlights : 0.0f};
}

}  // namespace

Effect effect_relight() {
  return shading_effect<fill_relight>(
      kRelightTable, {.name = "relight",
                      .summary = "split a finished picture into ambient light, which occlusion blocks, and the rest",
                      .dispatches = {{.inputs = {"ambient.r", "ambient.g", "ambient.b", "beauty.r", "beauty.g",
                                                 "beauty.b", "beauty.a", "emission.r", "emission.g", "emission.b"},
                                      .outputs = {"ambient.r", "ambient.g", "ambient.b", "direct.r", "direct.g",
                                                  "direct.b", "sky.r", "sky.g", "sky.b", "coverage"},
                                      .kernel = relight_kernel(),
                                      .reach = own_pixel}}});
}

}  // namespace umbrage
