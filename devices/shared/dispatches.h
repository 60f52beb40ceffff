// Runs the dispatches of an effect, on every device.
#pragma once
#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "core/device.h"
#include "core/effect.h"
#include "kernel/frame_constants.h"

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
Result<RunState> run_dispatches(const Effect& effect, const ParameterBytes& params, const Frame& frame, int layer,
                                PixelSet pixels, const std::function<Result<RunState>(const DispatchRun&)>& run);

/// Returns the error that an effect reads a plane that the picture lacks.
Error missing_plane(const DispatchRun& run, std::string_view plane);

/// Returns the error that an effect needs the scene of a picture that has none.
Error missing_scene(const DispatchRun& run);

/// Throws InternalError if a setting is outside its range. Errors: see layer_count.
Result<void> check_capture(const CaptureSettings& settings);

}  // namespace umbrage
