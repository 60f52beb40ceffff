// The list of built-in scenes, and the reading of scene:NAME?detail=N.
#include "scene/builtin.h"

#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include "core/suggest.h"
#include "scene/builtin_list.h"
#include "scene/finish.h"

namespace umbrage {

namespace {

constexpr std::string_view kScheme = "scene:";
constexpr double kLeastDetail = 1e3, kMostDetail = 1e7;

constexpr std::array kScenes = {
    BuiltinScene{"atrium", "an open court with two storeys of arches, coloured drapes and plants", 300'000,
                 make_atrium},
    BuiltinScene{"claw", "an armoured creature that reaches for the viewer", 160'000, make_claw},
    BuiltinScene{"pink", "a round pink sprite on a disc of meadow", 150'000, make_pink},
    BuiltinScene{"room", "a furnished living room lit through its window", 120'000, make_room},
    BuiltinScene{"solids", "a still life of simple solids that touch, lean and overlap", 100'000, make_solids},
    BuiltinScene{"tank", "a siege tank on a pad, seen from behind", 160'000, make_tank},
    BuiltinScene{"terrain", "mountains round a lake, a kilometre across", 400'000, make_terrain},
};

/// The number after detail=: an integer or like 1e6, all of the text, within the limits.
Result<int> parse_detail(std::string_view uri, std::string_view text) {
  double value = 0.0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc() || end != text.data() + text.size() || !(value >= kLeastDetail && value <= kMostDetail))
    return usage_error("{}: detail is '{}', but must be a number of triangles from 1000 to 10000000", uri, text);
  return int(std::lround(value));
}

}  // namespace

std::span<const BuiltinScene> builtin_scenes() { return kScenes; }

Result<Scene> make_builtin_scene(std::string_view uri) {
  if (!uri.starts_with(kScheme))
    return usage_error("{}: not a built-in scene; those are written scene:NAME or scene:NAME?detail=N", uri);
  const std::string_view rest = uri.substr(kScheme.size());
  const std::size_t mark = rest.find('?');
  const std::string_view name = rest.substr(0, mark);
  const auto scene =
      std::find_if(kScenes.begin(), kScenes.end(), [&](const BuiltinScene& each) { return each.name == name; });
  if (scene == kScenes.end()) {
    std::vector<std::string_view> names;
    names.reserve(kScenes.size());
    for (const BuiltinScene& each : kScenes) names.push_back(each.name);
    return usage_error("{}: there is no built-in scene '{}'{}", uri, name, suggestion(name, names));
  }
  int triangles = scene->default_triangles;
  if (mark != std::string_view::npos) {
    const std::string_view query = rest.substr(mark + 1);
    const std::size_t equals = query.find('=');
    const std::string_view key = query.substr(0, equals);
    if (key != "detail" || equals == std::string_view::npos)
      return usage_error("{}: '{}' is not an option of a built-in scene; the only one is detail=N", uri, query);
    const Result<int> detail = parse_detail(uri, query.substr(equals + 1));
    if (!detail) return detail.error();
    triangles = *detail;
  }
  Scene made = scene->make(triangles);
  if (made.name.empty()) made.name = name;
  finish_scene(made);
  return made;
}

}  // namespace umbrage
