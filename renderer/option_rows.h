// The rows of the table of options, in three parts, and what they share. Internal to renderer/options.cpp.
#pragma once
#include <vector>

#include "renderer/options.h"

namespace umbrage {

/// The options of the model, the camera and the technique.
std::vector<Option> scene_options();

/// The options of the picture, its light, the device and the files.
std::vector<Option> picture_options();

/// The options of a G-buffer.
std::vector<Option> gbuffer_options();

inline constexpr double kAnyAngle = 36000.0;  // degrees
inline constexpr unsigned kSceneCommands = kRender | kCompare | kTune;

/// Access a field of a request, of its camera and of its G-buffer.
template <auto member>
auto& in(Request& request) {
  return request.*member;
}
template <auto member>
auto& in_camera(Request& request) {
  return request.camera.*member;
}
template <auto member>
auto& in_gbuffer(Request& request) {
  return request.gbuffer.*member;
}

/// Returns an option; the functions after it add what its values can be.
inline Option row(std::string_view group, unsigned commands, std::string_view field, std::string_view option,
                  std::string_view help, std::string_view initial, OptionField where) {
  return {.field = field,
          .option = option,
          .group = group,
          .help = help,
          .initial = initial,
          .where = where,
          .commands = commands};
}
inline Option with_range(Option option, double min, double max, std::string_view unit = {}) {
  option.min = min;
  option.max = max;
  option.unit = unit;
  return option;
}

inline Option with_choices(Option option, std::vector<std::string_view> choices) {
  option.choices = std::move(choices);
  return option;
}

inline Option with_form(Option option, OptionForm form, std::string_view unit = {}) {
  option.form = form;
  option.unit = unit;
  return option;
}

/// Returns the names of a list of values.
template <class Entries>
std::vector<std::string_view> names_of(const Entries& entries) {
  std::vector<std::string_view> names;
  for (const auto& entry : entries) names.push_back(entry.name);
  return names;
}

}  // namespace umbrage
