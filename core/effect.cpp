#include "core/effect.h"

#include <algorithm>

#include "core/lists.h"

namespace umbrage {

Dispatch sampling_dispatch(const Kernel& kernel) {
  return {.inputs = {"depth", "normal.x", "normal.y", "normal.z"},
          .outputs = {"ao"},
          .kernel = kernel,
          .tile = kSquareTile,
          .reach = own_row,
          .unbounded_inputs = {"depth"},
          .for_missing = true};
}

std::vector<std::pair<const Dispatch*, int>> dispatches_in_order(const Effect& effect, const ParameterBytes& params,
                                                                 const PictureInfo& info, PixelSet pixels) {
  const bool missing = pixels == PixelSet::kMissing;
  const int rounds = effect.rounds && !missing ? effect.rounds(params, info) : 1;
  std::vector<std::pair<const Dispatch*, int>> ordered;
  for (int round = 0; round < rounds; ++round)
    for (const Dispatch& dispatch : effect.dispatches)
      if (runs(dispatch, params) && !(dispatch.first_round_only && round > 0) &&
          !(dispatch.last_round_only && round + 1 < rounds) && (missing ? dispatch.for_missing : dispatch.for_all))
        ordered.emplace_back(&dispatch, round);
  return ordered;
}

bool uses(const Dispatch& dispatch, std::string_view plane) {
  return contains(dispatch.inputs, plane) || contains(dispatch.outputs, plane);
}

bool writes(const Effect& effect, const ParameterBytes& params, std::string_view plane) {
  return std::any_of(effect.dispatches.begin(), effect.dispatches.end(), [&](const Dispatch& dispatch) {
    return runs(dispatch, params) && contains(dispatch.outputs, plane);
  });
}

bool runs_for_missing(const Effect& effect, const ParameterBytes& params) {
  return std::any_of(effect.dispatches.begin(), effect.dispatches.end(),
                     [&](const Dispatch& dispatch) { return dispatch.for_missing && runs(dispatch, params); });
}

float length_px(const Length& length, float whole_px, const PictureInfo& info) {
  return length.relative ? absolute_length(length, whole_px) : length.value / float(info.reduced);
}

Result<float> radius_in_scene(std::string_view owner, const Length& radius, const PictureInfo& info) {
  const float length = absolute_length(radius, info.scene_radius);
  constexpr float kRounding = 1.0001f;
  const float across = 2.0f * info.scene_radius;
  const std::string written = fmt::format("{:g}{}", radius.value, radius.relative ? "%" : "");
  if (!(length > 0.0f)) return usage_error("{} cannot be '{}': it takes a length above 0", owner, written);
  if (length > across * kRounding)
    return usage_error("{} cannot be '{}': that is larger than the scene, which is {:.3g} across (200%)", owner,
                       written, across);
  return length;
}

bool needs_scene(const Effect& effect) {
  return std::any_of(effect.dispatches.begin(), effect.dispatches.end(),
                     [](const Dispatch& dispatch) { return dispatch.rays != nullptr; });
}

int occluders_read(const Effect& effect, const ParameterBytes& params) {
  return effect.occluders ? effect.occluders(params) : 0;
}

int layers_needed(const Effect& effect, const ParameterBytes& params) {
  return effect.layers ? effect.layers(params) : 1;
}

const Parameter* find_parameter(const Effect& effect, std::string_view name) {
  for (const Parameter& row : effect.parameters)
    if (row.name == name || (!name.empty() && row.former_name == name)) return &row;
  return nullptr;
}

}  // namespace umbrage
