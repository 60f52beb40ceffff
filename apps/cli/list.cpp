// umbrage list: lists looks, effects, passes, the program of a look, scenes, devices and formats.
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/commands.h"
#include "apps/cli/options.h"
#include "core/suggest.h"
#include "devices/vulkan/vulkan_device.h"
#include "effects/effects.h"
#include "generators/builtin.h"
#include "io/image_file.h"
#include "renderer/devices.h"
#include "renderer/passes.h"

namespace umbrage::cli {
namespace {

struct ListOptions {
  std::string what;
  std::string name;  ///< an effect of `effects`, a look of `passes` and `program`; empty: all effects, the default look
  bool json = false;
};

nlohmann::json list_looks() {
  nlohmann::json records = nlohmann::json::array();
  for (const Look* look : looks())
    records.push_back({{"name", look->name}, {"summary", look->summary}, {"ao", look->occlusion}});
  return records;
}

/// Returns the record of a parameter: what it means, its range and its default, and in `summary` all three as one line.
nlohmann::json parameter_record(const Effect& effect, const Parameter& row, const ParameterBytes& initial) {
  const std::string meaning = with_option_names(row.help), range = parameter_range(row);
  const std::string value = parameter_text(row, initial);
  return {{"name", fmt::format("{}.{}", effect.name, row.name)},
          {"summary", fmt::format("{}: {} [{}]", meaning, range, value)},
          {"meaning", meaning},
          {"range", range},
          {"default", value}};
}

Result<nlohmann::json> list_effects(const std::string& name) {
  nlohmann::json records = nlohmann::json::array();
  std::vector<const Effect*> chosen = effects_with_external();
  if (!name.empty()) {
    const auto effect = require_named<Effect>("effect", chosen, name);
    if (!effect) return effect.error();
    chosen = {*effect};
  }
  for (const Effect* effect : chosen) {
    records.push_back({{"name", effect->name}, {"summary", effect->summary}});
    const ParameterBytes initial = initial_parameters(effect->parameters, effect->params_size);
    for (const Parameter& row : effect->parameters) records.push_back(parameter_record(*effect, row, initial));
  }
  return records;
}

Result<nlohmann::json> list_passes(const std::string& name) {
  const auto look = require_named<Look>("look", looks(), name.empty() ? std::string(kDefaultLook) : name);
  if (!look) return look.error();
  nlohmann::json records = nlohmann::json::array();
  for (const PassEntry& pass : passes_of_look(**look))
    records.push_back({{"name", pass.name}, {"summary", pass.summary}});
  return records;
}

/// Lists the operations of a look's picture.
Result<nlohmann::json> list_program(const std::string& name) {
  const auto look = require_named<Look>("look", looks(), name.empty() ? std::string(kDefaultLook) : name);
  if (!look) return look.error();
  const Request request{.look = std::string((*look)->name)};
  auto recipe = make_recipe_of_look(request);
  if (!recipe) return recipe.error();
  reduce_to_passes(*recipe);
  nlohmann::json records = nlohmann::json::array();
  for (const OperationText& each : described(compile(look_run(*recipe), *layer_count(recipe->capture))))
    records.push_back({{"name", each.name}, {"summary", each.summary}});
  return records;
}

nlohmann::json list_scenes() {
  nlohmann::json records = nlohmann::json::array();
  for (const BuiltinScene& scene : builtin_scenes())
    records.push_back({{"name", fmt::format("scene:{}", scene.name)},
                       {"summary", fmt::format("{} (about {} triangles)", scene.summary, scene.default_triangles)}});
  return records;
}

Result<nlohmann::json> list_devices() {
  auto device = make_device("cpu", 0);
  if (!device) return device.error();
  std::string summary = (*device)->description();
  if (const std::string name = "cpu: "; summary.starts_with(name)) summary.erase(0, name.size());
  nlohmann::json records = nlohmann::json::array({{{"name", "cpu"}, {"summary", summary}}});
  const auto gpus = vulkan_gpus();
  if (!gpus) {
    records.push_back({{"name", "vulkan"}, {"summary", "not available: " + with_option_names(gpus.error().message)}});
    return records;
  }
  for (const VulkanGpu& gpu : *gpus) records.push_back({{"name", gpu.name}, {"summary", gpu.summary}});
  return records;
}

nlohmann::json list_formats() {
  nlohmann::json records = nlohmann::json::array();
  for (const std::string& format : import_formats())
    records.push_back({{"name", "." + format}, {"summary", "model, read"}});
  for (const ImageFormat& format : image_formats())
    records.push_back(
        {{"name", fmt::format(".{}", format.extension)}, {"summary", fmt::format("{}, written", format.summary)}});
  records.push_back({{"name", ".svg"}, {"summary", "lines as curves, written by render"}});
  records.push_back({{"name", ".dxf"}, {"summary", "lines as a CAD drawing (R12), written by render"}});
  return records;
}

Result<void> list(const ListOptions& o) {
  if (!o.name.empty() && o.what != "effects" && o.what != "passes" && o.what != "program")
    return usage_error("'{}' is one argument too many: only the lists effects, passes and program take a name", o.name);
  Result<nlohmann::json> records = nlohmann::json();
  if (o.what == "looks")
    records = list_looks();
  else if (o.what == "effects")
    records = list_effects(o.name);
  else if (o.what == "passes")
    records = list_passes(o.name);
  else if (o.what == "program")
    records = list_program(o.name);
  else if (o.what == "scenes")
    records = list_scenes();
  else if (o.what == "devices")
    records = list_devices();
  else if (o.what == "formats")
    records = list_formats();
  else
    return unknown_name("list", o.what, kListKinds);
  if (!records) return records.error();
  if (o.json) {
    fmt::print("{}\n", records->dump(2));
    return {};
  }
  std::size_t widest = 0;
  for (const auto& record : *records) widest = std::max(widest, record["name"].get<std::string>().size());
  for (const auto& record : *records)
    fmt::print("{:<{}}  {}\n", record["name"].get<std::string>(), widest, record["summary"].get<std::string>());
  return {};
}

}  // namespace

void add_list(CLI::App& app, std::function<Result<void>()>& run) {
  const std::string kinds = joined_by_or(kListKinds);
  CLI::App* command = app.add_subcommand("list", "list " + kinds);
  auto options = std::make_shared<ListOptions>();
  command->add_option("WHAT", options->what, kinds)->required();
  command->add_option("NAME", options->name, "effect whose parameters, or look whose passes or program, are listed");
  command->add_flag("--json", options->json, "print JSON");
  command->callback([options, &run] { run = [options] { return list(*options); }; });
}

}  // namespace umbrage::cli
