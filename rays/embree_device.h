// Embree's device: where all of them are made, bounded by the instruction set in use.
#pragma once
#include <embree3/rtcore.h>

#include <string_view>

#include "core/result.h"
#include "scene/scene.h"

namespace umbrage {

/// A device that uses no wider instructions than isa_in_use() (kernel/isa.h). Throws std::bad_alloc where memory is
/// short. Errors: kDevice where Embree cannot start otherwise.
Result<RTCDevice> new_embree_device();

/// What went wrong where Embree could not build a hierarchy of the scene. kDevice.
Error build_error(const Scene& scene, RTCError error);

/// The name of the widest instruction set that Embree's kernels use on this machine, as kernel/isa.h has it, or
/// "sse2".
std::string_view isa_of_rays();

}  // namespace umbrage
