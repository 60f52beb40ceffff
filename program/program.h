// Program: what a look does to a frame, compiled before it is drawn: planes, and the operations that read and write
// them in order. A program depends on the look, its settings and the number of layers, hardly on the model.
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/device.h"
#include "core/look.h"
#include "looks/looks.h"
#include "looks/metering.h"
#include "looks/settings.h"

namespace umbrage {

/// Runs an external technique, which no device can run because it needs more than a frame. Adds its planes to the
/// frame.
using RunExternalEffect = std::function<Result<void>(const Effect&, const ParameterBytes&, Frame&)>;

/// Returns the stops to add to the exposure of a picture, or nullopt for a strip whose picture is not complete yet.
using Meter = std::function<Result<std::optional<float>>(Device&, const Frame&)>;

/// An effect that runs before or after those of a look.
struct EffectStep {
  const Effect* effect = nullptr;
  ParameterBytes params;
  int layer = 0;
};

/// What to run and with which settings.
struct LookRun {
  const Look* look = nullptr;
  std::string_view occlusion;  ///< name of the technique, or kNoOcclusion
  /// Downsampling factor of the technique and of the filters that follow it: 1, 2 or 4. External techniques and those
  /// that filter themselves always run at full resolution.
  int occlusion_downsampling = 1;
  const EffectSettings* settings = nullptr;
  /// Requested planes; effects that contribute to none of them are skipped. nullopt: all effects run.
  std::optional<std::vector<std::string>> wanted = {};
  /// The planes that are read after the run, on all layers: `wanted` and more. The device releases each other plane
  /// when no later step reads it. nullopt: all planes are kept.
  std::optional<std::vector<std::string>> kept = {};
  /// Called with the name of each effect when the effect is done.
  std::function<void(std::string_view)> after = [](std::string_view) {};
  std::vector<EffectStep> lines = {};  ///< effects that draw lines once, over the average; they run last
  /// Leaves out the technique and its filters: the frame has the planes that they write.
  bool has_technique = false;
  ProgressMonitor monitor = {};                          ///< passed to every effect
  std::optional<float> stops = {};                       ///< to add in place of metering; unused if Exposure::kAsSet
  Meter meter = metered_stops;                           ///< used with Exposure::kPicture
  std::span<const Effect* const> external_effects = {};  ///< external techniques
  RunExternalEffect run_external_effect = {};            ///< required if an external technique is used
};

/// Returns the effects of a run in order, with the occlusion technique in its place. Filters behind a technique that
/// filters itself are left out.
std::vector<const Effect*> steps_of(const LookRun& run);

/// Returns the effects of a run except for the technique and the filters that follow it.
std::vector<const Effect*> steps_besides_technique(const LookRun& run);

/// Returns whether a run can draw further samples at marked pixels: apart from the technique and its
/// filters all effects compute each pixel by itself, and neither they nor `planes` need any planes of the technique and
/// its filters but `ao` and `indirect`.
bool runs_on_marked(const LookRun& run, std::span<const std::string> planes);

/// A plane of a program, at one resolution.
struct ProgramPlane {
  std::string name;
  int reduced = 1;     ///< downsampling factor of its frame
  int last_user = -1;  ///< the last operation that reads or writes it
  bool kept = false;   ///< read after the program
};

enum class OperationKind {
  kRun,       ///< runs an effect
  kExternal,  ///< runs an external technique
  kReduce,    ///< makes the frame of reduced resolution
  kPlace,     ///< copies planes of that frame to the frame of full resolution, as reduced_plane; it ends there
  kMeter,     ///< determines the exposure
};

struct Operation {
  OperationKind kind = OperationKind::kRun;
  const Effect* effect = nullptr;  ///< kRun, kExternal; kMeter: the effect that exposes the picture
  int layer = 0;
  int reduced = 1;  ///< downsampling factor of the frame that it runs on; of kReduce and kPlace: of the reduced frame
  PixelSet pixels = PixelSet::kAll;
  int line = -1;                            ///< kRun: index in LookRun::lines; -1: an effect of the look
  std::optional<Reduction> upsampled = {};  ///< set for the effect that upsamples
  Exposure exposure = Exposure::kAsSet;     ///< kMeter: what it depends on; kRun: metered stops are added unless kAsSet
  std::vector<int> reads = {}, writes = {};  ///< planes, by index in Program::planes
  std::string_view done = {};                ///< the step that ends with it: see LookRun::after; empty: none
};

struct Program {
  std::vector<ProgramPlane> planes;
  std::vector<Operation> operations;

