// Built-in scenes, generated in code.
#pragma once
#include <span>
#include <string_view>

#include "core/result.h"
#include "scene/scene.h"

namespace umbrage {

/// A scene that needs no file. `make` gets the approximate number of triangles (a thousand to ten million).
struct BuiltinScene {
  std::string_view name, summary;
  int default_triangles;
  Scene (*make)(int triangles);
};

/// Returns all built-in scenes, by name.
std::span<const BuiltinScene> builtin_scenes();

/// Makes and finishes the scene `scene:NAME` or `scene:NAME?detail=N`. N is the approximate number of triangles, 1e3 to
/// 1e7; the result has between N / 2 and 2 N, or the min number for the scene if that is larger. Errors: kUsage for an
/// unknown name (with a suggestion) or an invalid detail.
Result<Scene> make_builtin_scene(std::string_view uri);

}  // namespace umbrage
