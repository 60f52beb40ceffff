#include "apps/view/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "apps/view/quality.h"
#include "devices/vulkan/vulkan_device.h"
#include "looks/looks.h"
#include "renderer/devices.h"
#include "renderer/options.h"
#include "renderer/passes.h"

namespace umbrage::view {
namespace {

/// Returns the kind of an option whose values are of type T.
template <class T>
const char* kind_of_type() {
  if constexpr (std::is_same_v<T, bool>) return "flag";
  if constexpr (std::is_same_v<T, int> || std::is_same_v<T, std::optional<int>>) return "integer";
  if constexpr (std::is_same_v<T, float> || std::is_same_v<T, std::optional<float>>) return "number";
  return "text";
}

const char* kind_of(const Option& option) {
  switch (option.form) {
    case OptionForm::kSize:
      return "size";
    case OptionForm::kPercent:
    case OptionForm::kLength:
      return "length";
    case OptionForm::kPosition:
    case OptionForm::kDirection:
      return "vector";
    case OptionForm::kColor:
      return "color";
    case OptionForm::kAngles:
      return "angles";
    case OptionForm::kWords:
      return "words";
    default:
      break;
  }
  if (!words_of(option).empty()) return "choice";
  return std::visit(
      [](const auto& field) -> const char* {
        if constexpr (std::is_same_v<std::decay_t<decltype(field)>, std::monostate>)
          return "text";
        else
          return kind_of_type<std::decay_t<decltype(field(std::declval<Request&>()))>>();
      },
      option.where);
}

nlohmann::json record_of(const Option& option) {
  nlohmann::json record = {{"name", option.option},
                           {"field", option.field},
                           {"group", option.group},
                           {"help", with_option_names(option.help)},
                           {"unit", option.unit},
                           {"initial", with_option_names(option.initial)},
                           {"kind", kind_of(option)},
                           {"min", option.min},
                           {"max", option.max},
                           {"choices", words_of(option)},
                           {"model", (option.commands & kRender) != 0},
                           {"gbuffer", (option.commands & kShade) != 0}};
  if (std::holds_alternative<FieldOf<std::vector<std::string>>>(option.where) && option.form != OptionForm::kWords)
    record["repeated"] = true;
  return record;
}

nlohmann::json option_records() {
  nlohmann::json records = nlohmann::json::array();
  for (const Option& option : options())
    if ((option.commands & (kRender | kShade)) && !option.option.empty()) records.push_back(record_of(option));
  return records;
}

constexpr const char* kParameterKinds[] = {"number", "integer", "flag", "choice", "length"};  // by ParameterType
constexpr const char* kEffectKinds[] = {"occlusion", "filter", "shading", "output"};          // by EffectKind

nlohmann::json effect_records() {
  nlohmann::json records = nlohmann::json::array();
  for (const Effect* effect : effects_with_external()) {
    const ParameterBytes initial = initial_parameters(effect->parameters, effect->params_size);
    nlohmann::json parameters = nlohmann::json::array();
    for (const Parameter& row : effect->parameters) {
      if (row.name == effect->joined_frames) continue;  // the renderer sets it
      parameters.push_back({{"name", row.name},
                            {"set", fmt::format("{}.{}", effect->name, row.name)},
                            {"help", with_option_names(row.help)},
                            {"unit", row.unit},
                            {"initial", parameter_text(row, initial)},
                            {"kind", kParameterKinds[int(row.type)]},
                            {"min", row.min},
                            {"max", row.max},
                            {"zero_means", row.zero_means},
                            {"choices", row.choices}});
    }
    records.push_back({{"name", effect->name},
                       {"summary", effect->summary},
                       {"kind", kEffectKinds[int(effect->kind)]},
                       {"parameters", std::move(parameters)}});
  }
  return records;
}

/// Returns the technique with which a look draws models, by quality; "" is no option.
nlohmann::json techniques_of(const Look& look) {
  nlohmann::json techniques = nlohmann::json::object();
  std::vector<std::string_view> qualities = words_of(option_of("quality"));
  qualities.push_back("");
  Request request;
  request.look = look.name;
  for (const std::string_view quality : qualities) {
    request.quality = quality;
    if (const auto recipe = make_recipe(request)) techniques[std::string(quality)] = recipe->occlusion;
  }
  return techniques;
}

/// Returns the technique with which a look draws models after one change to a request; empty if the change is invalid.
std::string technique_with(const Look& look, const std::function<bool(Request&)>& change) {
  Request request;
  request.look = look.name;
  if (!change(request)) return "";
  const auto recipe = make_recipe(request);
  return recipe ? recipe->occlusion : "";
}

/// Returns the texts of options and of parameters of techniques that change the technique with which a look draws
/// models. For a parameter every text does.
nlohmann::json technique_changes_of(const Look& look) {
  nlohmann::json changes = nlohmann::json::array();
  const std::string own = technique_with(look, [](Request&) { return true; });
  if (own == look.occlusion) return changes;  // the look has no other
  for (const Option& option : options()) {
    if (!(option.commands & kRender) || option.field == "look" || option.field == "occlusion" ||
        option.field == "quality")
      continue;
    for (const std::string_view word : words_of(option)) {
      const std::string technique =
          technique_with(look, [&](Request& request) { return bool(set_option(option, word, request)); });
      if (!technique.empty() && technique != own)
        changes.push_back({{"name", option.option}, {"text", word}, {"technique", technique}});
    }
  }
  for (const Effect* effect : effects_with_external()) {
    if (effect->kind != EffectKind::kOcclusion) continue;
    const ParameterBytes initial = initial_parameters(effect->parameters, effect->params_size);
    for (const Parameter& row : effect->parameters) {
      const std::string name = fmt::format("{}.{}", effect->name, row.name);
      const std::string technique = technique_with(look, [&](Request& request) {
        request.settings = {fmt::format("{}={}", name, parameter_text(row, initial))};
        return true;
      });
      if (!technique.empty() && technique != own) changes.push_back({{"name", name}, {"technique", technique}});
    }
  }
  return changes;
}

nlohmann::json look_records() {
  nlohmann::json records = nlohmann::json::array();
  for (const Look* look : looks()) {
    nlohmann::json passes = nlohmann::json::array();
    for (const PassEntry& pass : passes_of_look(*look))
      passes.push_back({{"name", pass.name}, {"summary", pass.summary}});
    nlohmann::json values = nlohmann::json::object();  // settings that differ from the defaults of effects
    for (const auto preset : look->presets)
      if (const std::size_t equals = preset.find('='); equals != preset.npos)
        values[std::string(preset.substr(0, equals))] = preset.substr(equals + 1);
    records.push_back({{"name", look->name},
                       {"summary", look->summary},
                       {"gbuffer_technique", look->occlusion},
                       {"techniques", techniques_of(*look)},
                       {"technique_changes", technique_changes_of(*look)},
                       {"effects", look->effects},
                       {"presets", std::move(values)},
                       {"passes", std::move(passes)},
                       {"gbuffer", look->needs_beauty}});
  }
  return records;
}

nlohmann::json device_records() {
  nlohmann::json records = nlohmann::json::array();
  if (const auto cpu = make_device("cpu", 0)) {
    const std::string description = (*cpu)->description();
    constexpr std::string_view kPrefix = "cpu: ";
    records.push_back(
        {{"name", "cpu"},
         {"summary", description.starts_with(kPrefix) ? description.substr(kPrefix.size()) : description}});
  }
  if (const auto gpus = vulkan_gpus())
    for (const VulkanGpu& gpu : *gpus)
      if (gpu.usable) records.push_back({{"name", gpu.name}, {"summary", gpu.summary}});
  return records;
}

}  // namespace

nlohmann::json hello_tables() {
  return {{"options", option_records()},
          {"effects", effect_records()},
          {"looks", look_records()},
          {"devices", device_records()}};
}

}  // namespace umbrage::view