  /// Returns the names of planes.
  std::vector<std::string> names_of(std::span<const int> indices) const;
  /// Returns the planes of the first layer that only this operation still uses.
  std::vector<std::string> last_used(std::size_t operation) const;
  /// Returns the planes that are read after this operation, by their names on the first layer. `kept`: see
  /// LookRun::kept.
  std::set<std::string_view> needed_after(std::size_t operation, std::span<const std::string> kept) const;
};

/// Compiles a run on frames of `layers` layers. `info`: that of the frame, which can tell that planes are not read;
/// null: not known yet.
Program compile(const LookRun& run, int layers, const PictureInfo* info = nullptr);

/// Returns the parameters of an operation that runs an effect. `stops`: added to the exposure by metering.
ParameterBytes params_of_operation(const LookRun& run, const Operation& operation, float stops);

/// How far above, below, left and right of the pixels of a result a plane is needed, pixels of full resolution; at most
/// kAnywhere.
struct Margin {
  int rows = 0, columns = 0;
};
inline constexpr int kAnywhere = 1 << 28;
using Margins = std::map<std::string, Margin>;  ///< of planes, by name

/// What the strips of a picture need.
struct StripNeeds {
  std::vector<Margins> sweeps;           ///< margins of the planes of a frame at first, for each sweep over the strips
  double whole_planes = 0.0;             ///< planes of the whole picture, at full resolution: see core/strip.h
  std::vector<std::string> whole_names;  ///< of those at full resolution
  double not_stored = 0.0;               ///< those of them that the frames of strips do not have, too
};

/// Returns the margins that the planes of a frame need at first, so that after the steps `before` and a run planes have
/// the margins `after`. The empty name has the margin of the pixels that must be computed, which may depend only on
/// planes that are whole. `info`: that of the frame.
Margins margins_before(const LookRun& run, const PictureInfo& info, std::span<const EffectStep> before,
                       const Margins& after);
/// Returns the same for the strips of a picture. A sweep over them ends at the first operation that reads any row of a
/// plane that is not whole yet. `given`: the planes that the frame has at first.
StripNeeds needs_of_strips(const LookRun& run, const PictureInfo& info, std::span<const EffectStep> before,
                           std::span<const std::string> given, const Margins& after);

/// The memory of the planes of a frame, in planes of full resolution.
struct LivePlanes {
  double max = 0.0;     ///< at any time
  double at_end = 0.0;  ///< when the run is done
};
/// Returns the memory of a frame that has the planes `given` at first, while the look runs on it.
LivePlanes live_planes(const LookRun& run, const PictureInfo& info, std::span<const std::string> given);

/// Returns the planes that the program reads from a frame. Those that nothing has written exist after the run with
/// their neutral value everywhere, if they have one. Planes that are downsampled first are not included.
std::set<std::string> planes_read(const Program& program);

/// An operation in words, for lists: "relight", "reads depth, normal; writes direct, ambient".
struct OperationText {
  std::string name, summary;
};
std::vector<OperationText> described(const Program& program);

/// The result of a run.
struct LookDone : RunState {
  float stops = 0.0f;  ///< stops added to the exposure by metering; 0: none
};

/// Runs a look's effects on a frame. Afterwards the frame has color.r, color.g, color.b and color.a. If a later effect
/// reads an effect's planes on further layers, such as `layer1.direct.r`, that effect runs on all layers of the frame,
/// otherwise on the first only. On a strip the run may be unfinished: see Device::run.
Result<LookDone> run_look(const LookRun& run, Device& device, Frame& frame);

}  // namespace umbrage
