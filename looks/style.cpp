#include "looks/style.h"

namespace umbrage {

std::span<const Style> styles() {
  static const std::vector<Style> all = {
      {.name = "white",
       .summary = "a white background, for papers",
       .presets = {"output.background_r=1", "output.background_g=1", "output.background_b=1", "output.gradient=0",
                   "hatching.paper_r=1", "hatching.paper_g=1", "hatching.paper_b=1"}},
      {.name = "dark",
       .summary = "a dark background, for slides",
       .presets = {"output.background_r=0.14", "output.background_g=0.15", "output.background_b=0.17",
                   "output.gradient=0.5", "outline.r=0.85", "outline.g=0.87", "outline.b=0.9", "hatching.strokes=light",
                   "hatching.contrast=2.4", "hatching.paper_r=0.14", "hatching.paper_g=0.15", "hatching.paper_b=0.17"}},
      {.name = "blueprint",
       .summary = "a blue model on dark blue, with light lines where the look draws lines",
       .presets = {"output.background_r=0.07", "output.background_g=0.18", "output.background_b=0.36",
                   "output.gradient=0", "outline.r=0.85", "outline.g=0.92", "outline.b=1", "hatching.strokes=light",
                   "hatching.contrast=2.4", "hatching.paper_r=0.07", "hatching.paper_g=0.18", "hatching.paper_b=0.36"},
       .color = std::array{0.38f, 0.56f, 0.80f}},
      {.name = "clay",
       .summary = "a model of terracotta on a warm background",
       .presets = {"output.background_r=0.93", "output.background_g=0.91", "output.background_b=0.88",
                   "hatching.paper_r=0.93", "hatching.paper_g=0.91", "hatching.paper_b=0.88"},
       .color = std::array{0.80f, 0.56f, 0.44f}}};
  return all;
}

const Style* find_style(std::string_view name) {
  for (const Style& style : styles())
    if (style.name == name) return &style;
  return nullptr;
}

}  // namespace umbrage
