// How an effect becomes passes, on every device.
#pragma once
#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "core/device.h"
#include "core/effect.h"
#include "kernel/frame_constants.h"

namespace umbrage {

/// What kernels read of a picture whose planes have rows `stride` floats apart.
FrameConstants frame_constants(const PictureInfo& info, int stride, int round, PixelSet pixels = PixelSet::kAll);

/// One pass of an effect as it is to run.
struct PassRun {
  const Effect& effect;
  const Pass& pass;
  std::span<const std::byte> params, constants;
  const PictureInfo& info;  ///< as the layer shows the picture
  int layer = 0, round = 0;
  PixelSet pixels = PixelSet::kAll;

  /// The name in the frame of one of the pass's planes.
  std::string plane(std::string_view name) const;
  /// Whether the picture has the layer of an output; a kernel does not store to others.
  bool is_there(std::string_view output) const;
};

/// Calls `run` for each pass that the effect needs with these params, in order. Ends with the first one that fails or
/// is not finished.
Result<Progression> run_passes(const Effect& effect, const ParameterBytes& params, const Frame& frame, int layer,
                               PixelSet pixels, const std::function<Result<Progression>(const PassRun&)>& run);

/// The error of a pass that reads a plane which the picture does not have.
Error missing_plane(const PassRun& run, std::string_view plane);

/// Ends the program unless the settings are such as a capture takes. Errors: see layer_count.
Result<void> check_capture(const CaptureSettings& settings);

}  // namespace umbrage
