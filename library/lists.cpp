// Lists of looks, effects, devices, formats and parameters.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#include "devices/vulkan/vulkan_device.h"
#include "generators/builtin.h"
#include "io/image_file.h"
#include "library/job.h"
#include "library/object.h"
#include "library/shared.h"
#include "looks/looks.h"
#include "renderer/passes.h"
#include "renderer/recipe.h"

namespace umbrage {
namespace {

struct Entry {
  std::string name, summary;
};

std::vector<Entry> devices() {
  std::vector<Entry> all = {{"cpu", "kernels in SIMD lanes, rays by Embree"}};
  if (const auto gpus = vulkan_gpus())
    for (const VulkanGpu& gpu : *gpus)
      if (gpu.usable) all.push_back({gpu.name, gpu.summary});
  return all;
}

Result<std::vector<Entry>> entries(int list) {
  std::vector<Entry> all;
  switch (list) {
    case UMB_LIST_LOOKS:
      for (const Look* look : looks()) all.push_back({std::string(look->name), std::string(look->summary)});
      return all;
    case UMB_LIST_EFFECTS:
      for (const Effect* effect : effects()) all.push_back({std::string(effect->name), std::string(effect->summary)});
      return all;
    case UMB_LIST_OCCLUSIONS:
      for (const std::string_view name : occlusion_names(external_effects())) {
        const Effect* effect = find_named<Effect>(effects_with_external(), name);
        all.push_back({std::string(name), effect ? std::string(effect->summary) : "no occlusion"});
      }
      return all;
    case UMB_LIST_DEVICES:
      return devices();
    case UMB_LIST_SCENES:
      for (const BuiltinScene& scene : builtin_scenes())
        all.push_back({fmt::format("scene:{}", scene.name), std::string(scene.summary)});
      return all;
    case UMB_LIST_FILE_FORMATS:
      for (const std::string& format : import_formats()) all.push_back({"." + format, "model, read"});
      for (const ImageFormat& format : image_formats())
        all.push_back({fmt::format(".{}", format.extension), fmt::format("{}, written", format.summary)});
      all.push_back({".svg", "strokes, written"});
      return all;
    default:
      return usage_error("there is no list {}: see UmbList", list);
  }
}

std::string_view type_of(const Option& row) {
  if (!words_of(row).empty()) return "choice";
  if (row.form == OptionForm::kLength) return "length";
  if (row.form == OptionForm::kRotation) return "float9";
  if (row.form == OptionForm::kWindow) return "float4";
  if (row.form == OptionForm::kIntrinsics) return "float4";  // or one number
  if (row.form == OptionForm::kAngles || row.form == OptionForm::kPair) return "float2";
  constexpr std::array<std::string_view, 11> kTypes = {"",       "bool",   "int",   "float",  "int",   "float",
                                                       "string", "string", "float", "float3", "float3"};
  static_assert(std::size(kTypes) == std::variant_size_v<OptionField>);
  return kTypes[row.where.index()];
}

/// Returns the default of a parameter as text: for flags and the size of the picture in the form that the setters
/// accept, for others in words.
std::string initial_of(const Option& row) {
  Request request;
  if (const auto* flag = std::get_if<FieldOf<bool>>(&row.where)) return (*flag)(request) ? "true" : "false";
  const auto* number = std::get_if<FieldOf<int>>(&row.where);
  if (number && (row.initial.empty() || row.form == OptionForm::kSize)) return fmt::format("{}", (*number)(request));
  return std::string(row.initial);
}

std::string joined(const auto& words) {
  std::string text;
  for (const std::string_view word : words) text += (text.empty() ? "" : " ") + std::string(word);
  return text;
}

UmbParameter parameter_of(const Option& row) {
  return {sizeof(UmbParameter),
          interned_text(row.field),
          interned_text(type_of(row)),
          interned_text(row.form == OptionForm::kSize ? "width of the picture" : row.help),
          interned_text(row.unit),
          interned_text(initial_of(row)),
          interned_text(joined(words_of(row))),
          row.min,
          row.max};
}

UmbParameter parameter_of(const Effect& effect, const Parameter& row) {
  constexpr std::array<std::string_view, 5> kTypes = {"float", "int", "bool", "choice", "length"};
  const ParameterBytes initial = initial_parameters(effect.parameters, effect.params_size);
  return {sizeof(UmbParameter),
          interned_text(fmt::format("{}.{}", effect.name, row.name)),
          interned_text(kTypes[std::size_t(row.type)]),
          interned_text(row.help),
          interned_text(row.unit),
          interned_text(row.type == ParameterType::kBool ? (parameter_text(row, initial) == "on" ? "true" : "false")
                                                         : parameter_text(row, initial)),
          interned_text(joined(row.choices)),
          row.min,
          row.max};
}

Result<std::vector<UmbParameter>> parameters_of(const std::string& owner) {
  std::vector<UmbParameter> all;
  if (owner == "render" || owner == "shade" || owner == "scene") {
    for (const Option& row : options())
      if (is_parameter(row, owner)) all.push_back(parameter_of(row));
    return all;
  }
  const Effect* effect = find_named<Effect>(effects_with_external(), owner);
  if (!effect) return usage_error("'{}' has no parameters: it takes render, shade, scene or an effect", owner);
  for (const Parameter& row : effect->parameters) all.push_back(parameter_of(*effect, row));
  return all;
}

}  // namespace
}  // namespace umbrage

using namespace umbrage;  // for the C functions below

UmbError umbGetListEntry(UmbList list, int index, const char** name, const char** summary) {
  bool in_range = false;
  const UmbError code = call_without_object("umbGetListEntry", [&]() -> Result<void> {
    const auto all = entries(list);
    if (!all) return all.error();
    in_range = index >= 0 && std::size_t(index) < all->size();
    if (in_range && name) *name = interned_text((*all)[std::size_t(index)].name);
    if (in_range && summary) *summary = interned_text((*all)[std::size_t(index)].summary);
    return {};
  });
  return code == UMB_ERROR_NONE && !in_range ? UMB_ERROR_USAGE : code;
}

int umbGetPassChannels(const char* pass) {
  int count = 0;
  call_without_object("umbGetPassChannels", [&]() -> Result<void> {
    count = text_of(pass) == "color" ? 4 : int(channels_of(text_of(pass)).size());
    return {};
  });
  return count;
}

UmbError umbGetParameter(const char* owner, int index, UmbParameter* parameter) {
  bool in_range = false;
  const UmbError code = call_without_object("umbGetParameter", [&]() -> Result<void> {
    const auto all = parameters_of(text_of(owner));
    if (!all) return all.error();
    if (!parameter) return usage_error("umbGetParameter: parameter cannot be NULL");
    constexpr std::size_t kFirstSize = offsetof(UmbParameter, max) + sizeof(double);  // size in version 0.1
    if (parameter->size < kFirstSize)
      return usage_error("umbGetParameter: the parameter's size cannot be {}: set it to sizeof(UmbParameter)",
                         parameter->size);
    in_range = index >= 0 && std::size_t(index) < all->size();
    if (in_range) {
      const std::size_t size = parameter->size;
      std::memset(parameter, 0, size);  // clears members that only a newer header has
      std::memcpy(parameter, &(*all)[std::size_t(index)], std::min(size, sizeof(UmbParameter)));
      parameter->size = size;
    }
    return {};
  });
  return code == UMB_ERROR_NONE && !in_range ? UMB_ERROR_USAGE : code;
}
