#include "effects/outline/outline.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "core/absolute_length.h"
#include "core/effect.h"
#include "machine/kernel_frame.h"

namespace umbrage {

UMBRAGE_DECLARE_KERNEL(outline_find)
UMBRAGE_DECLARE_KERNEL(outline_settle)
UMBRAGE_DECLARE_KERNEL(outline_refine)
UMBRAGE_DECLARE_KERNEL(outline_link)
UMBRAGE_DECLARE_KERNEL(outline_ends)
UMBRAGE_DECLARE_KERNEL(outline_fit)
UMBRAGE_DECLARE_KERNEL(outline_even)
UMBRAGE_DECLARE_KERNEL(outline_tails)
UMBRAGE_DECLARE_KERNEL(outline_trim)
UMBRAGE_DECLARE_KERNEL(outline_strays)
UMBRAGE_DECLARE_KERNEL(outline_strays_row)
UMBRAGE_DECLARE_KERNEL(outline_strays_near)
UMBRAGE_DECLARE_KERNEL(outline_drop)
UMBRAGE_DECLARE_KERNEL(outline_join)
UMBRAGE_DECLARE_KERNEL(outline_rejoin)
UMBRAGE_DECLARE_KERNEL(outline_pen)
UMBRAGE_DECLARE_KERNEL(outline_gather)
UMBRAGE_DECLARE_KERNEL(outline_spread)
UMBRAGE_DECLARE_KERNEL(outline)
UMBRAGE_DECLARE_KERNEL(outline_window)
UMBRAGE_DECLARE_KERNEL(outline_paper)

namespace {

constexpr std::uint32_t kFindSpirv[] = {
#include "spirv/outline_find.inc"
};
constexpr std::uint32_t kSettleSpirv[] = {
#include "spirv/outline_settle.inc"
};
constexpr std::uint32_t kRefineSpirv[] = {
#include "spirv/outline_refine.inc"
};
constexpr std::uint32_t kLinkSpirv[] = {
#include "spirv/outline_link.inc"
};
constexpr std::uint32_t kEndsSpirv[] = {
#include "spirv/outline_ends.inc"
};
constexpr std::uint32_t kFitSpirv[] = {
#include "spirv/outline_fit.inc"
};
constexpr std::uint32_t kEvenSpirv[] = {
#include "spirv/outline_even.inc"
};
constexpr std::uint32_t kTailsSpirv[] = {
#include "spirv/outline_tails.inc"
};
constexpr std::uint32_t kTrimSpirv[] = {
#include "spirv/outline_trim.inc"
};
constexpr std::uint32_t kStraysSpirv[] = {
#include "spirv/outline_strays.inc"
};
constexpr std::uint32_t kStraysRowSpirv[] = {
#include "spirv/outline_strays_row.inc"
};
constexpr std::uint32_t kStraysNearSpirv[] = {
#include "spirv/outline_strays_near.inc"
};
constexpr std::uint32_t kDropSpirv[] = {
#include "spirv/outline_drop.inc"
};
constexpr std::uint32_t kJoinSpirv[] = {
#include "spirv/outline_join.inc"
};
constexpr std::uint32_t kRejoinSpirv[] = {
#include "spirv/outline_rejoin.inc"
};
constexpr std::uint32_t kPenSpirv[] = {
#include "spirv/outline_pen.inc"
};
constexpr std::uint32_t kGatherSpirv[] = {
#include "spirv/outline_gather.inc"
};
constexpr std::uint32_t kSpreadSpirv[] = {
#include "spirv/outline_spread.inc"
};
constexpr std::uint32_t kOutlineSpirv[] = {
#include "spirv/outline.inc"
};
constexpr std::uint32_t kWindowSpirv[] = {
#include "spirv/outline_window.inc"
};
constexpr std::uint32_t kPaperSpirv[] = {
#include "spirv/outline_paper.inc"
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
    {.name = "r", .help = "red of the line, linear", .offset = offsetof(OutlineParams, r), .most = 1.0},
    {.name = "g", .help = "green of the line", .offset = offsetof(OutlineParams, g), .most = 1.0},
    {.name = "b", .help = "blue of the line", .offset = offsetof(OutlineParams, b), .most = 1.0},
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
  auto& c = *static_cast<OutlineConstants*>(out);
  const float width = absolute_length(params.width, float(info.inner_height()));
  const float crease = params.crease_deg * std::numbers::pi_v<float> / 180.0f;
  // Faces at just that angle count as reaching it, however their normals were rounded.
  constexpr float kReached = 0.97f;
  const float far_depth = std::max(info.depth_max / kFarShare, 1e-30f);
  c = {.mode = params.mode,
       .width_px = std::clamp(width, 0.0f, kOutlineWidest),
       .r = params.r,
       .g = params.g,
       .b = params.b,
       .opacity = params.opacity,
       .depth = params.depth,
       .crease_chord = kReached * 4.0f * std::sin(0.5f * crease) * std::sin(0.5f * crease),
       .convex = params.convex,
       .concave = params.concave,
       .objects = params.ids & kOutlineObjects ? 1 : 0,
       .materials = params.ids & kOutlineMaterials ? 1 : 0,
       .recede = params.recede,
       .inner = params.inner,
       .paper_depth = params.paper_depth,
       .paper_normal = params.paper_normal,
       .near_depth = far_depth * kNearToFar,
       .far_depth = far_depth};
  constexpr float kAntialiasing = 0.5f, kHalfPiece = 0.5f;
  // What a camera that frames a model sees lies between about two and four of its radii.
  constexpr float kTimesNear = 2.0f, kShareOfFar = 0.25f;
  c.recede_from = std::max(kTimesNear * info.depth_min, kShareOfFar * info.depth_max);
  constexpr float kInnerHeight = 256.0f;  // of the picture, for each `depth`: the same at any size
  c.inner_px = params.depth * float(info.inner_height()) / kInnerHeight;
  c.reach = int(std::ceil(c.width_px + kAntialiasing + kHalfPiece));
  constexpr float kStrideHeight = 810.0f;  // of the picture, per pixel of stride: what is an edge is one at any size
  constexpr float kMostStride = 4.0f;
  c.stride = int(std::clamp(std::round(float(info.inner_height()) / kStrideHeight), 1.0f, kMostStride));
  // What is smaller would be all line. As many, and three around it, as lanes look around at once; where the stride is
  // one, as many as outline_refine tells short lines by.
  constexpr float kSmallWidths = 3.0f, kMostSmall = 13.0f, kMostSmallLow = 6.0f;
  c.small = int(std::clamp(std::round(kSmallWidths * c.width_px), 1.0f, c.stride > 1 ? kMostSmall : kMostSmallLow));
  constexpr float kIsletHeight = 150.0f, kMostIslet = 20.0f;  // of the picture, per pixel; and pixels
  const float islet_px = std::clamp(std::round(float(info.inner_height()) / kIsletHeight), 3.0f, kMostIslet);
  c.islet_cell = c.stride > 1 ? 2 : 1;
  c.islet = int(std::ceil(islet_px / float(c.islet_cell)));
  c.islet_gap = (2 + c.stride) / c.islet_cell;
  constexpr float kBarHeight = 114.0f;  // of the picture, per pixel of half a bar whose front is round
  c.bar = int(std::clamp(std::round(float(info.inner_height()) / kBarHeight), 3.0f, 15.0f));
  constexpr float kBevelHeight = 150.0f;  // of the picture, per pixel of half a wide bevel
  c.bevel = int(std::clamp(std::round(float(info.inner_height()) / kBevelHeight), 3.0f, 16.0f));
  constexpr float kEvenly = 0.4f;  // of the same turn in every step
  c.bevel_step = kEvenly * kEvenly / (4.0f * float(c.bevel) * float(c.bevel));
  constexpr float kMostStretch = 1.45f;      // of a distance along a row: the steepest slope is kSteepHere
  constexpr int kJoin = 2, kJoinStride = 8;  // pixels between ends that are joined, and more per pixel of stride
  c.join = kJoin + kJoinStride * c.stride;
  c.sight = int((std::max(c.width_px, 1.0f) + kAntialiasing) * kMostStretch) + 1;
  constexpr int kOnward = 3, kMostOnward = 36;  // of bevels; and pixels, which outline_stroke.kernel.h has room for
  c.onward = std::min(kOnward * c.bevel, kMostOnward);
  // Each of two joined ends draws more than half of what joins them, and an end all that leads to a line ahead.
  const int cap = 1 + int(std::ceil(0.5f * c.width_px));
  c.around = std::max({c.sight, c.join / 2 + cap, c.onward + cap});
  // Three windows so far apart from each other leave no gap: apart is at most 2 gather + 1.
  constexpr int kShort = 3, kShortMore = 3;  // pixels to a line ahead, per pixel of stride and more: as outline_joined
  c.gather = std::max({c.sight, std::max(c.join / 2, kShort * c.stride + kShortMore) + cap, (c.around + 1) / 3});
  c.apart = std::max(c.around - c.gather, 1);
}

bool is_paper(const ParameterBytes& bytes) { return as<OutlineParams>(bytes).mode == kOutlinePaper; }

bool is_robust(const ParameterBytes& bytes) { return !is_paper(bytes); }

// How far the passes read, in rows: see the kernel texts.
int find_reach(const void* constants, int) {
  const auto& c = *static_cast<const OutlineConstants*>(constants);
  const int stride = c.stride;
  // Means of normals from four to five strides off; along a fold's side, of kRoom strides and pixels and kFootRoom
  // more, depths three pixels and normals kTurnWithin beyond its end, which begins one pixel off. A wide bevel's sides
  // are as wide as it may be; of a bar half and one pixel. A slit is followed for kOutlineSlitRows, from
  // the pixel after, and a pixel aside.
  return std::max({5 * stride, 2 * stride + 8, 2 * c.bevel + 1, c.bar + 1, kOutlineSlitRows + 2});
}
int settle_reach(const void*, int) { return 4; }
int refine_reach(const void*, int) { return 14; }
/// What is not sure is followed for nine rows or columns, times the stride, and five more, each 1.5 aside by its lean
/// and 1.1 beside that; two more where it ends. What is sure for 24, and in each of four hops 2.1 aside. Specks are
/// told within six pixels, times the stride, and what is small within sixteen.
int link_reach(const void* constants, int) {
  const int rows = 9 * static_cast<const OutlineConstants*>(constants)->stride + 5;
  return std::max(46, int(std::ceil(2.6f * float(rows))) + 4);
}
/// A line is fitted to 16 rows at most, and a piece's own followed for as many, each 2.6 aside.
int fit_reach(const void*, int) { return int(std::ceil(2.6f * 16.0f)) + 4; }
int even_reach(const void*, int) { return 9; }
/// Rows of a tail, as outline_tail.kernel.h has them.
int tail_rows(const OutlineConstants& c) { return std::min(std::min(6 * c.stride, 16) + 4, 16); }
/// A line is followed from its end for twice a tail's rows and one, or for eight, times the stride, each 2.6 aside;
/// from there what is beside, or as far ahead as ends are joined, and a line there for as many rows as a burr may have.
int tails_reach(const void* constants, int) {
  const auto& c = *static_cast<const OutlineConstants*>(constants);
  const int tail = tail_rows(c), burr = std::min(2 * c.stride + 4, 15) + 2;
  const int back = std::max(2 * tail + 1, 8 * c.stride);
  return int(std::ceil(2.6f * float(back))) + std::max(c.join, int(std::ceil(2.6f * float(burr)))) + 12;
}
/// What is faint is followed for 16 rows, times the stride; from there a line is looked for as far as ends are joined,
/// and from another faint one, that goes on there, once more the same; a crease for 32 rows, but then no farther.
int trim_reach(const void* constants, int) {
  const auto& c = *static_cast<const OutlineConstants*>(constants);
  return 2 * (int(std::ceil(2.6f * 16.0f * float(c.stride))) + std::max(c.stride, c.join) + 4);
}
/// A line is followed from its end for as many rows as a stray may have and two, and from the other one back, each 2.6
/// aside, and what is beside is looked at; joins are looked for around the middle of the two and around each end.
int strays_reach(const void* constants, int) {
  const auto& c = *static_cast<const OutlineConstants*>(constants);
  const int rows = std::max(2 * tail_rows(c), 7 * c.bevel / 2) + 2;
  const int met = std::max(c.join, c.onward) + rows + int(c.width_px) + 2;
  return std::max(int(std::ceil(2.6f * 2.0f * float(rows))), int(std::ceil(2.6f * 0.5f * float(rows))) + met) + 12;
}
int strays_near_reach(const void*, int) { return kOutlineStraysNear; }
/// A piece is asked for from two pixels beside, and its line followed to its end, for half as many.
int drop_reach(const void*, int) { return int(std::ceil(2.6f * 33.0f)) + 4; }
/// One end is looked for from another, and from that one back; the rows before it drift 2.6 aside in each of four. What
/// lies between ends is asked from the middle of the one's stroke to the other's. A crease is followed back as far as
/// it may go on, and half-way back, and as far as it may go on, is asked what lies four halves of a bevel beside it.
int join_reach(const void* constants, int) {
  const auto& c = *static_cast<const OutlineConstants*>(constants);
  const int beside = 2 * c.bevel + 5, drift = 16;
  return std::max({2 * c.join + drift, int(std::ceil(2.6f * float(c.onward))) + 4,
                   int(std::ceil(2.6f * 4.0f * float(c.stride))) + beside, c.onward + c.bevel + drift});
}
/// As many rows as a line is made even over, and for free ends one more; depths two pixels beside those.
int pen_reach(const void* constants, int) { return static_cast<const OutlineConstants*>(constants)->stride + 6; }
int spread_reach(const void* constants, int) { return static_cast<const OutlineConstants*>(constants)->gather; }
int line_reach(const void* constants, int) {
  const auto& c = *static_cast<const OutlineConstants*>(constants);
  return std::max(c.reach, c.around) + 1;
}
int paper_reach(const void*, int) { return 1; }

// How far from a pixel there must be something for a pass to find anything, in columns or rows: see the kernel texts.
int settle_near(const void*) { return 1; }  // along its row or column: a crossing that moves, moves by one
int even_near(const void*) { return kOutlineComes; }
int strays_near(const void*) { return kOutlineStraysNear; }
int gathered(const void* constants) { return static_cast<const OutlineConstants*>(constants)->gather; }

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
      .passes = {{.name = "outline_find",
                  .inputs = {"depth", "normal.x", "normal.y", "normal.z", "object_id", "material_id"},
                  .outputs = {"outline_right", "outline_below"},
                  .scalar = run_scalar_outline_find,
                  .lanes = run_lanes_outline_find,
                  .spirv = kFindSpirv,
                  .needed = is_robust,
                  .reach = find_reach},
                 {.name = "outline_settle",
                  .inputs = {"outline_right", "outline_below"},
                  .outputs = {"outline_right_settled", "outline_below_settled"},
                  .scalar = run_scalar_outline_settle,
                  .lanes = run_lanes_outline_settle,
                  .spirv = kSettleSpirv,
                  .needed = is_robust,
                  .reach = settle_reach,
                  .where = {{.plane = "outline_right", .columns = settle_near},
                            {.plane = "outline_below", .rows = settle_near}}},
                 {.name = "outline_refine",
                  .inputs = {"outline_right_settled", "outline_below_settled"},
                  .outputs = {"outline_steep", "outline_flat"},
                  .scalar = run_scalar_outline_refine,
                  .lanes = run_lanes_outline_refine,
                  .spirv = kRefineSpirv,
                  .needed = is_robust,
                  .reach = refine_reach,
                  .where = {{.plane = "outline_right_settled"}, {.plane = "outline_below_settled"}},
                  .packed = true},
                 {.name = "outline_link",
                  .inputs = {"outline_steep", "outline_flat"},
                  .outputs = {"outline_steep_linked", "outline_flat_linked"},
                  .scalar = run_scalar_outline_link,
                  .lanes = run_lanes_outline_link,
                  .spirv = kLinkSpirv,
                  .needed = is_robust,
                  .reach = link_reach,
                  .where = {{.plane = "outline_steep"}, {.plane = "outline_flat"}},
                  .packed = true},
                 {.name = "outline_ends",
                  .inputs = {"depth", "object_id", "outline_steep_linked", "outline_flat_linked"},
                  .outputs = {"outline_steep_ends", "outline_flat_ends"},
                  .scalar = run_scalar_outline_ends,
                  .lanes = run_lanes_outline_ends,
                  .spirv = kEndsSpirv,
                  .needed = is_robust,
                  .reach = fit_reach,
                  .where = {{.plane = "outline_steep_linked"}, {.plane = "outline_flat_linked"}},
                  .packed = true},
                 {.name = "outline_fit",
                  .inputs = {"outline_steep_linked", "outline_flat_linked", "outline_steep_ends", "outline_flat_ends"},
                  .outputs = {"outline_steep_fit", "outline_flat_fit"},
                  .scalar = run_scalar_outline_fit,
                  .lanes = run_lanes_outline_fit,
                  .spirv = kFitSpirv,
                  .needed = is_robust,
                  .reach = fit_reach,
                  .where = {{.plane = "outline_steep_ends"}, {.plane = "outline_flat_ends"}},
                  .packed = true},
                 {.name = "outline_even",
                  .inputs = {"outline_steep_linked", "outline_flat_linked", "outline_steep_fit", "outline_flat_fit"},
                  .outputs = {"outline_steep_even", "outline_flat_even"},
                  .scalar = run_scalar_outline_even,
                  .lanes = run_lanes_outline_even,
                  .spirv = kEvenSpirv,
                  .needed = is_robust,
                  .reach = even_reach,
                  .where = {{.plane = "outline_steep_linked"},
                            {.plane = "outline_flat_linked"},
                            {.plane = "outline_steep_fit", .columns = even_near},
                            {.plane = "outline_flat_fit", .rows = even_near}}},
                 {.name = "outline_tails",
                  .inputs = {"depth", "object_id", "outline_steep_even", "outline_flat_even"},
                  .outputs = {"outline_tails"},
                  .scalar = run_scalar_outline_tails,
                  .lanes = run_lanes_outline_tails,
                  .spirv = kTailsSpirv,
                  .needed = is_robust,
                  .reach = tails_reach,
                  .where = {{.plane = "outline_steep_even"}, {.plane = "outline_flat_even"}},
                  .packed = true},
                 {.name = "outline_trim",
                  .inputs = {"outline_steep_even", "outline_flat_even", "outline_tails"},
                  .outputs = {"outline_steep_trimmed", "outline_flat_trimmed"},
                  .scalar = run_scalar_outline_trim,
                  .lanes = run_lanes_outline_trim,
                  .spirv = kTrimSpirv,
                  .needed = is_robust,
                  .reach = trim_reach,
                  .where = {{.plane = "outline_steep_even"}, {.plane = "outline_flat_even"}},
                  .packed = true},
                 {.name = "outline_join",
                  .inputs = {"depth", "normal.x", "normal.y", "normal.z", "object_id", "outline_steep_trimmed",
                             "outline_flat_trimmed"},
                  .outputs = {"outline_join"},
                  .scalar = run_scalar_outline_join,
                  .lanes = run_lanes_outline_join,
                  .spirv = kJoinSpirv,
                  .needed = is_robust,
                  .reach = join_reach,
                  .where = {{.plane = "outline_steep_trimmed"}, {.plane = "outline_flat_trimmed"}},
                  .packed = true},
                 {.name = "outline_strays",
                  .inputs = {"object_id", "outline_steep_trimmed", "outline_flat_trimmed", "outline_join"},
                  .outputs = {"outline_strays"},
                  .scalar = run_scalar_outline_strays,
                  .lanes = run_lanes_outline_strays,
                  .spirv = kStraysSpirv,
                  .needed = is_robust,
                  .reach = strays_reach,
                  .where = {{.plane = "outline_steep_trimmed"}, {.plane = "outline_flat_trimmed"}},
                  .packed = true},
                 {.name = "outline_strays_row",
                  .inputs = {"outline_strays"},
                  .outputs = {"outline_strays_row"},
                  .scalar = run_scalar_outline_strays_row,
                  .lanes = run_lanes_outline_strays_row,
                  .spirv = kStraysRowSpirv,
                  .needed = is_robust,
                  .reach = own_row,
                  .where = {{.plane = "outline_strays", .columns = strays_near}}},
                 {.name = "outline_strays_near",
                  .inputs = {"outline_strays_row"},
                  .outputs = {"outline_strays_near"},
                  .scalar = run_scalar_outline_strays_near,
                  .lanes = run_lanes_outline_strays_near,
                  .spirv = kStraysNearSpirv,
                  .needed = is_robust,
                  .reach = strays_near_reach,
                  .where = {{.plane = "outline_strays_row", .rows = strays_near}}},
                 {.name = "outline_drop",
                  .inputs = {"object_id", "outline_steep_trimmed", "outline_flat_trimmed", "outline_join",
                             "outline_strays", "outline_strays_near"},
                  .outputs = {"outline_steep_left", "outline_flat_left"},
                  .scalar = run_scalar_outline_drop,
                  .lanes = run_lanes_outline_drop,
                  .spirv = kDropSpirv,
                  .needed = is_robust,
                  .reach = drop_reach,
                  .where = {{.plane = "outline_steep_trimmed"}, {.plane = "outline_flat_trimmed"}},
                  .packed = true},
                 {.name = "outline_rejoin",
                  .inputs = {"depth", "normal.x", "normal.y", "normal.z", "object_id", "outline_steep_left",
                             "outline_flat_left"},
                  .outputs = {"outline_join_left"},
                  .scalar = run_scalar_outline_rejoin,
                  .lanes = run_lanes_outline_rejoin,
                  .spirv = kRejoinSpirv,
                  .needed = is_robust,
                  .reach = join_reach,
                  .where = {{.plane = "outline_steep_left"}, {.plane = "outline_flat_left"}},
                  .packed = true},
                 {.name = "outline_pen",
                  .inputs = {"depth", "object_id", "material_id", "outline_steep_left", "outline_flat_left",
                             "outline_join_left"},
                  .outputs = {"outline_steep_pen", "outline_flat_pen", "outline_join_pen"},
                  .scalar = run_scalar_outline_pen,
                  .lanes = run_lanes_outline_pen,
                  .spirv = kPenSpirv,
                  .needed = is_robust,
                  .reach = pen_reach,
                  .where = {{.plane = "outline_steep_left"}, {.plane = "outline_flat_left"}},
                  .packed = true},
                 {.name = "outline_gather",
                  .inputs = {"outline_join_pen"},
                  .outputs = {"outline_around"},
                  .scalar = run_scalar_outline_gather,
                  .lanes = run_lanes_outline_gather,
                  .spirv = kGatherSpirv,
                  .needed = is_robust,
                  .reach = own_row,
                  .where = {{.plane = "outline_join_pen", .columns = gathered}}},
                 {.name = "outline_spread",
                  .inputs = {"outline_around"},
                  .outputs = {"outline_near"},
                  .scalar = run_scalar_outline_spread,
                  .lanes = run_lanes_outline_spread,
                  .spirv = kSpreadSpirv,
                  .needed = is_robust,
                  .reach = spread_reach,
                  .where = {{.plane = "outline_around", .rows = gathered}}},
                 {.name = "outline",
                  .inputs = {"depth", "normal.x", "normal.y", "normal.z", "object_id", "outline_steep_pen",
                             "outline_flat_pen", "outline_join_pen", "outline_around", "outline_near", "lit.r", "lit.g",
                             "lit.b"},
                  .outputs = {"lit.r", "lit.g", "lit.b", "outline"},
                  .scalar = run_scalar_outline,
                  .lanes = run_lanes_outline,
                  .spirv = kOutlineSpirv,
                  .needed = is_robust,
                  .reach = line_reach},
                 {.name = "outline_window",
                  .inputs = {"depth"},
                  .outputs = {"outline_window"},
                  .scalar = run_scalar_outline_window,
                  .lanes = run_lanes_outline_window,
                  .spirv = kWindowSpirv,
                  .needed = is_paper,
                  .reach = own_row},
                 {.name = "outline_paper",
                  .inputs = {"depth", "normal.x", "normal.y", "normal.z", "outline_window", "lit.r", "lit.g", "lit.b"},
                  .outputs = {"lit.r", "lit.g", "lit.b", "outline"},
                  .scalar = run_scalar_outline_paper,
                  .lanes = run_lanes_outline_paper,
                  .spirv = kPaperSpirv,
                  .needed = is_paper,
                  .reach = paper_reach}},
  };
  return effect;
}

}  // namespace umbrage
