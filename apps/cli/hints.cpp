#include "apps/cli/hints.h"

#include <algorithm>
#include <cmath>

#include "apps/cli/commands.h"
#include "effects/effects.h"

namespace umbrage::cli {

void Seen::add(const Plane& depth, const Plane* ao) {
  has_ao = ao != nullptr;
  constexpr float kVisible = 1.0f / 255.0f;  // of an 8-bit picture
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      if (!std::isfinite(depth.at(x, y))) continue;
      ++surfaces;
      changed += ao && std::abs(ao->at(x, y) - 1.0f) > kVisible;
    }
}

std::vector<std::string> seen_planes(const Recipe& recipe) {
  std::vector<std::string> planes = {"depth"};
  if (recipe.radius && recipe.occlusion != kNoOcclusion && recipe.wants("ao")) planes.emplace_back("ao");
  return planes;
}

std::vector<std::string> useless_settings(const RenderOptions& o, const Recipe& recipe, const Scene& scene) {
  std::vector<std::string> sentences;
  const std::string_view look = recipe.look->name;
  const auto runs = [&](std::string_view effect) {
    const auto& effects = recipe.look->effects;
    // What is not computed at reduced resolution now may be with another --quality; upsample is part of that.
    return effect == recipe.occlusion || effect == "upsample" ||
           std::find(effects.begin(), effects.end(), effect) != effects.end();
  };
  const auto techniques = occlusion_names(handed_in());
  for (const std::string& setting : o.request.settings) {
    const std::string effect = setting.substr(0, setting.find('.'));
    // Of a configuration file some settings are for other looks.
    if (runs(effect) || command_line.find(setting) == std::string_view::npos) continue;
    if (std::find(techniques.begin(), techniques.end(), effect) != techniques.end())
      sentences.push_back(fmt::format("--set {} does nothing: the occlusion of this picture is {}; try --ao {}",
                                      setting, recipe.occlusion == kNoOcclusion ? "off" : recipe.occlusion, effect));
    else
      sentences.push_back(fmt::format("--set {} does nothing: the look {} has no {}", setting, look, effect));
  }
  if (recipe.radius && recipe.occlusion == kNoOcclusion)
    sentences.push_back(
        fmt::format("--ao-radius {} does nothing: this picture has no occlusion", o.request.occlusion_radius));
  const bool shines = std::any_of(recipe.look->effects.begin(), recipe.look->effects.end(), [&](std::string_view name) {
    const Effect* effect = find_effect(name);
    return effect && by_scene_lights(*effect, recipe.settings);
  });
  const Hdri& hdri = recipe.hdri;
  if (!hdri.file.empty() && !hdri.skybox && (!shines || !hdri.ambient))
    sentences.push_back(hdri.ambient ? fmt::format("--hdri-file does nothing: the look {} brings its own light", look)
                                     : "--hdri-file does nothing: it is to be neither light nor background");
  if (hdri.file.empty())
    for (const std::string_view option : {"--hdri-rotation", "--hdri-intensity", "--hdri-ambient"})
      if (command_line.find(option) != std::string_view::npos)
        sentences.push_back(fmt::format("{} does nothing: there is no image; try --hdri-file sky:", option));
  if (scene.point_count() == 0) {
    const char* what = !o.request.point_size.empty()       ? "--point-size"
                       : o.request.point_sprites != "auto" ? "--point-sprites"
                                                           : nullptr;
    if (what) sentences.push_back(fmt::format("{} does nothing: '{}' has no points", what, scene.name));
  }
  return sentences;
}

namespace {

/// A sentence where the radius that the user chose leaves hardly any occlusion; else nothing.
std::string radius_hint(const Recipe& recipe, const Seen& seen, float scene_radius) {
  constexpr double kHardlyAny = 1e-3;              // of the pixels that show a surface
  constexpr double kTooSmall = 0.5, kUsual = 5.0;  // percent of the scene's radius
  const auto& length = recipe.radius;
  if (!length || recipe.occlusion == kNoOcclusion || !seen.has_ao) return "";
  const double percent =
      length->relative ? double(length->value) : 100.0 * double(length->value) / double(scene_radius);
  const double pixels = double(seen.surfaces), changed = double(seen.changed);
  if (seen.surfaces == 0 || percent >= kTooSmall || changed > kHardlyAny * pixels) return "";
  return fmt::format(
      "occlusion changes {:.2g} % of the model's pixels: its radius is {:.2g} % of the scene's; try --ao-radius {:g}%",
      100.0 * changed / pixels, percent, kUsual);
}

}  // namespace

void print_hints(const Recipe& recipe, const Seen& seen, const Scene& scene) {
  if (seen.surfaces == 0)
    fmt::print(stderr, "umbrage: warning: nothing of {} is in view; move the camera or leave it to be placed\n",
               scene.name);
  if (const std::string hint = radius_hint(recipe, seen, scene.radius()); !hint.empty())
    fmt::print(stderr, "umbrage: warning: {}\n", hint);
}

}  // namespace umbrage::cli
