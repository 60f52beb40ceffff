// Reader for STL files, binary and text.
#pragma once
#include <filesystem>

#include "core/progress.h"
#include "core/result.h"
#include "scene/scene.h"

namespace umbrage {

/// Reads an STL file into a scene, before finish_scene: one mesh for a binary file, one for each solid of a text file,
/// with +z up. Vertices are not joined. Normals are not kept, since they are those of the faces. Colours of facets in
/// binary files are read after VisCAM and SolidView (bit 15 of the attribute: the facet has a colour) and, if the
/// header contains "COLOR=", after Magics (bit 15: the facet has the colour of the header). In text files, a facet that
/// lacks a number is left out, if these are few. Errors: kFile, naming counts or the line; kInterrupted.
Result<Scene> read_stl(const std::filesystem::path& file, Poll* poll = nullptr);

}  // namespace umbrage
