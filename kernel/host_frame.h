// HostFrame: input and output of a host step, a pass that computes whole planes on the host, on whatever device the
// frame is.
#pragma once
#include <cstddef>
#include <span>
#include <string_view>

#include "kernel/frame_constants.h"

namespace umbrage {

struct PictureInfo;  // core/gbuffer.h

struct HostPlane {
  std::string_view name;
  float* data;  ///< pixel (0, 0); null for an output on a layer that does not exist
  int stride;   ///< floats between rows

  float* row(int y) const { return data + std::ptrdiff_t(y) * stride; }
};

/// All planes have frame.width x frame.height pixels, their rows HostPlane::stride apart. Inputs are read-only. Outputs
/// are uninitialised, share no memory with inputs, not even those of the same name, and must be filled completely.
struct HostFrame {
  const PictureInfo& info;
  FrameConstants frame;
  const void* constants;              ///< the effect's constants struct
  std::span<const HostPlane> inputs;  ///< in the order of the pass's table
  std::span<const HostPlane> outputs;

  /// Returns the plane of that name. Throws std::logic_error if the pass's table does not list it.
  const HostPlane& input(std::string_view name) const;
  const HostPlane& output(std::string_view name) const;
};

}  // namespace umbrage
