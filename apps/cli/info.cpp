// umbrage info: prints the content of a model or an image file and how it was interpreted.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <set>

#include "apps/cli/commands.h"
#include "apps/cli/frame_range.h"
#include "apps/cli/options.h"
#include "apps/cli/shade_frame.h"
#include "apps/cli/standard_input.h"
#include "core/lists.h"
#include "core/lowercase.h"
#include "gbuffers/contact_sheet.h"
#include "gbuffers/gbuffer_file.h"
#include "io/image_file.h"
#include "io/layers.h"
#include "scene/front.h"
#include "scene/readers/content.h"
#include "scene/value_colors.h"

namespace umbrage::cli {
namespace {

struct InfoOptions : CommonOptions {
  bool json = false;
  std::string contact_sheet;
};

/// Returns the number of meshes for which `has` is true.
template <class Has>
int count_meshes(const Scene& scene, Has has) {
  int count = 0;
  for (const Mesh& mesh : scene.meshes) count += has(mesh);
  return count;
}

std::string format_of_model(const std::string& model) {
  if (model.starts_with("scene:")) return "built-in";
  std::string format = format_of_file(model);
  for (char& c : format) c = char(std::toupper(static_cast<unsigned char>(c)));
  return format;
}

/// Returns the maps of a material that are used, each with the name of its image.
std::vector<std::pair<std::string_view, std::string>> maps_of(const Scene& scene, const Material& material) {
  std::vector<std::pair<std::string_view, std::string>> maps;
  const auto add = [&](std::string_view what, int texture) {
    if (texture != kNoTexture) maps.emplace_back(what, scene.textures[std::size_t(texture)].name);
  };
  add("emission", material.emission_texture);
  if (material.roughness >= 0.0f) add("metallic and roughness", material.surface_texture);
  if (material.occlusion_strength > 0.0f) add("occlusion", material.surface_texture);
  add("normal", material.normal_texture);
  return maps;
}

/// A field of values of a scene. Ranges of vectors are those of their lengths.
struct FieldFacts {
  std::string name;
  std::string_view on;  ///< "vertices", "faces" or "points"
  int components = 1;
  std::optional<float> low = {}, high = {};
  std::size_t values = 0, missing = 0;
};

/// Returns the fields of all meshes, by name in the order of their first mesh.
std::vector<FieldFacts> fields_of(const Scene& scene) {
  std::vector<FieldFacts> all;
  for (const Mesh& mesh : scene.meshes)
    for (const Field& field : mesh.fields) {
      auto found =
          std::find_if(all.begin(), all.end(), [&](const FieldFacts& each) { return each.name == field.name; });
      const std::string_view on = field.is_spread ? "faces" : mesh.points ? "points" : "vertices";
      if (found == all.end())
        found = all.insert(all.end(), FieldFacts{.name = field.name, .on = on, .components = field.components});
      for (std::size_t k = 0; k < mesh.positions.size(); k += field.is_spread ? 3 : 1, ++found->values) {
        const float value = value_of(field, k, std::nullopt);
        found->missing += !std::isfinite(value);
        if (!std::isfinite(value)) continue;
        found->low = std::min(found->low.value_or(value), value);
        found->high = std::max(found->high.value_or(value), value);
      }
    }
  return all;
}

nlohmann::json record_of(const Scene& scene, const Material& material) {
  nlohmann::json record = {
      {"what", "material"},
      {"name", material.name},
      {"albedo_r", material.albedo.r},
      {"albedo_g", material.albedo.g},
      {"albedo_b", material.albedo.b},
      {"texture", material.texture == kNoTexture ? "" : scene.textures[std::size_t(material.texture)].name},
      {"cut_out", material.alpha_mask},
      {"blended", material.blended},
      {"opacity", material.opacity},
      {"specular", material.specular_strength},
      {"shininess", material.specular_exponent},
      {"emission", std::max({material.emission.r, material.emission.g, material.emission.b})},
      {"metallic", material.metallic},
      {"roughness", material.roughness},
      {"maps", nlohmann::json::object()},
      {"ignored", material.ignored}};
  for (const auto& [map, image] : maps_of(scene, material)) record["maps"][map] = image;
  return record;
}

nlohmann::json record_of(const Scene& scene, const View& camera, std::size_t index) {
  nlohmann::json record = {{"what", "camera"},
                           {"index", index},
                           {"name", camera.name},
                           {"angle_deg", camera.height > 0.0f ? 0.0f : camera.angle_deg},
                           {"orthographic", camera.height > 0.0f}};
  for (int axis = 0; axis < 3; ++axis) {
    record[fmt::format("eye_{}", "xyz"[axis])] = scene.origin[axis] + camera.eye[axis];
    record[fmt::format("target_{}", "xyz"[axis])] = scene.origin[axis] + camera.target[axis];
  }
  return record;
}

/// Returns the JSON records. Each has a kind, `what` (model, mesh, material, texture, scene, animation, camera,
/// light, field, warning), and the properties of that kind.
nlohmann::json records_of(const Scene& scene, const std::string& format) {
  nlohmann::json records = nlohmann::json::array();
  std::set<int> objects;
  for (const Mesh& mesh : scene.meshes) objects.insert(mesh.object);
  nlohmann::json model = {{"what", "model"},
                          {"name", scene.name},
                          {"format", format},
                          {"triangles", scene.triangle_count()},
                          {"points", scene.point_count()},
                          {"meshes", scene.meshes.size()},
                          {"objects", objects.size()},
                          {"materials", scene.materials.size()},
                          {"textures", scene.textures.size()},
                          {"cameras", scene.cameras.empty() ? scene.views.size() : scene.cameras.size()},
                          {"lights", scene.lights.size()},
                          {"radius", scene.radius()},
                          {"up", axis_text(scene.up)},
                          {"units", units_of(lowercase(format))}};
  for (int axis = 0; axis < 3; ++axis) {
    model[fmt::format("min_{}", "xyz"[axis])] = scene.origin[axis] + scene.bounds_min[axis];
    model[fmt::format("max_{}", "xyz"[axis])] = scene.origin[axis] + scene.bounds_max[axis];
    model[fmt::format("origin_{}", "xyz"[axis])] = scene.origin[axis];
  }
  records.push_back(std::move(model));
  for (const Mesh& mesh : scene.meshes)
    records.push_back({{"what", "mesh"},
                       {"name", mesh.name},
                       {"object", mesh.object},
                       {"material", mesh.material},
                       {"triangles", mesh.indices.size() / 3},
                       {"points", mesh.points ? mesh.positions.size() : 0},
                       {"shape", !mesh.points   ? "triangles"
                                 : mesh.spheres ? "spheres"
                                                : "discs"},
                       {"vertices", mesh.positions.size()},
                       {"texture_coordinates", !mesh.uvs.empty()},
                       {"colors", !mesh.colors.empty()}});
  for (const FieldFacts& field : fields_of(scene))
    records.push_back({{"what", "field"},
                       {"name", field.name},
                       {"on", field.on},
                       {"components", field.components},
                       {"min", field.low ? nlohmann::json(*field.low) : nlohmann::json()},
                       {"max", field.high ? nlohmann::json(*field.high) : nlohmann::json()},
                       {"values", field.values},
                       {"missing", field.missing}});
  for (const Material& material : scene.materials) records.push_back(record_of(scene, material));
  for (const Texture& texture : scene.textures)
    records.push_back(
        {{"what", "texture"}, {"name", texture.name}, {"width", texture.width}, {"height", texture.height}});
  for (std::size_t k = 0; k < scene.scene_names.size(); ++k)
    records.push_back({{"what", "scene"},
                       {"index", k},
                       {"name", scene.scene_names[k]},
                       {"drawn", k == std::size_t(scene.scene_index)}});
  for (std::size_t k = 0; k < scene.animation_names.size(); ++k)
    records.push_back({{"what", "animation"},
                       {"index", k},
                       {"name", scene.animation_names[k]},
                       {"duration_s", scene.animation_durations_s.at(k)}});
  const std::vector<View>& cameras = scene.cameras.empty() ? scene.views : scene.cameras;
  for (std::size_t k = 0; k < cameras.size(); ++k) records.push_back(record_of(scene, cameras[k], k));
  for (const Light& light : scene.lights)
    records.push_back({{"what", "light"},
                       {"kind", light.kind == LightKind::kPoint ? "point" : "directional"},
                       {"color_r", light.color.r},
                       {"color_g", light.color.g},
                       {"color_b", light.color.b},
                       {"shadow", light.casts_shadow}});
  for (const std::string& warning : scene.warnings)
    records.push_back({{"what", "warning"}, {"text", with_option_names(warning)}});
  return records;
}

std::string counted(std::size_t count, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string vector_text(glm::vec3 v) { return fmt::format("{:.4g}, {:.4g}, {:.4g}", v.x, v.y, v.z); }

/// Returns a position of the scene in the coordinates of the file, with digits enough for the size of the scene.
std::string position_text(const Scene& scene, const glm::vec3& position) {
  if (scene.origin == glm::dvec3(0.0)) return vector_text(position);
  constexpr int kDigits = 4, kMaxDecimals = 12;
  const int above = int(std::floor(std::log10(std::max(scene.radius(), 1e-12f))));
  const int decimals = std::clamp(kDigits - 1 - above, 0, kMaxDecimals);
  const glm::dvec3 p = scene.origin + glm::dvec3(position);
  return fmt::format("{:.{}f}, {:.{}f}, {:.{}f}", p.x, decimals, p.y, decimals, p.z, decimals);
}

void print_line(std::string_view name, const std::string& text) { fmt::print("{:<11}{}\n", name, text); }

void print_text(const Scene& scene, const std::string& format) {
  constexpr std::size_t kMaxShown = 24;  // max entries of each kind; --json has all
  const auto print_omitted = [&](std::size_t count) {
    if (count > kMaxShown) fmt::print("  ... and {} more (--json lists all)\n", count - kMaxShown);
  };
  fmt::print("{}: {}, {} in {}\n", scene.name, format, size_text(scene),
             counted(scene.meshes.size(), "mesh", "meshes"));
  print_line("bounds", fmt::format("{} to {}, radius {:.4g}", position_text(scene, scene.bounds_min),
                                   position_text(scene, scene.bounds_max), scene.radius()));
  print_line("up", axis_text(scene.up));
  const std::string units = units_of(lowercase(format));
  print_line("units", units.empty() ? "unknown" : units);
  if (scene.point_count() > 0) {
    const int spheres = count_meshes(scene, [](const Mesh& mesh) { return mesh.spheres; });
    print_line("points", spheres > 0 ? "drawn as spheres" : "drawn as discs");
  }
  if (const int colored = count_meshes(scene, [](const Mesh& mesh) { return !mesh.colors.empty(); }); colored > 0)
    print_line("colours", fmt::format("at the vertices of {}", counted(std::size_t(colored), "mesh", "meshes")));
  const std::vector<FieldFacts> fields = fields_of(scene);
  for (std::size_t k = 0; k < std::min(fields.size(), kMaxShown); ++k) {
    const FieldFacts& field = fields[k];
    std::string text = fmt::format("{}: on {}", field.name, field.on);
    if (field.components > 1) text += fmt::format(", {} components, lengths", field.components);
    if (field.low) text += fmt::format(" {:.6g} to {:.6g}", *field.low, *field.high);
    if (field.missing > 0) text += fmt::format(", {} of {} not finite", field.missing, field.values);
    print_line(k == 0 ? "values" : "", text);
  }
  print_omitted(fields.size());
  for (std::size_t m = 0; m < std::min(scene.materials.size(), kMaxShown); ++m) {
    const Material& material = scene.materials[m];
    std::string text = fmt::format("albedo {}", vector_text(material.albedo));
    if (material.texture != kNoTexture) text += ", " + scene.textures[std::size_t(material.texture)].name;
    if (material.alpha_mask) text += ", cut out";
    if (material.blended)
      text += fmt::format(", blended, opacity {:.3g}, tint {}", material.opacity, vector_text(material.tint));
    if (material.specular_strength > 0.0f)
      text +=
          fmt::format(", highlight {:.3g} of exponent {:.3g}", material.specular_strength, material.specular_exponent);
    if (material.roughness >= 0.0f)
      text += fmt::format(", metallic {:.3g}, roughness {:.3g}", material.metallic, material.roughness);
    for (const auto& [map, image] : maps_of(scene, material)) text += fmt::format(", {} map {}", map, image);
    if (!material.ignored.empty()) text += fmt::format(", not drawn: {}", fmt::join(material.ignored, ", "));
    if (material.emission != glm::vec3(0.0f)) text += fmt::format(", emits {}", vector_text(material.emission));
    print_line(m == 0 ? "materials" : "",
               fmt::format("{}: {}", material.name.empty() ? "(no name)" : material.name, text));
  }
  print_omitted(scene.materials.size());
  for (std::size_t t = 0; t < std::min(scene.textures.size(), kMaxShown); ++t) {
    const Texture& texture = scene.textures[t];
    print_line(t == 0 ? "textures" : "", fmt::format("{}, {} x {}", texture.name, texture.width, texture.height));
  }
  print_omitted(scene.textures.size());
  for (std::size_t k = 0; k < std::min(scene.scene_names.size(), kMaxShown); ++k) {
    const std::string& name = scene.scene_names[k];
    print_line(k == 0 ? "scenes" : "", fmt::format("--scene-index {}{}{}", k, name.empty() ? "" : " (" + name + ")",
                                                   k == std::size_t(scene.scene_index) ? ": this one" : ""));
  }
  print_omitted(scene.scene_names.size());
  for (std::size_t k = 0; k < std::min(scene.animation_names.size(), kMaxShown); ++k) {
    const std::string& name = scene.animation_names[k];
    print_line(k == 0 ? "animations" : "",
               fmt::format("--animation-index {}{}: {:.4g} s", k, name.empty() ? "" : " (" + name + ")",
                           scene.animation_durations_s.at(k)));
  }
  print_omitted(scene.animation_names.size());
  const std::vector<View>& cameras = scene.cameras.empty() ? scene.views : scene.cameras;
  for (std::size_t k = 0; k < std::min(cameras.size(), kMaxShown); ++k) {
    const View& view = cameras[k];
    const std::string lens = view.height > 0.0f ? fmt::format("parallel, {:.4g} high", view.height)
                                                : fmt::format("{:.4g} deg", view.angle_deg);
    print_line(k == 0 ? "cameras" : "",
               fmt::format("--camera-index {}{}: from {} to {}, {}", k, view.name.empty() ? "" : " (" + view.name + ")",
                           position_text(scene, view.eye), position_text(scene, view.target), lens));
  }
  print_omitted(cameras.size());
  print_line("lights",
             scene.lights.empty() ? "none: the lights of the look are used" : fmt::format("{}", scene.lights.size()));
  for (const std::string& warning : scene.warnings) print_line("warning", with_option_names(warning));
}

/// Returns the settings with the command's file in them. Errors: kUsage.
Result<GBufferSettings> settings_of(const CommonOptions& options) {
  GBufferSettings settings = options.request.gbuffer;
  if (options.models.size() > 1)
    return usage_error("info takes one image file, not {}: --depth FILE and others name further ones",
                       options.models.size());
  if (!options.models.empty()) settings.file = options.models[0];
  return settings;
}

/// Returns where a layer is in the contact sheet.
std::string place_text(std::size_t k, int columns) {
  const int at = int(k);
  return fmt::format("row {}, column {}", at / columns + 1, at % columns + 1);
}

/// Returns whether the files of the options are images rather than models, by content or extension.
bool has_image(const CommonOptions& options) {
  const GBufferSettings& g = options.request.gbuffer;
  if (options.models.empty()) return !g.depth_file.empty() || !g.position_file.empty();
  const std::string path = path_of(options.models[0]);
  if (has_image_extension(path)) return true;
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored) && bool(read_header(path));
}

/// Prints layers, facts and warnings as text or JSON, and draws a picture of all layers unless `contact_sheet` is
/// empty. Errors: kUsage; kFile.
Result<void> print_image_info(const CommonOptions& options, bool json, const std::string& contact_sheet) {
  auto settings = settings_of(options);
  if (!settings) return settings.error();
  std::string frame_line, doubt;
  if (is_sequence(*settings)) {
    const auto files = input_files(*settings);
    if (!files) return files.error();
    const auto sequence = plan_sequence({.frames = "", .shard = "", .overwrite = true}, *files, {});
    if (!sequence) return sequence.error();
    frame_line = fmt::format("frame: {} of {}", sequence->all.front(), frames_text(sequence->all));
    doubt = sequence->doubt;
    *settings = settings_of_frame(*settings, sequence->all.front());
  }
  auto facts = describe_gbuffer(*settings);
  if (!facts) return facts.error();
  if (!frame_line.empty()) facts->lines.insert(facts->lines.begin(), frame_line);
  if (!doubt.empty()) facts->warnings.push_back(doubt);
  ContactSheet sheet;
  if (!contact_sheet.empty()) {
    auto drawn_sheet = draw_contact_sheet(*settings);
    if (!drawn_sheet) return drawn_sheet.error();
    sheet = std::move(*drawn_sheet);
    if (auto written = write_image(contact_sheet, sheet.picture); !written) return written;
  }
  if (json) {
    nlohmann::json records = nlohmann::json::array();
    for (const std::string& layer : facts->layers) records.push_back({{"what", "layer"}, {"name", layer}});
    for (const std::string& line : facts->lines) records.push_back({{"what", "fact"}, {"text", line}});
    for (const std::string& warning : facts->warnings)
      records.push_back({{"what", "warning"}, {"text", with_option_names(warning)}});
    for (std::size_t k = 0; k < sheet.layers.size(); ++k)
      records.push_back({{"what", "contact_sheet"},
                         {"name", sheet.layers[k]},
                         {"row", int(k) / sheet.columns + 1},
                         {"column", int(k) % sheet.columns + 1}});
    fmt::print("{}\n", records.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    return {};
  }
  for (const std::string& layer : facts->layers) fmt::print("layer: {}\n", layer);
  for (const std::string& line : facts->lines) fmt::print("{}\n", with_option_names(line));
  for (const std::string& warning : facts->warnings) fmt::print("warning: {}\n", with_option_names(warning));
  for (std::size_t k = 0; k < sheet.layers.size(); ++k)
    fmt::print("contact sheet: {}: {}\n", place_text(k, sheet.columns), sheet.layers[k]);
  return {};
}

Result<void> info(const InfoOptions& o) {
  if (has_image(o)) return print_image_info(o, o.json, o.contact_sheet);
  if (!o.contact_sheet.empty()) return field_error("--contact-sheet", "", "{} is for image files");
  if (o.models.empty()) return usage_error("info needs a MODEL or an image file");
  auto import_with = import_settings(o.request);
  if (!import_with) return import_with.error();
  import_with->field = "";  // all
  const auto scene = load_models(o.models, o.input_format, *import_with);
  if (!scene && scene.error().kind == ErrorKind::kFile && o.models.size() > 1 && !o.json && !contains(o.models, "-")) {
    for (const std::string& model : o.models) {  // each alone
      InfoOptions one = o;
      one.models = {model};
      const auto status = info(one);
      if (!status && status.error().message != scene.error().message) print_line("error", status.error().message);
    }
  }
  if (!scene) return scene.error();
  std::string format;
  for (const std::string& model : o.models) {
    const std::string one = format_of_model(model == "-" ? scene->name : model);
    if (format.find(one) == std::string::npos) format += (format.empty() ? "" : " + ") + one;
  }
  if (o.json)
    fmt::print("{}\n", records_of(*scene, format).dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  else
    print_text(*scene, format);
  return {};
}

}  // namespace

void add_info(CLI::App& app, std::function<Result<void>()>& run) {
  const auto [command, options] = add_model_command(
      app, run, "info", "print the content of a model or image and how it was interpreted", kInfo, info);
  command->get_option("MODEL")->required(false);
  for (const char* group : {"Files", "G-buffer"}) add_group(*command, *options, kInfo, group);
  command->add_flag("--json", options->json, "print JSON");
  command->add_option("--contact-sheet", options->contact_sheet, "PNG file to draw all layers of an image file into")
      ->type_name("FILE");
  add_config_option(*command);
}

}  // namespace umbrage::cli
