#include "effects/unsharp/unsharp.h"

#include <algorithm>
#include <cmath>

#include "core/effect.h"
#include "effects/unsharp/unsharp_sums.h"
#include "kernel/kernel_frame.h"
#include "kernels/linearize.h"
#include "kernels/unsharp.h"
#include "spirv/unsharp_across.h"
#include "spirv/unsharp_blocks.h"
#include "spirv/unsharp_blocks16.h"
#include "spirv/unsharp_blocks4.h"
#include "spirv/unsharp_blocks8.h"
#include "spirv/unsharp_down.h"

namespace umbrage {

void run_tuned_unsharp(const KernelFrame&, const Tile&);  // unsharp.tuned.cpp

namespace {

// The default far plane puts the scene's farthest point at D = 0.9, so that it differs from the background by the
// paper's largest threshold, 0.1. The default near plane keeps the listing's ratio of 2 to 15.
constexpr float kFarFraction = 0.9f;
constexpr float kNearToFar = 2.0f / 15.0f;
// A Gaussian window extends two standard deviations to either side.
constexpr float kSigmasPerKernel = 4.0f;

const std::vector<Parameter> kUnsharpTable = {
    length_row("kernel", &UnsharpParams::kernel,
               {.initial_percent = 4, .min = 1, .max = kUnsharpMaxKernel, .unit = "px"},
               "side of the window that is averaged, in pixels or in percent of the picture's height"),
    real_row("threshold", &UnsharpParams::threshold, {.initial = 0.15, .max = 1, .zero_means = "none"},
             "samples whose linearised depth D differs from the pixel's by this much or more do not count"),
    choice_row("border", &UnsharpParams::border, 0, {"skip", "zero", "clamp", "repeat"},
               "samples outside the picture: skipped, window depth 0, the nearest pixel, or the picture repeated"),
    real_row("strength", &UnsharpParams::strength, {.initial = 16, .max = 1000},
             "factor from a difference of D to a difference of brightness"),
    choice_row("linearization", &UnsharpParams::linearization, kUnsharpExtent, {"linear", "listing", "extent"},
               "linearised depth D: z/F, 2z/(z+F) as in the paper's listing, or (z-N)/(F-N)"),
    real_row("near", &UnsharpParams::near_depth, {.max = 1e12, .unit = "scene units", .zero_means = "automatic"},
             "distance N of the near plane"),
    real_row("far", &UnsharpParams::far_depth, {.max = 1e12, .unit = "scene units", .zero_means = "automatic"},
             "distance F of the far plane"),
    choice_row("background", &UnsharpParams::background, 1, {"far", "ignore"},
               "pixels without a surface: on the far plane, or left out of every window"),
    bool_row("white_edge", &UnsharpParams::white_edge, false,
             "keep values above 1, the brightening on the near side of an edge"),
    choice_row("window", &UnsharpParams::window, 0, {"box", "gaussian"}, "weights of the window: equal, or Gaussian"),
};

int kernel_side(const Length& kernel, const PictureInfo& info) {
  const float side = length_px(kernel, info.reference_height(), info);
  return int(std::lround(std::clamp(side, 1.0f, float(kUnsharpMaxKernel))));
}

void fill_unsharp(const UnsharpParams& params, const PictureInfo& info, UnsharpConstants& c) {
  const int side = kernel_side(params.kernel, info);
  const int half = side / 2;
  // The listing's window starts floor(k/2) pixels to the left and below; here rows are counted from the top.
  c.first_column = -half;
  c.last_column = side - 1 - half;
  c.first_row = half - (side - 1);
  c.last_row = half;
  c.border = params.border;
  c.gaussian = params.window;
  c.linearization = params.linearization;
  c.ignore_background = params.background;
  c.keep_white_edge = params.white_edge;

  const bool extent = params.linearization == kUnsharpExtent;
  float far_depth = params.far_depth;
  if (!(far_depth > 0.0f)) far_depth = extent ? info.depth_max : info.depth_max / kFarFraction;
  float near_depth = params.near_depth;
  if (!(near_depth > 0.0f)) near_depth = extent ? info.depth_min : far_depth * kNearToFar;
  // Kernels must not fail: a near plane at or behind the far plane is moved slightly in front of it.
  far_depth = std::max(far_depth, 1e-30f);
  near_depth = std::clamp(near_depth, 0.0f, far_depth * 0.999f);
  c.near_depth = near_depth;
  c.far_depth = far_depth;

  c.threshold = params.threshold > 0.0f ? params.threshold * kUnsharpSteps : 2.0f * kUnsharpSteps;
  const float zero = params.linearization == kUnsharpLinear    ? near_depth / far_depth
                     : params.linearization == kUnsharpListing ? 2.0f * near_depth / (near_depth + far_depth)
                                                               : 0.0f;
  c.border_depth = std::min(std::floor(zero * kUnsharpSteps + 0.5f), kUnsharpSteps - 1.0f);
  c.scale = params.strength / kUnsharpSteps;
  const float sigma = std::max(float(side) / kSigmasPerKernel, 0.25f);
  for (int i = 0; i < kUnsharpWeights; ++i) c.weights[i] = std::exp(-0.5f * float(i) * float(i) / (sigma * sigma));
}

/// Sets the window so that it extends one radius to each side, at the middle of the scene's depth range.
void set_radius(float radius, const PictureInfo& info, ParameterBytes& bytes) {
  const double depth =
      info.camera.projection == Projection::kPerspective ? 0.5 * (info.depth_min + info.depth_max) : 1.0;
  const double pixel = (info.camera.top - info.camera.bottom) / info.height * depth;
  const double side = std::clamp(std::round(2.0 * radius / pixel), 1.0, double(kUnsharpMaxKernel));
  as<UnsharpParams>(bytes).kernel = {float(side), 0};
}

/// Returns whether running sums can be used.
bool has_no_threshold(const void* constants) {
  const auto& c = *static_cast<const UnsharpConstants*>(constants);
  return c.gaussian == 0 && c.threshold >= kUnsharpSteps;
}

/// Returns whether blocks can be used: samples outside the picture are all equal or absent.
bool has_blocks(const void* constants) {
  const auto& c = *static_cast<const UnsharpConstants*>(constants);
  const bool uniform_outside = c.border == kUnsharpBorderSkip || c.border == kUnsharpBorderZero;
  return c.gaussian == 0 && uniform_outside && c.last_column - c.first_column + 1 >= kUnsharpMinBlocks;
}

/// Alternatives to the kernel on a GPU, for box windows. Their cost hardly grows with the window.
const std::vector<GpuVariant> kGpuVariants = {
    {.fits = has_no_threshold,
     .steps = {{.name = "across",
                .inputs = {"unsharp_depth"},
                .outputs = {"unsharp_row_high", "unsharp_row_low"},
                .spirv = unsharp_across_spirv(),
                .group_width = kUnsharpSegment,
                .group_height = 1},
               {.name = "down",
                .inputs = {"depth", "unsharp_depth", "unsharp_row_high", "unsharp_row_low"},
                .outputs = {"ao"},
                .spirv = unsharp_down_spirv(),
                .group_width = kUnsharpStripWidth,
                .group_height = kUnsharpStripHeight}}},
    {.fits = has_blocks,
     .steps = {{.name = "blocks of 4",
                .inputs = {"unsharp_depth"},
                .outputs = {"unsharp_min4", "unsharp_max4", "unsharp_sum4"},
                .spirv = unsharp_blocks4_spirv()},
               {.name = "blocks of 8",
                .inputs = {"unsharp_min4", "unsharp_max4", "unsharp_sum4"},
                .outputs = {"unsharp_min8", "unsharp_max8", "unsharp_sum8"},
                .spirv = unsharp_blocks8_spirv()},
               {.name = "blocks of 16",
                .inputs = {"unsharp_min8", "unsharp_max8", "unsharp_sum8"},
                .outputs = {"unsharp_min16", "unsharp_max16", "unsharp_sum16"},
                .spirv = unsharp_blocks16_spirv()},
               {.name = "unsharp",
                .inputs = {"depth", "unsharp_depth", "unsharp_min4", "unsharp_max4", "unsharp_sum4", "unsharp_min8",
                           "unsharp_max8", "unsharp_sum8", "unsharp_min16", "unsharp_max16", "unsharp_sum16"},
                .outputs = {"ao"},
                .spirv = unsharp_blocks_spirv()}}}};

}  // namespace

Effect effect_unsharp() {
  return occlusion_effect<fill_unsharp>(
      kUnsharpTable, {.name = "unsharp",
                      .summary = "unsharp mask of the depth buffer: darker where the surroundings are nearer",
                      .source = "Chamberlin 2011",
                      .set_radius = set_radius,
                      .tunable = {"kernel", "threshold", "strength"},
                      .variants = {"", "kernel=15", "kernel=40", "kernel=121", "kernel=40 threshold=0",
                                   "kernel=121 threshold=0", "kernel=15 window=gaussian"},
                      .dispatches = {{.name = "linearize",
                                      .inputs = {"depth"},
                                      .outputs = {"unsharp_depth"},
                                      .kernel = linearize_kernel(),
                                      .reach = own_row},
                                     {.inputs = {"depth", "unsharp_depth"},
                                      .outputs = {"ao"},
                                      .kernel = unsharp_kernel(),
                                      .tuned = run_tuned_unsharp,
                                      .gpu_variants = kGpuVariants,
                                      .tile = kSquareTile,
                                      .reach = own_row,
                                      .unbounded_inputs = {"unsharp_depth"}}}});
}

}  // namespace umbrage
