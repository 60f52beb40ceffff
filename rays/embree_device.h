// Creation of Embree devices, limited to the instruction set in use.
#pragma once
#include <string_view>

#include "core/result.h"
#include "rays/embree.h"
#include "scene/scene.h"

namespace umbrage {

/// Creates a device that uses no wider instructions than isa_in_use() (kernel/isa.h). Throws std::bad_alloc if memory
/// is exhausted. Errors: kDevice if Embree cannot start for another reason.
Result<RTCDevice> new_embree_device();

/// Returns the kDevice error for a scene for which Embree could not build a hierarchy.
Error build_error(const Scene& scene, RTCError error);

/// Returns the name of the widest instruction set that Embree's kernels use on this machine, as in kernel/isa.h, or
/// "sse2"; "none" if Embree cannot start.
std::string_view isa_of_embree();

}  // namespace umbrage
