// Parses scene:NAME?detail=N and makes the scene.
#include "generators/builtin.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "core/suggest.h"
#include "scene/finish.h"

namespace umbrage {

namespace {

constexpr std::string_view kScheme = "scene:";
constexpr double kMinDetail = 1e3, kMaxDetail = 1e7;

/// Parses the text after detail= as a number, such as 5000 or 1e6. Errors: kUsage for other text or a number out of
/// range.
Result<int> parse_detail(std::string_view uri, std::string_view text) {
  double value = 0.0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc() || end != text.data() + text.size() || !(value >= kMinDetail && value <= kMaxDetail))
    return usage_error("'{}': detail cannot be '{}': it takes a number of triangles from 1000 to 10000000", uri, text);
  return int(std::lround(value));
}

}  // namespace

Result<Scene> make_builtin_scene(std::string_view uri) {
  if (!uri.starts_with(kScheme))
    return usage_error("'{}': the name of a built-in scene has the form scene:NAME or scene:NAME?detail=N", uri);
  const std::string_view rest = uri.substr(kScheme.size());
  const std::size_t mark = rest.find('?');
  const std::string_view name = rest.substr(0, mark);
  const auto scenes = builtin_scenes();
  if (scenes.empty()) return usage_error("'{}': this build of Umbrage has no built-in scenes", uri);
  const auto scene =
      std::find_if(scenes.begin(), scenes.end(), [&](const BuiltinScene& candidate) { return candidate.name == name; });
  if (scene == scenes.end()) {
    std::vector<std::string_view> names;
    for (const BuiltinScene& candidate : scenes) names.push_back(candidate.name);
    return usage_error("'{}': there is no built-in scene '{}'{}", uri, name, suggestion(name, names));
  }
  int triangles = scene->default_triangles;
  if (mark != std::string_view::npos) {
    const std::string_view query = rest.substr(mark + 1);
    const std::size_t equals = query.find('=');
    const std::string_view key = query.substr(0, equals);
    if (key != "detail" || equals == std::string_view::npos)
      return usage_error("'{}': '{}' is not an option of a built-in scene; the only one is detail=N", uri, query);
    const Result<int> detail = parse_detail(uri, query.substr(equals + 1));
    if (!detail) return detail.error();
    triangles = *detail;
  }
  Scene result = scene->make(triangles);
  if (result.name.empty()) result.name = name;
  finish_scene(result);
  return result;
}

}  // namespace umbrage
