// Reader for OFF files in text form.
#pragma once
#include <filesystem>

#include "core/progress.h"
#include "core/result.h"
#include "scene/scene.h"

namespace umbrage {

/// Reads an OFF file (also COFF, NOFF, STOFF and their combinations) into a scene of one mesh, before finish_scene.
/// Positions are read in double precision. Without polygons, the vertices become points. Colours of faces are kept if
/// vertices have none. Errors: kFile, naming the wrong field; kInterrupted.
Result<Scene> read_off(const std::filesystem::path& file, Poll* poll = nullptr);

}  // namespace umbrage
