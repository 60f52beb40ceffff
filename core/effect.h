// Effect: one technique as data: its parameters, its passes, its inputs and outputs.
#pragma once
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "core/gbuffer.h"
#include "core/length.h"
#include "core/parameters.h"

namespace umbrage {

struct KernelFrame;  // what a compiled kernel gets, and
struct Tile;         // the pixels that it computes: see kernel/kernel_frame.h
struct HostFrame;    // what a host step gets: see kernel/host_frame.h

/// A compiled kernel: computes the outputs of its pass for one tile. Tiles may run at the same time.
using CpuKernel = void (*)(const KernelFrame&, const Tile&);

/// A kernel text compiled three times. The build writes `kernels/NAME.h` with NAME_kernel() for every NAME.comp that
/// has a NAME.cpu.cpp beside it.
struct Kernel {
  CpuKernel scalar = nullptr, lanes = nullptr;  ///< as plain C++ and as SIMD lanes
  std::span<const std::uint32_t> spirv;         ///< as a compute shader
};

/// A pass that is a function of whole planes on the host. It may use all threads of its oneTBB arena.
using HostStep = void (*)(const HostFrame&);

/// One dispatch over all pixels on a GPU.
struct GpuStep {
  std::string_view name;
  /// Planes of the pass, and others that its steps alone know: they last from the first step to the last.
  std::vector<std::string_view> inputs, outputs;
  std::span<const std::uint32_t> spirv;
  int group_width = 8, group_height = 8;  ///< pixels that a workgroup computes; it is 8 x 8 invocations
};

/// Another way of a GPU to the bits of a pass.
struct GpuWay {
  bool (*fits)(const void* constants) = nullptr;  ///< whether it gives them with these constants, and sooner
  std::vector<GpuStep> steps;
};

/// Which pixels an effect is run for: all, or those alone where `ao` is kMissing. These get the occlusion of a run for
/// all, and nothing else; the others keep theirs.
enum class PixelSet { kAll, kMissing };

/// Pixels that the CPU takes at a time, a width that is a multiple of 16: whole rows, or what lies close together where
/// a pass reads all around.
struct TileSize {
  int width = 1 << 20, height = 16;
};
inline constexpr TileSize kSquareTile = {128, 32};

/// One run over all pixels.
struct Pass {
  std::string_view name;
  /// An effect that reads `shadow` leaves it out where it has a parameter of that name and it is 0.
  std::vector<std::string_view> inputs, outputs;  ///< planes; a colour or vector counts as its three planes
  std::vector<std::string_view> later_inputs;     ///< those of the inputs that the first round does not read
  Kernel kernel;
  CpuKernel tuned = nullptr;                               ///< another way to the same bits, or null
  std::vector<GpuWay> gpu_ways;                            ///< the first that fits runs in place of it
  HostStep host = nullptr;                                 ///< in place of kernels; such a pass has no `reach`
  bool (*needed)(const ParameterBytes& params) = nullptr;  ///< whether it runs at all; null: always
  TileSize tile;
  /// How many rows above and below a pixel's own it reads, at most, with these constants; null: it may read any.
  int (*reach)(const void* constants, int round) = nullptr;
  /// Inputs that it may read anywhere, whatever its reach. Of a layer that is not there nothing is read.
  std::vector<std::string_view> far_inputs = {};
  bool for_all = true, for_missing = false;  ///< for which pixels it runs
};

enum class EffectKind {
  kOcclusion,  ///< writes `ao`; every look can take it as its `occlusion`
  kFilter,     ///< smooths what a technique wrote, at the resolution at which that ran
  kShading,    ///< writes light or colour
  kOutput,     ///< turns light into what a file or a screen holds
};

/// What is to be brought from a picture of reduced resolution to its own.
struct Reduction {
  int factor = 2;         ///< the small picture holds every so manieth pixel, across and down: 2 or 4
  bool indirect = false;  ///< light too
  bool leave = false;     ///< pixels that no small one shows become kMissing
};

/// What a picture is exposed by.
enum class Exposure {
  kAsSet,    ///< nothing: as its parameters say
  kPicture,  ///< what is seen in it
  kLights,   ///< its lights
};

struct Effect {
  std::string_view name, summary;
  std::string_view source;  ///< key in docs/papers.md, or empty
  EffectKind kind = EffectKind::kShading;
  std::vector<Parameter> parameters;
  std::size_t params_size = 0;
  std::size_t constants_size = 0;
  /// Fills the constants that all passes read, from the params and the picture.
  void (*constants)(const ParameterBytes& params, const PictureInfo& info, void* constants) = nullptr;
  /// Of a technique that has a radius: sets it, in scene units, as nearly as its parameters can say it.
  void (*set_radius)(float radius, const PictureInfo& info, ParameterBytes& params) = nullptr;
  /// Of the effect that fills in a picture from one of reduced resolution.
  void (*set_reduction)(const Reduction& reduction, ParameterBytes& params) = nullptr;
  /// Of an effect that exposes: by what, and what makes it brighter by so many stops.
  Exposure (*exposed_by)(const ParameterBytes& params) = nullptr;
  void (*add_stops)(float stops, ParameterBytes& params) = nullptr;
  /// The parameter, a whole number, of which each value gives other noise: frames that are averaged have one each.
  std::string_view noise;
  /// Parameters that trade time for quality, or one error for another, and are searched by tuning; in that order.
  std::vector<std::string_view> tunable;
  /// Settings that differ in cost or quality, worth timing and comparing: "parameter=value parameter=value". The empty
  /// one, nothing set, is always among them.
  std::vector<std::string_view> variants;
  /// What one flipped sample or band is worth in the outputs, of kernels that count or threshold: machines whose last
  /// bits differ may flip a few. 0: smooth.
  double quantum = 0.0;
  std::vector<Pass> passes;
  /// How often the passes run on such a picture, all of them in order, each time; null: once.
  int (*rounds)(const ParameterBytes& params, const PictureInfo& info) = nullptr;
};

/// The row of a technique's radius in the scene, which set_radius_of<field> sets: in scene units, or a share of the
/// scene's radius, at first 10 %.
template <class Params>
Parameter radius_row(std::string_view name, Length Params::*field, std::string_view help) {
  return length_row(name, field, {.initial_percent = 10, .max = 1e12, .unit = "scene units", .above_zero = true}, help);
}

/// Effect::set_radius of a technique with a length in the scene, such as &HbaoParams::radius.
template <auto field>
void set_radius_of(float radius, const PictureInfo&, ParameterBytes& bytes) {
  const auto set = [&]<class Params>(Length Params::*length) { as<Params>(bytes).*length = {radius, 0}; };
  set(field);
}

/// The effect of that kind with this table, and with the structs that `fill_constants` takes: it is a function like
/// void fill_constants(const BoxParams&, const PictureInfo&, BoxConstants&), which gets the constants zeroed. A pass
/// without a name has the effect's.
template <auto fill_constants>
Effect effect_of(EffectKind kind, std::vector<Parameter> table, Effect effect) {
  effect.kind = kind;
  effect.parameters = std::move(table);
  for (Pass& pass : effect.passes)
    if (pass.name.empty()) pass.name = effect.name;
  const auto complete = [&]<class Params, class Constants>(void (*)(const Params&, const PictureInfo&, Constants&)) {
    effect.params_size = sizeof(Params);
    effect.constants_size = sizeof(Constants);
    effect.constants = [](const ParameterBytes& params, const PictureInfo& info, void* out) {
      auto& constants = *static_cast<Constants*>(out);
      constants = {};
      fill_constants(as<Params>(params), info, constants);
    };
  };
  complete(fill_constants);
  return effect;
}

/// How effects are written: `return filter_effect<fill_constants>(kTable, {...});`.
template <auto fill_constants>
Effect occlusion_effect(std::vector<Parameter> table, Effect effect) {
  return effect_of<fill_constants>(EffectKind::kOcclusion, std::move(table), std::move(effect));
}
template <auto fill_constants>
Effect filter_effect(std::vector<Parameter> table, Effect effect) {
  return effect_of<fill_constants>(EffectKind::kFilter, std::move(table), std::move(effect));
}
template <auto fill_constants>
Effect shading_effect(std::vector<Parameter> table, Effect effect) {
  return effect_of<fill_constants>(EffectKind::kShading, std::move(table), std::move(effect));
}
template <auto fill_constants>
Effect output_effect(std::vector<Parameter> table, Effect effect) {
  return effect_of<fill_constants>(EffectKind::kOutput, std::move(table), std::move(effect));
}

/// Pass::reach of a pass that reads its own row alone.
inline int own_row(const void*, int) { return 0; }

/// The pass of an occlusion technique that reads depth all around each pixel, and the normal at it alone.
Pass sampling_pass(const Kernel& kernel);

/// Whether an effect can be run for missing pixels: it needs a pass for them with these params.
bool runs_for_missing(const Effect& effect, const ParameterBytes& params);

/// What a length that is written in pixels is in pixels of this picture, of which several may make one at reduced
/// resolution; a share is of `whole_px`, the picture's share_width() or share_height().
float length_px(const Length& length, float whole_px, const PictureInfo& info);

/// What a radius is in scene units: a share is of the scene's radius. `owner` is named in errors ("reference.radius").
/// Errors: kUsage where it is not above 0, or larger than the scene, whose diameter is twice its radius.
Result<float> radius_in_scene(std::string_view owner, const Length& radius, const PictureInfo& info);

/// The row of that name, or null.
const Parameter* find_parameter(const Effect& effect, std::string_view name);

}  // namespace umbrage
