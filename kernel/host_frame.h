// HostFrame: input and output of a host step, a dispatch that computes whole planes on the host, whichever device holds
// the frame.
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
  int stride;   ///< floats from one row to the next

  float* row(int y) const { return data + std::ptrdiff_t(y) * stride; }
};

/// The planes of a host step, each of frame.width x frame.height pixels. Inputs are read-only. Outputs are
/// uninitialised and must be filled completely. They share no memory with inputs, not even with inputs of the same
/// name.
struct HostFrame {
  const PictureInfo& info;
  FrameConstants frame;
  const void* constants;              ///< the effect's constants struct
  std::span<const HostPlane> inputs;  ///< in the order of the dispatch's table
  std::span<const HostPlane> outputs;

  /// Returns the plane of that name. Throws std::logic_error if the dispatch's table does not list it.
  const HostPlane& input(std::string_view name) const;
  const HostPlane& output(std::string_view name) const;
};

}  // namespace umbrage
