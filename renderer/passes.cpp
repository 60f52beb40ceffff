#include "renderer/passes.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/check.h"
#include "core/lists.h"
#include "core/suggest.h"
#include "effects/antialias/antialias.h"
#include "effects/composite/composite.h"
#include "effects/outline/outline.h"
#include "effects/output/output.h"
#include "renderer/blend.h"
#include "renderer/marked_samples.h"
#include "renderer/strokes.h"
#include "renderer/written_passes.h"

namespace umbrage {
namespace {

constexpr std::string_view kAll = "all";

/// The picture as scene-linear light, and its parts, which effects write only on request.
constexpr std::string_view kBeauty = "beauty";
constexpr std::string_view kParts[] = {"beauty_direct", "beauty_ambient", "beauty_indirect", "beauty_background"};

/// The preset `beauty`.
constexpr std::string_view kBeautyPasses[] = {"color",
                                              "depth",
                                              "normal",
                                              "albedo",
                                              "ao",
                                              "shadow",
                                              "direct",
                                              "indirect",
                                              "beauty_direct",
                                              "beauty_ambient",
                                              "beauty_indirect",
                                              "beauty_background",
                                              "shadow_catcher",
                                              "object_id",
                                              "material_id"};

bool is_part(std::string_view pass) { return contains(kParts, pass); }

/// Returns whether the values of a look are those of a display, not light: it has no transfer function by itself.
bool has_display_values(const Look& look) {
  const EffectSettings settings = look_settings(look, external_effects());
  return params_of<OutputParams>(settings).transfer == kTransferNone;
}

/// Returns the number of layers that a picture needs to have a pass of a layer above 0, if `names` contains the pass's
/// name on the first layer; else 0.
int layers_for(std::string_view pass, std::span<const std::string> names) {
  for (int layer = 1; layer < kMaxLayers; ++layer) {
    const std::string start = layer_plane(layer, "");
    if (!pass.starts_with(start)) continue;
    return contains(names, pass.substr(start.size())) ? layer + 1 : 0;
  }
  return 0;
}

/// Returns the planes that are averaged if the picture averages samples: light and occlusion, not surface properties.
std::vector<std::string> averaged_passes(const std::vector<std::string>& words) {
  std::vector<std::string> planes;
  for (const std::string& word : words) {
    if (word == "ao" || word == "outline" || word == "shadow_catcher" || is_shadow_plane(word)) planes.push_back(word);
    if (word == "direct" || word == "ambient" || word == "indirect" || word == "lit" || is_part(word))
      for (const char* channel : {".r", ".g", ".b"}) planes.push_back(word + channel);
  }
  return planes;
}

}  // namespace

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

const std::vector<std::string>& known_planes() {
  static const std::vector<std::string> all = [] {
    std::set<std::string> names = {"specular",    "shininess", "metallic",   "roughness",
                                   "material_ao", "object_id", "material_id"};
    for (const char* color : {"albedo", "emission"})
      for (const char* channel : {".r", ".g", ".b"}) names.insert(std::string(color) + channel);
    for (const char* channel : {".x", ".y", ".z"}) names.insert(std::string("normal") + channel);
    for (int light = 0; light < kMaxShadows; ++light) names.insert(shadow_plane(light));
    for (const Effect* effect : effects_with_external())
      for (const Dispatch& dispatch : effect->dispatches)
        for (const auto& planes : {dispatch.inputs, dispatch.outputs})
          for (const std::string_view plane : planes) names.emplace(name_on_first_layer(plane));
    return std::vector<std::string>(names.begin(), names.end());
  }();
  return all;
}

std::vector<std::string> channels_of(std::string_view pass) {
  std::vector<std::string> channels;
  const std::string_view name = name_on_first_layer(pass);
  for (const char* channel : {"", ".x", ".y", ".z", ".r", ".g", ".b", ".a"})
    if (std::binary_search(known_planes().begin(), known_planes().end(), std::string(name) + channel))
      channels.emplace_back(channel);
  return channels;
}

namespace {

/// Returns the passes that a capture may contain in one layer.
std::vector<std::string> captured_passes() {
  std::vector<std::string> captured = {"depth",     "normal",      "albedo",    "specular",    "shininess", "metallic",
                                       "roughness", "material_ao", "object_id", "material_id", "emission"};
  for (int light = 0; light < kMaxShadows; ++light) captured.push_back(shadow_plane(light));
  return captured;
}

/// Returns the passes of a picture of this recipe.
std::vector<std::string> passes_of(const Recipe& recipe) {
  std::vector<std::string> names;
  for (int layer = 0; layer < *layer_count(recipe.capture); ++layer)
    for (const std::string& name : captured_passes()) names.push_back(layer_plane(layer, name));
  const auto steps = steps_of(look_run(recipe));
  const bool has_parts = contains(steps, &effect_with<CompositeParams>()) && !has_display_values(*recipe.look);
  for (const Effect* effect : steps) {
    // Planes that the technique and its filters write at reduced resolution are unavailable, except the upsampled ones.
    const bool reduced = recipe.occlusion_downsampling > 1 &&
                         (effect->kind == EffectKind::kOcclusion || effect->kind == EffectKind::kFilter);
    for (const Dispatch& dispatch : effect->dispatches) {
      const bool is_run = runs(dispatch, params_of(recipe.settings, effect->name));
      for (std::string_view plane : dispatch.outputs) {
        if (layer_of_plane(plane) > 0) continue;  // a captured layer, or one that does not exist
        const std::string group = pass_of(plane);
        if (!is_run && group != kBeauty && !(is_part(group) && has_parts)) continue;
        if (reduced && group != "ao" && group != "indirect") continue;
        if (!contains(names, group)) names.push_back(group);
      }
    }
  }
  // Without occlusion it is 1 everywhere.
  if (!contains(names, "ao") && recipe.occlusion == kNoOcclusion) names.push_back("ao");
  names.emplace_back(kAll);
  return names;
}

constexpr std::pair<std::string_view, std::string_view> kSummaries[] = {
    {"depth", "distance along the view axis, scene units; infinity where there is no surface"},
    {"normal", "unit normal in view space: +x right, +y up, +z towards the camera"},
    {"albedo", "diffuse reflectance, linear"},
    {"specular", "specular reflectance"},
    {"shininess", "exponent of the highlight"},
    {"metallic", "metalness: 0 dielectric, 1 metal; only if a material has a roughness"},
    {"roughness", "roughness of glTF, 0 to 1; below 0 where a material has none; only if a material has one"},
    {"material_ao", "fraction of ambient light by the occlusion map; only if a material has one"},
    {"object_id", "index of the object"},
    {"material_id", "index of the material"},
    {"emission", "emitted light, linear; only if a material emits light"},
    {"shadow", "fraction of the key light that arrives"},
    {"direct", "light that arrives from the lights and is reflected, linear"},
    {"ambient", "reflected ambient light without occlusion, linear"},
    {"open_light", "brightness of a white surface that no occluder shadows"},
    {"ao", "ambient visibility: 1 is open, 0 is occluded"},
    {"indirect", "light reflected by nearby surfaces, linear"},
    {"lit", "light before exposure and transfer function, linear"},
    {"shadow_catcher", "opacity of the shadow on the unseen ground, over what is behind it"},
    {"outline", "opacity of the lines"},
    {"line", "color of the lines, linear"},
    {"toon_key", "light of the key light, smoothed along surfaces, before it is quantized to tone steps"},
    {"color", "the finished picture; in .exr scene-linear, premultiplied: R, G, B, A"},
    {"beauty_direct", "light of the lights in the finished picture, exposed, linear"},
    {"beauty_ambient", "ambient light in the finished picture, exposed, linear"},
    {"beauty_indirect", "light of nearby surfaces in the finished picture, exposed, linear"},
    {"beauty_background", "light of the background in the finished picture, and the change by lines, linear"},
    {"beauty", "for compositing: the picture, its parts, geometry and ids; needs .exr"},
};

/// Returns what a pass holds; empty for planes that only effects read, which lists leave out.
std::string summary_of(std::string_view pass) {
  for (const auto& [name, summary] : kSummaries)
    if (name == pass) return std::string(summary);
  if (is_shadow_plane(pass)) return fmt::format("the same for the light with index {}", pass.substr(6));
  return pass == kAll ? "every pass; the only name" : "";
}

/// Returns the name of the first look whose pictures of a model have the pass; empty if none does.
std::string_view look_with_pass(std::string_view pass) {
  for (const Look* look : scene_looks())
    if (const auto recipe = make_recipe({.look = std::string(look->name)});
        recipe && contains(passes_of(*recipe), pass))
      return look->name;
  return {};
}

/// Returns the error for an unknown pass, with its reason.
Error unknown_pass_error(const std::string& word, std::vector<std::string> names, const Request& request,
                         const Recipe& recipe) {
  const Look& look = *recipe.look;
  const int captured_layers = *layer_count(recipe.capture);
  const int layers = layers_for(word, captured_passes());
  if (layers > 0 && (request.extra_views.value_or(0) > 0 || look.back_sides || look.extra_views > 0))
    return usage_error("there is no pass '{}': this picture has {} layers, counted from 0", word, captured_layers);
  if (layers > 0)
    return usage_error("there is no pass '{}' with `layers` {}: it requires `layers` {}", word, captured_layers,
                       layers);
  if (const std::string_view other = look_with_pass(word); !other.empty() && other != look.name)
    return usage_error("the look '{}' writes no pass '{}': the look {} does", look.name, word, other);
  // Passes of further layers are suggested only for a misspelling: the full list would be too long.
  if (nearest_name(word, names).empty())
    std::erase_if(names, [](const std::string& name) { return layer_of_plane(name) > 0 || summary_of(name).empty(); });
  return usage_error("the look '{}' writes no pass '{}'{}", look.name, word, suggestion(word, names));
}

}  // namespace

std::vector<PassEntry> passes_of_look(const Look& look) {
  const Request request{.look = std::string(look.name)};
  const auto recipe = make_recipe_of_look(request);
  if (!recipe) fail_check(recipe.error().message);
  std::vector<PassEntry> entries;
  for (const std::string& name : passes_of(*recipe))
    if (layer_of_plane(name) == 0 && !summary_of(name).empty()) entries.push_back({name, summary_of(name)});
  return entries;
}

Result<std::vector<std::string>> beauty_passes(const Request& request) {
  Request of_look = request;
  of_look.passes.clear();
  const auto recipe = make_recipe(of_look, kMaxStripPixels);
  if (!recipe) return recipe.error();
  const auto available = passes_of(*recipe);
  std::vector<std::string> passes;
  for (const std::string_view pass : kBeautyPasses)
    if (contains(available, pass)) passes.emplace_back(pass);
  return passes;
}

void enable_passes(const Request& request, Recipe& recipe) {
  const auto& words = request.passes;
  recipe.scene_linear = request.values == PictureValues::kSceneLinear;
  auto& output = params_of<OutputParams>(recipe.settings);
  const bool parts = std::any_of(words.begin(), words.end(), is_part);
  const bool wanted = recipe.scene_linear || contains(words, kBeauty) || contains(words, kAll) || parts;
  if (wanted && output.beauty == kBeautyOff)
    output.beauty =
        output.transfer == kTransferNone && has_display_values(*recipe.look) ? kBeautyDisplay : kBeautyLight;
  if (wanted && !parts) params_of<AntialiasParams>(recipe.settings).beauty = 1;
  if (!parts) return;
  output.parts = 1;  // whose sum is `beauty` at every pixel
  params_of<CompositeParams>(recipe.settings).parts = 1;
}

Result<void> apply_passes(const Request& request, Recipe& recipe) {
  const std::vector<std::string>& words = request.passes;
  const bool all = words.size() == 1 && words[0] == kAll;
  recipe.passes = words;
  enable_passes(request, recipe);
  recipe.averaged = averaged_passes(words);
  for (int light = 0; light < kMaxShadows; ++light)
    if (std::any_of(words.begin(), words.end(), [&](const std::string& word) {
          return word == kAll || word == shadow_plane(light) || word.ends_with("." + shadow_plane(light));
        }))
      recipe.capture.shadows = std::max(recipe.capture.shadows, light + 1);
  if (words.empty() || all) return {};
  const std::vector<std::string> names = passes_of(recipe);
  for (const std::string& word : words) {
    if (!contains(names, word)) return with_field(unknown_pass_error(word, names, request, recipe), "passes", word);
    if (std::count(words.begin(), words.end(), word) > 1) return field_error("passes", word, "`{}` names '{}' twice");
  }
  if (words.size() > 1 && contains(words, kAll))
    return field_error("passes", kAll, "`{}` {} must be the only name: it selects every pass");
  return {};
}

bool averages_something(const Recipe& recipe) {
  if (recipe.wants("color.r") || recipe.wants("beauty.r")) return true;
  const bool curves = params_of<OutlineParams>(recipe.settings).mode != kOutlinePaper;
  return std::any_of(recipe.averaged.begin(), recipe.averaged.end(),
                     [&](const std::string& plane) { return plane != "outline" || !curves; });
}

void reduce_to_passes(Recipe& recipe, std::span<const std::string_view> besides) {
  if (!recipe.passes.empty() && recipe.passes[0] == kAll) return;
  std::vector<std::string> planes(besides.begin(), besides.end());
  const std::vector<std::string> picture = {"color"};
  for (const std::string& pass : recipe.passes.empty() ? picture : recipe.passes) {
    const std::string name = pass == "color" ? std::string(recipe.picture()) : pass;
    for (const std::string& channel : channels_of(name)) planes.push_back(name + channel);
    if (is_part(pass)) planes.insert(planes.end(), {"beauty.r", "beauty.g", "beauty.b", "beauty.a"});
  }
  reduce_to_planes(recipe, std::move(planes));
}

namespace {

/// Returns the planes that are read after a recipe's look has run.
std::vector<std::string> planes_read_after(const Recipe& recipe) {
  std::vector<std::string> planes = with_blend_planes(*recipe.wanted);
  planes.emplace_back("depth");
  const auto add = [&](const auto& names) { planes.insert(planes.end(), names.begin(), names.end()); };
  add(recipe.averaged);
  add(background_planes(*recipe.wanted, true));
  // Further samples borrow from the first: see renderer/marked_samples.h.
  if (draws_marked_samples(recipe)) {
    for (const char* plane : {"marks", "resample_depth", "normal.x", "normal.y", "normal.z", "ao", "indirect.r",
                              "indirect.g", "indirect.b"})
      planes.emplace_back(plane);
    for (int light = 0; light < kMaxShadows; ++light) planes.push_back(shadow_plane(light));
  }
  // Lines over an average are drawn last, and may be traced again as curves.
  EffectSettings settings = recipe.settings;
  for (const EffectStep& lines : take_lines_over_average(recipe, settings))
    for (const Dispatch& dispatch : lines.effect->dispatches)
      if (runs(dispatch, lines.params)) add(dispatch.inputs), add(dispatch.outputs);
  return planes;
}

}  // namespace

void reduce_to_planes(Recipe& recipe, std::vector<std::string> planes) {
  recipe.wanted = std::move(planes);
  const auto steps = steps_of(look_run(recipe));
  recipe.kept = planes_read_after(recipe);
  if (!averages_something(recipe)) recipe.frames = 1;  // only sample 0, at the pixel centres
  std::vector<std::string>& captured = recipe.capture.planes.emplace();
  int max_layer = 0, shadows = 0;  // highest layer of a plane; number of lights whose shadows are among them
  for (const std::string& plane : *recipe.wanted) {
    captured.emplace_back(name_on_first_layer(plane));
    max_layer = std::max(max_layer, layer_of_plane(plane));
    for (int light = shadows; light < kMaxShadows; ++light)
      if (captured.back() == shadow_plane(light)) shadows = light + 1;
  }
  // These mark the pixels that get background values.
  for (const std::string& plane : background_planes(*recipe.wanted, recipe.look->ground))
    captured.emplace_back(name_on_first_layer(plane));
  for (const Effect* effect : steps)
    for (const Dispatch& dispatch : effect->dispatches)
      for (const std::string_view plane : dispatch.inputs) captured.emplace_back(name_on_first_layer(plane));
  shadows = std::max(shadows, shadows_read(recipe, steps));
  if (draws_marked_samples(recipe)) {
    // A pass alone is drawn at the same marks as with the whole picture.
    LookRun whole = look_run(recipe);
    whole.wanted.reset();
    for (const std::string& plane : planes_read(compile(whole, 1))) captured.push_back(plane);
    shadows = std::max(shadows, shadows_read(recipe, steps_of(whole)));
  }
  recipe.capture.shadows = std::min(recipe.capture.shadows, shadows);
  if (!steps.empty() || max_layer > 0) return;
  // Nothing reads the other layers.
  recipe.capture.layers = 1;
  recipe.capture.back_sides = false;
  recipe.capture.extra_views = 0;
}

Result<std::vector<PassPlanes>> chosen_planes(const std::vector<std::string>& words,
                                              std::span<const std::string> planes, const PictureInfo& info) {
  const auto groups = grouped_planes(planes);
  std::vector<PassPlanes> chosen;
  for (const std::string& word : words) {
    if (word == kAll) {
      // Layers that were not captured have only uniform planes.
      for (const PassPlanes& group : groups)
        if (layer_of_plane(group.name) <= int(info.more_layers.size())) chosen.push_back(group);
      continue;
    }
    const auto group = std::find_if(groups.begin(), groups.end(), [&](const PassPlanes& g) { return g.name == word; });
    if (group == groups.end())
      return usage_error("there is no pass '{}' in this picture: nothing in the scene produces it", word);
    chosen.push_back(*group);
  }
  return chosen;
}

}  // namespace umbrage
