// From a document of OpenCASCADE to a scene.
#pragma once
#include <Quantity_Color.hxx>
#include <Standard_Handle.hxx>
#include <TDocStd_Document.hxx>
#include <TopoDS_Face.hxx>
#include <map>

#include "scene/scene.h"

namespace umbrage {

/// Colours of faces without one, by surface_of.
using SurfaceColors = std::map<const void*, Quantity_Color>;

/// Returns what faces with the same surface have in common.
const void* surface_of(const TopoDS_Face& face);

/// Makes triangles of the surfaces of a document and returns them before complete_import. Each place of a part is an
/// object, and each of its colours a mesh. Neighbouring faces have vertices of their own at the same positions: the
/// normals are those of the surfaces, so edges remain sharp, and tangent faces smooth. `picture_px`: see
/// ImportSettings. Throws Standard_Failure.
Scene scene_of_document(const Handle(TDocStd_Document) & document, const SurfaceColors& colors, int picture_px);

}  // namespace umbrage
