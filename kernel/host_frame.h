// HostFrame: what a host step gets, a pass that is a function of whole planes and runs on the host, whatever device
// the frame is on.
#pragma once
#include <cstddef>
#include <span>
#include <string_view>

#include "kernel/frame_constants.h"

namespace umbrage {

struct PictureInfo;  // core/gbuffer.h

struct HostPlane {
  std::string_view name;
  float* data;  ///< pixel (0, 0); of an output on a layer that is not there null
  int stride;   ///< floats from one row to the next

  float* row(int y) const { return data + std::ptrdiff_t(y) * stride; }
};

/// All planes have frame.width x frame.height pixels, their rows HostPlane::stride apart. Inputs are for reading alone;
/// outputs are not initialised, share no memory with inputs, not even those of the same name, and are filled wholly.
struct HostFrame {
  const PictureInfo& info;
  FrameConstants frame;
  const void* constants;              ///< the effect's constants struct
  std::span<const HostPlane> inputs;  ///< in the order of the pass's table
  std::span<const HostPlane> outputs;

  /// The plane of that name. Throws std::logic_error where the pass's table does not list it.
  const HostPlane& input(std::string_view name) const;
  const HostPlane& output(std::string_view name) const;
};

}  // namespace umbrage
