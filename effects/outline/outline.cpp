#include "effects/outline/outline.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/effect.h"
#include "core/parameters.h"
#include "effects/outline/outline_draw.h"
#include "kernels/outline_breaks.h"
#include "kernels/outline_color.h"
#include "kernels/outline_edges.h"
#include "kernels/outline_paper.h"
#include "kernels/outline_turns.h"

namespace umbrage {
namespace {

// Near and far plane of the paper's window depth, as in `unsharp`: the scene's farthest corner is at 90 % of the far
// plane's distance, and near / far is 2 / 15.
constexpr float kFarFraction = 0.9f;
constexpr float kNearToFar = 2.0f / 15.0f;

const std::vector<Parameter> kOutlineTable = {
    choice_row("mode", &OutlineParams::mode, 0, {"robust", "paper"},
               "lines that are stable at any size and angle, or the paper's test of eight neighbours"),
    length_row("width", &OutlineParams::width, {.initial = 2, .min = 0.5, .max = kOutlineMaxWidth, .unit = "px"},
               "robust: width of the line, in pixels or in percent of the picture's height, at most 16 pixels; below 1 "
               "pixel it fades"),
    real_row("r", &OutlineParams::r, {.max = 1},
             "red of the line, linear, in the finished picture: exposure does not apply to lines"),
    real_row("g", &OutlineParams::g, {.max = 1}, "green of the line, likewise"),
    real_row("b", &OutlineParams::b, {.max = 1}, "blue of the line, likewise"),
    real_row("opacity", &OutlineParams::opacity, {.initial = 1, .max = 1}, "opacity of the line"),
    real_row("depth", &OutlineParams::depth, {.initial = 3, .min = 0.5, .max = 1000, .unit = "px"},
             "robust: a surface that is this many pixel sizes behind its neighbour's plane is a different surface"),
    real_row("crease", &OutlineParams::crease_deg, {.initial = 30, .min = 1, .max = 180, .unit = "deg"},
             "robust: faces that meet at this angle or more have an edge"),
    bool_row("convex", &OutlineParams::convex, true, "robust: draw convex edges, such as a box's"),
    bool_row("concave", &OutlineParams::concave, true, "robust: draw concave edges, such as a room's corners"),
    choice_row(
        "ids", &OutlineParams::ids, kOutlineObjects, {"none", "objects", "materials", "both"},
        "robust: what separates surfaces that touch: nothing, different objects, different materials, or either"),
    real_row(
        "recede", &OutlineParams::recede, {.max = 1},
        "robust: how much lines become thinner with distance, in perspective: 0 not at all, 1 as much as possible"),
    real_row("inner", &OutlineParams::inner, {.max = 1},
             "robust: how much thinner lines are at free ends, and where an object occludes itself with a small depth "
             "difference"),
    real_row("paper_depth", &OutlineParams::paper_depth, {.initial = 0.05, .max = 1},
             "paper: threshold of window depth, times (1 - depth)"),
    real_row("paper_normal", &OutlineParams::paper_normal, {.initial = 0.95, .min = -1.0, .max = 1},
             "paper: threshold of the normals' dot product"),
};

void fill_outline(const OutlineParams& params, const PictureInfo& info, OutlineConstants& c) {
  constexpr float kUnitHeight = 1024.0f;  // picture height for which lengths of strokes are given
  const auto height = float(info.inner_height());
  const float crease = params.crease_deg * std::numbers::pi_v<float> / 180.0f;
  const float far_depth = std::max(info.depth_max / kFarFraction, 1e-30f);
  // Windows for creases are at most 1/85 of the picture's height wide, narrow ones at most 1/200, so that edges do not
  // depend on its size. A camera that frames a model sees it at depths of about two to four of its radii; lines become
  // thinner only beyond that.
  c = {.width_px = std::clamp(absolute_length(params.width, height), 0.0f, kOutlineMaxWidth),
       .r = params.r,
       .g = params.g,
       .b = params.b,
       .opacity = params.opacity,
       .depth = 2.0f * params.depth,
       .crease_chord = 2.0f * std::sin(0.5f * crease),
       .convex = params.convex,
       .concave = params.concave,
       .objects = params.ids & kOutlineObjects ? 1 : 0,
       .materials = params.ids & kOutlineMaterials ? 1 : 0,
       .max_window = std::clamp(int(std::lround(0.5f * (height / 85.0f - 1.0f))), 0, kOutlineMaxWindow),
       .narrow = height / 200.0f,
       .window_penalty = 0.04f * std::min(1.0f, kUnitHeight / height),
       .scale = height / kUnitHeight,
       .recede = params.recede,
       .recede_from = std::max(2.0f * info.depth_min, 0.25f * info.depth_max),
       .inner = params.inner,
       .inner_px = params.depth * height / 256.0f,
       .paper_depth = params.paper_depth,
       .paper_normal = params.paper_normal,
       .near_depth = far_depth * kNearToFar,
       .far_depth = far_depth};
}

bool is_drawn(const ParameterBytes& bytes) { return as<OutlineParams>(bytes).opacity > 0.0f; }

bool is_paper(const ParameterBytes& bytes) { return is_drawn(bytes) && as<OutlineParams>(bytes).mode == kOutlinePaper; }

bool is_robust(const ParameterBytes& bytes) { return is_drawn(bytes) && !is_paper(bytes); }

bool is_coloured(const ParameterBytes& bytes) {
  const auto& params = as<OutlineParams>(bytes);
  return is_drawn(bytes) && std::max({params.r, params.g, params.b}) > 0.0f;
}

/// These return the number of rows that the dispatches read above and below a pixel; see the kernel texts.
int breaks_reach(const void*, int) { return 2; }
int turns_reach(const void* constants, int) {
  return 2 * static_cast<const OutlineConstants*>(constants)->max_window + 2;
}
int paper_reach(const void*, int) { return 1; }

}  // namespace

Effect effect_outline() {
  return shading_effect<fill_outline>(
      kOutlineTable,
      {.name = "outline",
       .summary = "lines where objects end, overlap or have edges",
       .source = "Lajzer and Nottingham",
       .without_lines = {"outline.opacity=0"},
       .variants = {"", "width=4", "width=8", "mode=paper"},
       .quantum = 1.0,
       .neutral = {{"outline", 0.0f}, {"line", 0.0f}},
       .dispatches = {
           {.name = "outline_breaks",
            .inputs = {"depth", "normal.x", "normal.y", "normal.z", "object_id", "material_id"},
            .outputs = {"outline_break_right", "outline_break_below"},
            .kernel = outline_breaks_kernel(),
            .needed = is_robust,
            .reach = breaks_reach},
           {.name = "outline_turns",
            .inputs = {"depth", "normal.x", "normal.y", "normal.z", "outline_break_right", "outline_break_below"},
            .outputs = {"outline_turn_right", "outline_turn_below"},
            .kernel = outline_turns_kernel(),
            .needed = is_robust,
            .reach = turns_reach},
           {.name = "outline_edges",
            .inputs = {"depth", "normal.x", "normal.y", "normal.z", "outline_break_right", "outline_break_below",
                       "outline_turn_right", "outline_turn_below"},
            .outputs = {"outline_edge_right", "outline_edge_below"},
            .kernel = outline_edges_kernel(),
            .needed = is_robust,
            .reach = turns_reach},
           {.name = "outline_strokes",
            .inputs = {"outline_edge_right", "outline_edge_below", "depth", "object_id"},
            .outputs = {"outline"},
            .host = run_host_outline,
            .trace = trace_lines,
            .needed = is_robust},
           {.name = "outline_paper",
            .inputs = {"depth", "normal.x", "normal.y", "normal.z"},
            .outputs = {"outline"},
            .kernel = outline_paper_kernel(),
            .needed = is_paper,
            .reach = paper_reach},
           {.name = "outline_color",
            .outputs = {"line.r", "line.g", "line.b"},
            .kernel = outline_color_kernel(),
            .needed = is_coloured,
            .reach = own_row}}});
}

}  // namespace umbrage
