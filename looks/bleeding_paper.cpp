// Look `bleeding-paper`: the settings of [Colliander and Törnquist 2015]. A hemisphere of samples from the paper's
// random table, rotated by a 4 x 4 tile; quadratic range in window depth; one fragment size for all occluders; a box
// blur; bounced light damped where direct light is weak; no transfer function.
#include "core/look.h"

namespace umbrage {

Look look_bleeding_paper() {
  return {.name = "bleeding-paper",
          .summary = "ambient occlusion and colour bleeding from one hemisphere of samples, as in the paper",
          .occlusion = "hemisphere",
          .effects = {"lighting", "occlusion", "box", "composite", "output"},
          .presets = {"lighting.material=display",     "hemisphere.distribution=paper",
                      "hemisphere.range=quadratic",    "hemisphere.range_depth=window",
                      "hemisphere.bias_of=depth",      "hemisphere.bias=0",
                      "hemisphere.border=clamp",       "hemisphere.weight=1",
                      "hemisphere.bleeding=1",         "hemisphere.area=paper",
                      "hemisphere.fragment_area=0.08", "hemisphere.floor=0.16",
                      "hemisphere.ambient_bounce=0",   "box.background=mix",
                      "composite.mode=bleeding",       "composite.albedo=display",
                      "output.transfer=none",          "output.pivot=0.46",
                      "output.background_r=0.36",      "output.background_g=0.40",
                      "output.background_b=0.45"},
          .lit_by = "lighting",
          .image_lit_presets = {"lighting.ambient=1"},
          .image_exposed_presets = {"output.metering=light", "output.exposure=0"}};
}

}  // namespace umbrage
