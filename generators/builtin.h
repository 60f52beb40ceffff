// Built-in scenes, made in code.
#pragma once
#include <span>
#include <string_view>

#include "core/result.h"
#include "scene/scene.h"

namespace umbrage {

/// A scene that needs no file. `make` gets the number of triangles to aim for (a thousand to ten million).
struct BuiltinScene {
  std::string_view name, summary;
  int default_triangles;
  Scene (*make)(int triangles);
};

/// All of them, by name.
std::span<const BuiltinScene> builtin_scenes();

/// Makes `scene:NAME` or `scene:NAME?detail=N`, finished. N is the number of triangles to aim for, 1e3 to 1e7; the
/// result holds between half and twice as many, unless the scene's least is more.
/// Errors: kUsage for an unknown name (with a suggestion) or a bad detail.
Result<Scene> make_builtin_scene(std::string_view uri);

}  // namespace umbrage
