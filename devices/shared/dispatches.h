// Runs the dispatches of an effect, on every device; host steps compute whole planes in the same way on all of them.
#pragma once
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/device.h"
#include "core/effect.h"
#include "core/image.h"
#include "kernel/frame_constants.h"
#include "kernel/host_frame.h"

namespace umbrage {

/// Returns the constants of the picture that all kernels read. `stride`: floats between rows of its planes.
FrameConstants frame_constants(const PictureInfo& info, int stride, int round, PixelSet pixels = PixelSet::kAll);

/// One dispatch of an effect, with all data needed to run it.
struct DispatchRun {
  const Effect& effect;
  const Dispatch& dispatch;
  const ParameterBytes& params;
  std::span<const std::byte> constants;
  const PictureInfo& info;  ///< of the layer: see layer_info
  int layer = 0, round = 0;
  PixelSet pixels = PixelSet::kAll;
  std::span<const Dispatch* const> later = {};  ///< dispatches of the same run that follow, in all rounds

  /// Returns the name that a plane of the dispatch has in the frame.
  std::string plane(std::string_view name) const;
  /// Returns whether the picture has the layer of this output; kernels do not store to other layers.
  bool has_layer_of(std::string_view output) const;
};

/// Calls `run` for each dispatch that the effect needs with these params, in order. Stops at the first one that fails
/// or does not finish.
Result<RunState> run_dispatches(const Effect& effect, const ParameterBytes& params, const Frame& frame,
                                const EffectRun& settings,
                                const std::function<Result<RunState>(const DispatchRun&)>& run);

/// Returns the error that an effect reads a plane that the picture lacks.
Error missing_plane(const DispatchRun& run, std::string_view plane);

/// Returns the error that an effect needs the scene of a picture that has none.
Error missing_scene(const DispatchRun& run);

/// Throws InternalError if a setting is outside its range. Errors: see layer_count.
Result<void> check_capture(const CaptureSettings& settings);

/// Returns planes as the inputs of a host step, which does not write to them. `planes`: in the order of
/// Dispatch::inputs.
std::vector<HostPlane> host_inputs(const Dispatch& dispatch, std::span<const Plane* const> planes);

/// Runs the host step of a dispatch. `inputs`: planes of the picture's size, in the order of Dispatch::inputs. Returns
/// the planes of Dispatch::outputs in order; those of layers that do not exist are empty. Exceptions of the step
/// propagate.
std::vector<Plane> run_host_step(const DispatchRun& run, std::span<const Plane* const> inputs);

}  // namespace umbrage
