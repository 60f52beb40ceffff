// The parameter table, constants and dispatch of `hidden`.
#include "effects/hidden/hidden.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/effect.h"
#include "core/parameters.h"
#include "effects/hidden/hidden_lines.h"
#include "effects/outline/outline_draw.h"
#include "kernel/kernel_frame.h"

namespace umbrage {
namespace {

const std::vector<Parameter> kHiddenTable = {
    bool_row("draw", &HiddenParams::draw, false,
             "draw the edges behind visible surfaces as dashed lines; this captures 8 layers, or those of `layers`"),
    length_row("width", &HiddenParams::width, {.initial_percent = 0.12, .min = 0.2, .max = 16, .unit = "px"},
               "width of the lines, in pixels or in percent of the picture's height"),
    length_row("dash", &HiddenParams::dash, {.initial_percent = 0.9, .min = 1, .max = 1000, .unit = "px"},
               "length of a dash, likewise; it is adjusted so that lines begin and end with a dash"),
    length_row("gap", &HiddenParams::gap, {.initial_percent = 0.6, .max = 1000, .unit = "px"},
               "distance between two dashes, likewise; 0: unbroken lines"),
    real_row("depth", &HiddenParams::depth, {.initial = 3, .min = 0.5, .max = 1000, .unit = "px"},
             "a surface that is this many pixel sizes off its neighbour's plane is a different surface"),
    real_row("crease", &HiddenParams::crease_deg, {.initial = 30, .min = 1, .max = 180, .unit = "deg"},
             "faces that meet at this angle or more have an edge"),
    int_row(
        "layers", &HiddenParams::layers, {.max = kLayersRead - 1, .zero_means = "all"},
        "number of surfaces along each ray, behind the visible one, whose edges are drawn: 1 draws only what is next"),
};

/// Returns the number of layers that follow each other along the rays of the first camera.
int layers_along_rays(const PictureInfo& info) {
  int count = 1;
  for (const LayerInfo& layer : info.more_layers) {
    if (layer.kind != LayerKind::kBehind || count == kLayersRead) break;
    ++count;
  }
  return count;
}

void fill_hidden(const HiddenParams& params, const PictureInfo& info, HiddenConstants& c) {
  constexpr float kUnitHeight = 1024.0f;
  const auto height = float(info.inner_height());
  const int captured = layers_along_rays(info);
  const float crease = params.crease_deg * std::numbers::pi_v<float> / 180.0f;
  c = {
      .captured = captured,
      .drawn = params.layers > 0 ? std::min(params.layers + 1, captured) : captured,
      .width_px = std::clamp(absolute_length(params.width, height), 0.2f, 16.0f),
      .dash_px = std::max(absolute_length(params.dash, height), 1.0f),
      .gap_px = std::max(absolute_length(params.gap, height), 0.0f),
      .depth = params.depth,
      .min_cosine = std::cos(crease),
      .crease_chord = 2.0f * std::sin(0.5f * crease),
      .max_window = std::clamp(int(std::lround(0.5f * (height / 85.0f - 1.0f))), 0, kHiddenMaxWindow),  // as in outline
      .narrow = height / 200.0f,
      .scale = height / kUnitHeight};
}

bool draws_hidden(const ParameterBytes& bytes) { return as<HiddenParams>(bytes).draw != 0; }

/// Returns the number of layers to capture. A closed occluder in front moves a surface back by two layers.
int layers_for(const ParameterBytes& bytes) {
  const auto& params = as<HiddenParams>(bytes);
  if (!params.draw) return 1;
  return params.layers > 0 ? std::min(params.layers + 3, kLayersRead) : kLayersRead;
}

}  // namespace

Effect effect_hidden() {
  auto inputs = of_all_layers({"depth", "normal.x", "normal.y", "normal.z", "object_id"});
  inputs.push_back("outline");
  return shading_effect<fill_hidden>(kHiddenTable,
                                     {.name = "hidden",
                                      .summary = "dashed lines for the edges of surfaces that others hide",
                                      .without_lines = {"hidden.draw=off"},
                                      .variants = {"", "draw=on"},
                                      .quantum = 1.0,
                                      .layers = layers_for,
                                      .dispatches = {{.name = "hidden_lines",
                                                      .inputs = inputs,
                                                      .outputs = {"outline"},
                                                      .host = add_traced<hidden_lines>,
                                                      .trace = hidden_lines,
                                                      .needed = draws_hidden}}});
}

}  // namespace umbrage
