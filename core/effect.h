// Effect: one technique as data: parameters, dispatches, inputs and outputs.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <typeindex>
#include <utility>
#include <vector>

#include "core/gbuffer.h"
#include "core/length.h"
#include "core/parameters.h"
#include "core/strokes.h"

namespace umbrage {

/// Weight of an occluder at distance t.
enum class Falloff {
  kNone,    ///< 1 within the radius
  kLinear,  ///< 1 - t / radius
  kSmooth,  ///< 1 - smoothstep(0, radius, t)
};

/// Returns the weight of an occluder at distance `fraction` times the radius.
inline float falloff_weight(Falloff falloff, float fraction) {
  if (falloff == Falloff::kNone) return 1.0f;
  if (falloff == Falloff::kLinear) return 1.0f - fraction;
  return 1.0f - fraction * fraction * (3.0f - 2.0f * fraction);
}

/// The rays that a dispatch traces in the captured scene.
struct RaySettings {
  int max_rays = 1;     ///< per pixel
  float radius = 1.0f;  ///< length of a ray, scene units
  Falloff falloff = Falloff::kNone;
  float light = 0.0f;           ///< factor for the light of the surfaces that rays hit; 0: it is not gathered
  float ambient_bounce = 1.0f;  ///< factor for the ambient light that these surfaces reflect
  std::uint32_t seed = 0;       ///< of the light that is chosen on a surface
  /// Factor for the difference that the direction of ambient light makes: a blocked ray adds the light of the whole
  /// hemisphere of the triangle's normal, minus that of its own direction. 0: off.
  float directional = 0.0f;
  std::array<float, 27> sky{};  ///< sky_factors() of ambient light, view space
};

struct KernelFrame;  // input of a compiled kernel: see kernel/kernel_frame.h
struct Tile;         // pixels that a kernel computes: see kernel/kernel_frame.h
struct HostFrame;    // input and output of a host step: see kernel/host_frame.h

/// A compiled kernel: computes the outputs of its dispatch for one tile. Tiles may run concurrently.
using CpuKernel = void (*)(const KernelFrame&, const Tile&);

/// A kernel compiled three times. The build writes `kernels/NAME.h` with NAME_kernel() for every kernel NAME: a text
/// NAME.kernel.h that defines NAME_pixel, or a line `// KERNEL NAME: ...` of such a text (cmake/kernels.cmake).
struct Kernel {
  CpuKernel scalar = nullptr, lanes = nullptr;  ///< plain C++; SIMD lanes
  std::span<const std::uint32_t> spirv;         ///< compute shader
};

/// A dispatch that computes whole planes on the host. It may use all threads of its oneTBB arena.
using HostStep = void (*)(const HostFrame&);

/// How the lines of a host step stay on surfaces between the key frames of a sequence (renderer/key_lines.h). Both use
/// the threads of their oneTBB arena.
struct KeySteps {
  /// Returns the lines of a key frame from the inputs of the host step, of which it does not read those that depend on
  /// light. They do not refer to the frame.
  SurfaceLines (*key)(const HostFrame& frame) = nullptr;
  /// Returns LinesBetween::lines of the frames between two key frames.
  SurfaceLines (*join)(const SurfaceLines& first, const SurfaceLines& second) = nullptr;
};

/// One compute shader that runs over all pixels, as a part of a dispatch.
struct GpuStep {
  std::string_view name;
  /// Planes of the dispatch, or temporary planes, which live from its first step to its last.
  std::vector<std::string_view> inputs, outputs;
  std::span<const std::uint32_t> spirv;
  int group_width = 8, group_height = 8;  ///< pixels per workgroup, which has 8 x 8 invocations
};

/// An alternative GPU implementation of a dispatch, with bitwise identical results.
struct GpuVariant {
  bool (*fits)(const void* constants) = nullptr;  ///< whether it is exact with these constants, and faster
  std::vector<GpuStep> steps;
};

/// The pixels that an effect runs on.
enum class PixelSet {
  kAll,
  /// Only those where `ao` is kMissing. They get the occlusion that a run on all pixels would give them, and no other
  /// output; the others keep theirs.
  kMissing,
};

/// The tile that a CPU thread computes at a time, pixels; `width` is a multiple of 16. Whole rows by default;
/// kSquareTile for dispatches that read in all directions around a pixel.
struct TileSize {
  int width = 1 << 20, height = 16;
};
inline constexpr TileSize kSquareTile = {128, 32};

/// One dispatch over all pixels: its planes and its implementations.
struct Dispatch {
  std::string_view name;
  /// If the effect has a parameter `shadow` and it is 0, the input `shadow` is not needed.
  std::vector<std::string_view> inputs, outputs;  ///< planes; a colour or vector counts as its three planes
  std::vector<std::string_view> later_inputs;     ///< the inputs that the first round does not read
  Kernel kernel;
  CpuKernel tuned = nullptr;             ///< faster kernel with bitwise identical results, or null
  std::vector<GpuVariant> gpu_variants;  ///< the first that fits runs instead of `kernel`
  HostStep host = nullptr;               ///< runs instead of kernels; `reach` is then null
  /// For a host step that draws lines: returns them.
  Strokes (*trace)(const HostFrame& frame) = nullptr;
  KeySteps keys = {};  ///< for such a step; empty: each frame has its own lines
  /// If not null, the dispatch traces rays in the captured scene. Its kernel makes them: it runs once for each ray
  /// index, FrameConstants::round from 0 to max_rays - 1, and writes `ray.x .y .z`, a unit direction in view space, or
  /// 0 where the pixel has fewer rays. A ray starts at the pixel's surface point plus `ray_offset`. The device writes
  /// the outputs:
  ///   ao                   mean visibility of the pixel's rays within the radius; 1 without rays
  ///   traced_confidence    n / (n + 1) for n rays
  ///   bent.x .y .z         mean direction of unblocked rays, unit, view space; 0 if there are none
  ///   indirect.r .g .b     mean radiance that arrives along the rays
  RaySettings (*rays)(const ParameterBytes& params, const PictureInfo& info) = nullptr;
  bool (*needed)(const ParameterBytes& params) = nullptr;  ///< whether the dispatch runs at all; null: always
  TileSize tile;
  /// Returns how many rows above and below a pixel it reads at most, with these constants; null: any row. `columns`
  /// returns the same for columns to the left and right; null: any column, but own_pixel reads none.
  int (*reach)(const void* constants, int round) = nullptr;
  int (*columns)(const void* constants, int round) = nullptr;
  /// Inputs that may be read at any pixel, regardless of `reach`. A layer that does not exist is not read.
  std::vector<std::string_view> unbounded_inputs = {};
  bool for_all = true, for_missing = false;  ///< the pixel sets that it runs on
  bool first_round_only = false;             ///< it runs in the first of the effect's rounds only
  bool last_round_only = false;              ///< likewise, in the last
};

/// The value of the planes of a pass, such as "line" or "ao", where nothing has written them.
struct NeutralValue {
  std::string_view pass;
  float value = 0.0f;
};

enum class EffectKind {
  kOcclusion,  ///< writes `ao`; every look accepts it as its `occlusion`
  kFilter,     ///< smooths the output of a technique, at the resolution of the technique
  kShading,    ///< writes light or colour
  kOutput,     ///< converts light to the values of a file or a display
};

/// Upsampling of a picture at reduced resolution.
struct Reduction {
  int factor = 2;         ///< downsampling factor: 2 or 4
  bool indirect = false;  ///< upsample indirect light too
  bool leave = false;     ///< pixels whose surface no reduced pixel shows become kMissing
};

/// What the exposure of a picture depends on.
enum class Exposure {
  kAsSet,    ///< the parameters of the effect alone
  kPicture,  ///< the brightness of the picture
  kLights,   ///< its lights
};

struct Effect {
  std::string_view name, summary;
  std::string_view source;  ///< key in docs/papers.md, or empty
  EffectKind kind = EffectKind::kShading;
  std::vector<Parameter> parameters;
  std::type_index params_type = typeid(void);  ///< of its params struct, such as BoxParams
  std::size_t params_size = 0;
  std::size_t constants_size = 0;
  /// Computes the constants that all dispatches read, from the params and the picture.
  void (*constants)(const ParameterBytes& params, const PictureInfo& info, void* constants) = nullptr;
  /// For a technique with a radius: sets it to `radius`, scene units, as closely as its parameters allow.
  void (*set_radius)(float radius, const PictureInfo& info, ParameterBytes& params) = nullptr;
  /// For the effect that upsamples a picture of reduced resolution: sets its parameters for this reduction.
  void (*set_reduction)(const Reduction& reduction, ParameterBytes& params) = nullptr;
  /// For an effect that applies exposure: `exposure_source` returns what the exposure depends on, `add_stops` raises it
  /// by `stops`.
  Exposure (*exposure_source)(const ParameterBytes& params) = nullptr;
  void (*add_stops)(float stops, ParameterBytes& params) = nullptr;
  /// For an effect with a dispatch that traces lines: the settings with which it draws all but them, and those with
  /// which it draws them alone: "effect.parameter=value".
  std::vector<std::string_view> without_lines, lines_alone;
  /// Name of the integer parameter that selects the noise: each sample index of an accumulation gets its own value.
  std::string_view noise;
  /// For a technique that filters its own output: looks leave out the effects of kind kFilter behind it. It runs at
  /// full resolution only.
  bool filters_itself = false;
  /// For such a technique: the names of the parameter that turns the filter on or off, and of the one that makes it
  /// filter the planes that the frame has, without new samples: the number of frames whose samples they are.
  std::string_view filter_switch, joined_frames;
  /// Parameters that trade time for quality, or one error for another, in the order in which tuning searches them.
  std::vector<std::string_view> tunable;
  /// Settings that differ in cost or quality, for timing and comparison: "parameter=value parameter=value". Always
  /// includes the empty string, which leaves all defaults.
  std::vector<std::string_view> variants;
  /// The change of an output when one sample or one tone step flips, for kernels that count or threshold: machines that
  /// differ in the last bits may flip a few. 0: the outputs are smooth.
  double quantum = 0.0;
  /// Returns the size of the set PictureInfo::occluders that `constants` reads, with these params; null: it reads none.
  int (*occluders)(const ParameterBytes& params) = nullptr;
  /// Returns the number of captured layers that it needs with these params, the first included; null: 1. A request can
  /// set another number.
  int (*layers)(const ParameterBytes& params) = nullptr;
  /// Of planes that it makes, or that are made for it outside effects: see neutral_value in effects/effects.h.
  std::vector<NeutralValue> neutral;
  std::vector<Dispatch> dispatches;
  /// Returns the number of rounds, each of which runs all dispatches in order, for this picture; null: one.
  int (*rounds)(const ParameterBytes& params, const PictureInfo& info) = nullptr;
};

/// Returns the parameter row of a technique's radius, which set_radius_of<field> sets: in scene units, or percent of
/// the bounding-sphere radius. Default: 10%.
template <class Params>
Parameter radius_row(std::string_view name, Length Params::*field, std::string_view help) {
  return length_row(name, field, {.initial_percent = 10, .max = 1e12, .unit = "scene units", .above_zero = true}, help);
}

/// Implements Effect::set_radius for a technique whose `field` is a length in the scene, such as &HbaoParams::radius.
template <auto field>
void set_radius_of(float radius, const PictureInfo&, ParameterBytes& bytes) {
  const auto set = [&]<class Params>(Length Params::*length) { as<Params>(bytes).*length = {radius, 0}; };
  set(field);
}

/// Returns `effect` with this kind and parameter table, and with the type, sizes and `constants` function that follow
/// from `fill_constants`: a function such as void fill_box(const BoxParams&, const PictureInfo&, BoxConstants&),
/// which receives zero-initialized constants. A dispatch without a name gets the name of the effect.
template <auto fill_constants>
Effect effect_of(EffectKind kind, std::vector<Parameter> table, Effect effect) {
  effect.kind = kind;
  effect.parameters = std::move(table);
  for (Dispatch& dispatch : effect.dispatches)
    if (dispatch.name.empty()) dispatch.name = effect.name;
  const auto complete = [&]<class Params, class Constants>(void (*)(const Params&, const PictureInfo&, Constants&)) {
    effect.params_type = typeid(Params);
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

/// Return an effect of one kind, completed by effect_of. Usage: `return filter_effect<fill_box>(kBoxTable, {...});`.
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

/// Implements Dispatch::reach or columns for a dispatch that reads only its own row or column.
inline int own_row(const void*, int) { return 0; }
inline int own_column(const void*, int) { return 0; }
/// Implements Dispatch::reach for a dispatch that reads only its own pixel.
inline int own_pixel(const void*, int) { return 0; }

/// Returns the dispatch of an occlusion technique that reads depth anywhere around each pixel, and the normal only at
/// the pixel.
Dispatch sampling_dispatch(const Kernel& kernel);

/// Returns whether a dispatch runs with these params.
inline bool runs(const Dispatch& dispatch, const ParameterBytes& params) {
  return !dispatch.needed || dispatch.needed(params);
}

/// Returns the dispatches that an effect runs on these pixels of a picture, in order, each with its round.
std::vector<std::pair<const Dispatch*, int>> dispatches_in_order(const Effect& effect, const ParameterBytes& params,
                                                                 const PictureInfo& info, PixelSet pixels);

/// Returns whether a dispatch reads or writes a plane.
bool uses(const Dispatch& dispatch, std::string_view plane);

/// Returns whether an effect writes a plane with these params.
bool writes(const Effect& effect, const ParameterBytes& params, std::string_view plane);

/// Returns whether an effect can run on PixelSet::kMissing: one of its dispatches must be for missing pixels and be
/// needed with these params.
bool runs_for_missing(const Effect& effect, const ParameterBytes& params);

/// Converts a length to pixels of this picture. An absolute length is in pixels of full resolution and is divided by
/// the downsampling factor; a relative length is in percent of `whole_px`, the reference_width() or reference_height()
/// of the picture.
float length_px(const Length& length, float whole_px, const PictureInfo& info);

/// Converts a radius to scene units; a relative length is in percent of the bounding-sphere radius. `owner` names the
/// parameter in errors ("reference.radius"). Errors: kUsage if the radius is not above 0 or exceeds 200% of the
/// bounding-sphere radius.
Result<float> radius_in_scene(std::string_view owner, const Length& radius, const PictureInfo& info);

/// Returns whether an effect needs the scene of the picture besides its planes: one of its dispatches traces rays.
bool needs_scene(const Effect& effect);

/// Returns the size of the set of coarse occluders that an effect reads with these params; 0: it reads none.
int occluders_read(const Effect& effect, const ParameterBytes& params);

/// Returns the number of captured layers that an effect needs with these params, the first included.
int layers_needed(const Effect& effect, const ParameterBytes& params);

/// Returns the row with that name or former name, or null.
const Parameter* find_parameter(const Effect& effect, std::string_view name);

}  // namespace umbrage
