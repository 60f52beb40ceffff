// From a document of OpenCASCADE to a scene.
#pragma once
#include <Standard_Handle.hxx>
#include <TDocStd_Document.hxx>

#include "scene/scene.h"

namespace umbrage {

/// Makes triangles of the surfaces of a document and returns them before complete_import. Each place of a part is an
/// object, and each of its colours a mesh. Neighbouring faces have vertices of their own at the same positions: the
/// normals are those of the surfaces, so edges remain sharp, and tangent faces smooth. `picture_px`: see
/// ImportSettings. Throws Standard_Failure.
Scene scene_of_document(const Handle(TDocStd_Document) & document, int picture_px);

}  // namespace umbrage
