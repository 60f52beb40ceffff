// Dispatches that trace rays on the CPU: see Dispatch::rays.
#pragma once
#include "core/effect.h"
#include "core/gbuffer.h"
#include "core/progress.h"
#include "core/strip.h"
#include "kernel/kernel_frame.h"
#include "rays/traced_scene.h"

namespace umbrage {

/// A dispatch that traces rays, on the rows of a picture or a strip.
struct RayTask {
  const TracedScene& traced;
  const PictureInfo& info;
  RaySettings settings;
  CpuKernel kernel;          ///< makes the rays
  const KernelFrame& frame;  ///< planes of the dispatch, inputs and outputs, without `ray`
  Rows rows;
  const PixelMask* mask = nullptr;  ///< the pixels that need rays; others may have them, too. Null: all
};

/// Traces all rays and writes the outputs. Uses all threads of the calling task arena; the result does not depend on
/// their number. After an interruption the outputs are incomplete.
void trace_rays(const RayTask& task, Watch& watch);

/// Returns the number of steps that trace_rays reports to the watch.
long ray_steps(const Rows& rows);

}  // namespace umbrage
