#include "renderer/passes.h"

#include <algorithm>

#include "core/suggest.h"
#include "effects/effects.h"

namespace umbrage {
namespace {

constexpr std::string_view kAll = "all";

/// The layers that a picture must have for a pass, where they are all that it lacks, or 0.
int layers_for(std::string_view pass, std::span<const std::string> names) {
  for (int layer = 1; layer < kMostLayers; ++layer) {
    const std::string start = layer_plane(layer, "");
    if (!pass.starts_with(start)) continue;
    return std::find(names.begin(), names.end(), pass.substr(start.size())) != names.end() ? layer + 1 : 0;
  }
  return 0;
}

/// Of the passes asked for, those that are averaged where the picture is of several frames: light and occlusion, not
/// what a pixel shows.
std::vector<std::string> averaged_passes(const std::vector<std::string>& words) {
  std::vector<std::string> planes;
  for (const std::string& word : words) {
    if (word == "ao" || word == "outline" || word == "cover" || word.starts_with("shadow")) planes.push_back(word);
    if (word == "direct" || word == "ambient" || word == "indirect" || word == "lit")
      for (const char* channel : {".r", ".g", ".b"}) planes.push_back(word + channel);
  }
  return planes;
}

/// The first look that writes a pass of that name, or empty.
std::string_view look_with(std::string_view pass) {
  for (const Look* look : looks())
    for (const std::string_view name : look->effects) {
      const Effect* effect = find_effect(name == "occlusion" ? look->occlusion : name);
      if (!effect) continue;
      for (const Pass& each : effect->passes)
        for (const std::string_view plane : each.outputs)
          if (pass_of(plane) == pass) return look->name;
    }
  return {};
}

}  // namespace

std::string pass_of(std::string_view plane) {
  const bool channel = plane.size() > 2 && plane[plane.size() - 2] == '.';
  return std::string(channel ? plane.substr(0, plane.size() - 2) : plane);
}

std::vector<PassPlanes> grouped_planes(std::span<const std::string> planes) {
  std::vector<PassPlanes> groups;
  for (const std::string& plane : planes) {
    const std::string pass = pass_of(plane);
    auto group = std::find_if(groups.begin(), groups.end(), [&](const PassPlanes& g) { return g.name == pass; });
    if (group == groups.end()) group = groups.insert(groups.end(), {pass, {}});
    group->planes.push_back(plane);
  }
  return groups;
}

Result<void> check_passes(const std::vector<std::string>& words, const DrawSettings& draw) {
  if (words.empty() || (words.size() == 1 && words[0] == kAll)) return {};
  const auto recipe = make_recipe(draw);
  if (!recipe) return recipe.error();
  const auto capture = capture_settings(draw, *recipe->look, kMostShadows, kMostBandPixels);
  if (!capture) return capture.error();
  const int captured_layers = *layer_count(*capture);
  std::vector<std::string> captured = {"depth",     "normal",    "albedo",      "specular",
                                       "shininess", "object_id", "material_id", "emission"};
  for (int light = 0; light < kMostShadows; ++light) captured.push_back(shadow_plane(light));
  std::vector<std::string> names;
  for (int layer = 0; layer < captured_layers; ++layer)
    for (const std::string& name : captured) names.push_back(layer_plane(layer, name));
  const auto all = every_effect();
  for (std::string_view effect : recipe->look->effects) {
    if (effect == "occlusion") effect = recipe->occlusion;
    const auto found = std::find_if(all.begin(), all.end(), [&](const Effect* each) { return each->name == effect; });
    // What the technique and its filters make at reduced resolution stays there but for what is upsampled.
    const bool reduced = found != all.end() && recipe->occlusion_every > 1 &&
                         ((*found)->kind == EffectKind::kOcclusion || (*found)->kind == EffectKind::kFilter);
    if (found != all.end())
      for (const Pass& pass : (*found)->passes) {
        if (pass.needed && !pass.needed(recipe->settings.find((*found)->name)->second)) continue;
        for (std::string_view plane : pass.outputs) {
          if (layer_of_plane(plane) > 0) continue;  // one that was captured, or nobody's
          const std::string group = pass_of(plane);
          if (reduced && group != "ao" && group != "indirect") continue;
          if (std::find(names.begin(), names.end(), group) == names.end()) names.push_back(group);
        }
      }
  }
  if (recipe->occlusion == kNoOcclusion) names.push_back("ao");  // 1 everywhere
  names.emplace_back(kAll);
  for (const std::string& word : words) {
    if (std::find(names.begin(), names.end(), word) == names.end()) {
      const int layers = layers_for(word, captured);
      if (layers > 0 && (draw.extra_views.value_or(0) > 0 || recipe->look->back_sides || recipe->look->extra_views > 0))
        return usage_error("there is no pass '{}': this picture has {} layers, counted from 0", word, captured_layers);
      if (layers > 0)
        return usage_error("there is no pass '{}' with --layers {}: it takes --layers {}", word, captured_layers,
                           layers);
      if (const std::string_view other = look_with(word); !other.empty() && other != recipe->look->name)
        return usage_error("the look '{}' writes no pass '{}': the look {} does", recipe->look->name, word, other);
      // Of further layers only what is misspelt: there are too many to list.
      std::string hint = suggestion(word, names);
      if (!hint.starts_with(" (did")) {
        std::erase_if(names, [](const std::string& name) { return layer_of_plane(name) > 0; });
        hint = suggestion(word, names);
      }
      return usage_error("the look '{}' writes no pass '{}'{}", recipe->look->name, word, hint);
    }
    if (std::count(words.begin(), words.end(), word) > 1) return usage_error("--passes names '{}' twice", word);
  }
  if (words.size() > 1 && std::find(words.begin(), words.end(), kAll) != words.end())
    return usage_error("--passes all stands alone: it names every pass");
  return {};
}

void want_passes(const std::vector<std::string>& words, DrawSettings& draw) {
  for (int light = 0; light < kMostShadows; ++light)
    if (std::any_of(words.begin(), words.end(), [&](const std::string& word) {
          return word == kAll || word == shadow_plane(light) || word.ends_with("." + shadow_plane(light));
        }))
      draw.shadows = light + 1;
  draw.averaged = averaged_passes(words);
}

Result<std::vector<PassPlanes>> chosen_planes(const std::vector<std::string>& words,
                                              std::span<const std::string> planes, const PictureInfo& info) {
  const auto groups = grouped_planes(planes);
  std::vector<PassPlanes> chosen;
  for (const std::string& word : words) {
    if (word == kAll) {
      // Of layers that nobody captured there are but neutral planes.
      for (const PassPlanes& group : groups)
        if (layer_of_plane(group.name) <= int(info.more_layers.size())) chosen.push_back(group);
      continue;
    }
    const auto group = std::find_if(groups.begin(), groups.end(), [&](const PassPlanes& g) { return g.name == word; });
    if (group == groups.end())
      return usage_error("there is no pass '{}' in this picture: nothing in the scene makes it", word);
    chosen.push_back(*group);
  }
  return chosen;
}

}  // namespace umbrage
