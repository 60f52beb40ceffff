// A scene, or an image of what is around it, between two processes: what umbrage-import hands over to the program that
// started it.
#pragma once
#include <optional>

#include "core/result.h"
#include "scene/environment.h"
#include "scene/scene.h"

namespace umbrage {

/// Writes a scene, or why there is none, to an open file. False where it does not all go in.
bool send_import(int file, const Result<Scene>& imported);

/// Reads what send_import wrote. Nothing where it is not whole, not sound (an index beyond its list), or was written by
/// another version.
std::optional<Result<Scene>> receive_import(int file);

/// The same for an image of what is around a scene.
bool send_panorama(int file, const Result<Panorama>& read);
std::optional<Result<Panorama>> receive_panorama(int file);

}  // namespace umbrage
