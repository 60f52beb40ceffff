// OFF files, as text.
#pragma once
#include <filesystem>

#include "core/progress.h"
#include "core/result.h"
#include "scene/scene.h"

namespace umbrage {

/// Reads an OFF file (also COFF, NOFF, STOFF and their mixtures) into a scene of one mesh, which is not finished yet.
/// Polygons are cut into fans, which is right for convex ones; without any, the vertices are points. Colours of
/// vertices are kept, those of faces are not. Errors: kFile, with the field that is wrong; kInterrupted.
Result<Scene> read_off(const std::filesystem::path& file, Poll* poll = nullptr);

}  // namespace umbrage
