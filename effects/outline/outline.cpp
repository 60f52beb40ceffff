#include "effects/outline/outline.h"

#include <algorithm>
#include <cstddef>

#include "core/effect.h"
#include "machine/kernel_frame.h"

namespace umbrage {

UMBRAGE_DECLARE_KERNEL(outline_window)
UMBRAGE_DECLARE_KERNEL(outline_paper)
UMBRAGE_DECLARE_KERNEL(outline_color)

void outline_strokes(const HostFrame& frame);

namespace {

constexpr std::uint32_t kWindowSpirv[] = {
#include "spirv/outline_window.inc"
};
constexpr std::uint32_t kPaperSpirv[] = {
#include "spirv/outline_paper.inc"
};
constexpr std::uint32_t kColorSpirv[] = {
#include "spirv/outline_color.inc"
};

// Automatic planes of the paper's window depth, as `unsharp` has them: the farthest corner at 90 % of the range, and
// the ratio of 2 to 15 between near and far.
constexpr float kFarShare = 0.9f;
constexpr float kNearToFar = 2.0f / 15.0f;

const std::vector<Parameter> kTable = {
    {.name = "mode",
     .help = "lines that hold up at any size and angle, or the paper's rule of eight neighbours",
     .type = ParameterType::kChoice,
     .offset = offsetof(OutlineParams, mode),
     .choices = {"robust", "paper"}},
    {.name = "width",
     .help = "robust: width of the line, in pixels or as a share of the picture's height, at most 16 pixels",
     .type = ParameterType::kLength,
     .offset = offsetof(OutlineParams, width),
     .initial = 2.0,
     .least = 0.5,
     .most = kOutlineWidest,
     .unit = "px"},
    {.name = "r",
     .help = "red of the line, linear, in the finished picture: lines are not exposed",
     .offset = offsetof(OutlineParams, r),
     .most = 1.0},
    {.name = "g", .help = "green of the line, likewise", .offset = offsetof(OutlineParams, g), .most = 1.0},
    {.name = "b", .help = "blue of the line, likewise", .offset = offsetof(OutlineParams, b), .most = 1.0},
    {.name = "opacity",
     .help = "how much of what lies under the line it hides",
     .offset = offsetof(OutlineParams, opacity),
     .initial = 1.0,
     .most = 1.0},
    {.name = "depth",
     .help = "robust: a surface that lies so many pixel sizes behind its neighbour's plane is another one",
     .offset = offsetof(OutlineParams, depth),
     .initial = 3.0,
     .least = 0.5,
     .most = 1000.0,
     .unit = "px"},
    {.name = "crease",
     .help = "robust: faces that meet at this angle or more have an edge",
     .offset = offsetof(OutlineParams, crease_deg),
     .initial = 30.0,
     .least = 1.0,
     .most = 180.0,
     .unit = "deg"},
    {.name = "convex",
     .help = "robust: draw edges that stand out, such as a box's",
     .type = ParameterType::kBool,
     .offset = offsetof(OutlineParams, convex),
     .initial = 1.0},
    {.name = "concave",
     .help = "robust: draw edges that lie in, such as a room's corners",
     .type = ParameterType::kBool,
     .offset = offsetof(OutlineParams, concave),
     .initial = 1.0},
    {.name = "ids",
     .help = "robust: what parts surfaces that touch: nothing, other objects, other materials, or either",
     .type = ParameterType::kChoice,
     .offset = offsetof(OutlineParams, ids),
     .initial = kOutlineObjects,
     .choices = {"none", "objects", "materials", "both"}},
    {.name = "recede",
     .help = "robust: how much lines become thinner with distance, in perspective: 0 not at all, 1 most",
     .offset = offsetof(OutlineParams, recede),
     .most = 1.0},
    {.name = "inner",
     .help = "robust: how much thinner lines are where an object hides itself, the less it lies behind; and free ends",
     .offset = offsetof(OutlineParams, inner),
     .most = 1.0},
    {.name = "paper_depth",
     .help = "paper: threshold of window depth, times 1 less the depth",
     .offset = offsetof(OutlineParams, paper_depth),
     .initial = 0.05,
     .most = 1.0},
    {.name = "paper_normal",
     .help = "paper: threshold of the normals' dot product",
     .offset = offsetof(OutlineParams, paper_normal),
     .initial = 0.95,
     .least = -1.0,
     .most = 1.0},
};

void fill_constants(const ParameterBytes& bytes, const PictureInfo& info, void* out) {
  const auto& params = as<OutlineParams>(bytes);
  const float far_depth = std::max(info.depth_max / kFarShare, 1e-30f);
  *static_cast<OutlineConstants*>(out) = {.r = params.r,
                                          .g = params.g,
                                          .b = params.b,
                                          .opacity = params.opacity,
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

int paper_reach(const void*, int) { return 1; }

}  // namespace

const Effect& effect_outline() {
  static const Effect effect = {
      .name = "outline",
      .summary = "lines where objects end, overlap or have edges",
      .source = "Lajzer and Nottingham",
      .kind = EffectKind::kShading,
      .parameters = kTable,
      .params_size = sizeof(OutlineParams),
      .constants_size = sizeof(OutlineConstants),
      .constants = fill_constants,
      .variants = {"", "width=4", "width=8", "mode=paper"},
      .quantum = 1.0,
      .passes = {{.name = "outline_strokes",
                  .inputs = {"depth", "normal.x", "normal.y", "normal.z", "object_id", "material_id"},
                  .outputs = {"outline"},
                  .host = outline_strokes,
                  .needed = is_robust},
                 {.name = "outline_window",
                  .inputs = {"depth"},
                  .outputs = {"outline_window"},
                  .scalar = run_scalar_outline_window,
                  .lanes = run_lanes_outline_window,
                  .spirv = kWindowSpirv,
                  .needed = is_paper,
                  .reach = own_row},
                 {.name = "outline_paper",
                  .inputs = {"depth", "normal.x", "normal.y", "normal.z", "outline_window"},
                  .outputs = {"outline"},
                  .scalar = run_scalar_outline_paper,
                  .lanes = run_lanes_outline_paper,
                  .spirv = kPaperSpirv,
                  .needed = is_paper,
                  .reach = paper_reach},
                 {.name = "outline_color",
                  .outputs = {"line.r", "line.g", "line.b"},
                  .scalar = run_scalar_outline_color,
                  .lanes = run_lanes_outline_color,
                  .spirv = kColorSpirv,
                  .needed = is_coloured,
                  .reach = own_row}},
  };
  return effect;
}

}  // namespace umbrage
