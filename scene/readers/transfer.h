// Transfer of a scene or a panorama between two processes: from umbrage-import to the host that started it.
#pragma once
#include <optional>

#include "core/result.h"
#include "scene/environment.h"
#include "scene/scene.h"

namespace umbrage {

/// Writes a scene, or the error in its place, to an open file. Returns false if not all could be written.
bool send_import(int file, const Result<Scene>& imported);

/// Reads what send_import wrote. Returns nothing if the data is incomplete, pixels of a texture are missing, or the
/// data is from another version. Meshes are as the reader made them: complete_import checks their indices and lists.
std::optional<Result<Scene>> receive_import(int file);

/// Do the same for a panorama.
bool send_panorama(int file, const Result<Panorama>& read);
std::optional<Result<Panorama>> receive_panorama(int file);

}  // namespace umbrage
