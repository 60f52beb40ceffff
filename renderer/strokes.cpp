#include "renderer/strokes.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/lists.h"
#include "core/srgb.h"
#include "devices/shared/dispatches.h"
#include "effects/effects.h"
#include "effects/hatching/hatching_strokes.h"
#include "effects/hidden/hidden_lines.h"
#include "effects/outline/outline_draw.h"

namespace umbrage {
namespace {

/// Returns the dispatch of an effect that runs on the host: it traces and draws the lines.
const Dispatch& tracing_dispatch(std::string_view effect) {
  const auto& dispatches = find_effect(effect)->dispatches;
  return *std::find_if(dispatches.begin(), dispatches.end(),
                       [](const Dispatch& dispatch) { return dispatch.host != nullptr; });
}

/// Appends the lines of an effect, which `trace` returns from the inputs of its host step, to `strokes`.
template <class Constants>
void append_strokes(std::string_view effect, const PictureInfo& info, const Image& planes, const ParameterBytes& params,
                    int threads, Strokes (*trace)(const HostFrame&, const Constants&), std::vector<Stroke>& strokes) {
  if (params.empty()) return;
  Constants constants{};
  find_effect(effect)->constants(params, info, &constants);
  const Dispatch& dispatch = tracing_dispatch(effect);
  std::vector<const Plane*> in_table_order;
  // Tracing reads neither layers that do not exist nor the plane to which lines are added: any plane serves for them.
  for (const std::string_view name : dispatch.inputs) {
    const Plane* plane = planes.find(name);
    in_table_order.push_back(plane ? plane : &planes.plane(dispatch.inputs[0]));
  }
  const std::vector<HostPlane> inputs = host_inputs(dispatch, in_table_order);
  const HostFrame frame{info, frame_constants(info, inputs[0].stride, 0), &constants, inputs, {}};
  Strokes traced;
  tbb::task_arena arena(std::max(threads, 1));
  arena.execute([&] { traced = trace(frame, constants); });
  std::move(traced.strokes.begin(), traced.strokes.end(), std::back_inserter(strokes));
}

/// Returns whether a part of the line may be visible in a picture of width x height pixels.
bool is_inside(const Stroke& stroke, int width, int height) {
  if (stroke.points.empty()) return false;
  float left = stroke.points[0].x, right = left, top = stroke.points[0].y, bottom = top;
  for (const StrokePoint& p : stroke.points) {
    const float reach = 0.5f * std::max(p.width, 1.0f);
    left = std::min(left, p.x - reach), right = std::max(right, p.x + reach);
    top = std::min(top, p.y - reach), bottom = std::max(bottom, p.y + reach);
  }
  return left < float(width) && right > 0.0f && top < float(height) && bottom > 0.0f;
}

}  // namespace

Result<StrokeParameters> stroke_parameters(std::string_view subject, std::span<const std::string_view> effects,
                                           const EffectSettings& settings) {
  const auto runs = [&](std::string_view effect) {
    return std::find(effects.begin(), effects.end(), effect) != effects.end();
  };
  StrokeParameters params;
  if (runs("hatching")) params.hatching = params_of(settings, "hatching");
  if (runs("hidden") && as<HiddenParams>(params_of(settings, "hidden")).draw)
    params.hidden = params_of(settings, "hidden");
  if (!runs("outline")) {
    if (!params.empty()) return params;
    return usage_error(
        "{} no lines: the looks cartoon, hatching and technical and the effects hatching, hidden and outline do",
        subject);
  }
  const ParameterBytes& outline_params = params_of(settings, "outline");
  const auto& outline = as<OutlineParams>(outline_params);
  if (outline.mode == kOutlinePaper)
    return usage_error("lines of outline.mode=paper are pixels, not curves: outline.mode=robust has curves");
  if (outline.opacity > 0.0f)
    params.outline = outline_params;
  else if (params.empty())
    return usage_error("outline.opacity=0 draws no lines: set it above 0");
  return params;
}

Result<StrokeParameters> stroke_parameters(const Recipe& recipe) {
  const std::string subject =
      recipe.effects_look ? "the requested effects draw" : fmt::format("the look '{}' draws", recipe.look->name);
  return stroke_parameters(subject, recipe.look->effects, recipe.settings);
}

StrokeParameters stroke_parameters_or_none(const Recipe& recipe) {
  auto params = stroke_parameters(recipe);
  return params ? std::move(*params) : StrokeParameters();
}

std::vector<EffectStep> line_steps(const StrokeParameters& params) {
  std::vector<EffectStep> steps;
  const auto add = [&](std::string_view effect, const ParameterBytes& of_effect) {
    if (!of_effect.empty()) steps.push_back({find_effect(effect), of_effect});
  };
  add("outline", params.outline);
  add("hidden", params.hidden);
  add("hatching", params.hatching);
  return steps;
}

std::vector<std::string_view> edge_planes(const StrokeParameters& params, int layers) {
  std::vector<std::string_view> planes;
  const auto add = [&](std::string_view effect) {
    const Dispatch& dispatch = tracing_dispatch(effect);
    for (const std::string_view plane : dispatch.inputs)  // a plane to which lines are added is not traced
      if (layer_of_plane(plane) < layers && !contains(dispatch.outputs, plane) && !contains(planes, plane))
        planes.push_back(plane);
  };
  if (!params.outline.empty()) add("outline");
  if (!params.hidden.empty()) add("hidden");
  if (!params.hatching.empty()) add("hatching");
  return planes;
}

Strokes traced_strokes(const PictureInfo& info, const Image& planes, const StrokeParameters& params, int threads) {
  Strokes strokes{info.inner_width(), info.inner_height(), {}};
  append_strokes("outline", info, planes, params.outline, threads, trace_lines, strokes.strokes);
  append_strokes("hidden", info, planes, params.hidden, threads, hidden_lines, strokes.strokes);
  append_strokes("hatching", info, planes, params.hatching, threads, hatching_lines, strokes.strokes);
  for (Stroke& stroke : strokes.strokes)
    for (StrokePoint& p : stroke.points) p.x -= float(info.guard), p.y -= float(info.guard);
  std::erase_if(strokes.strokes,
                [&](const Stroke& stroke) { return !is_inside(stroke, strokes.width, strokes.height); });
  return strokes;
}

Result<Strokes> traced_strokes(Device& device, const Frame& frame, const StrokeParameters& params) {
  Frame whole_frame = frame;
  whole_frame.info.guard = 0;  // so that download returns the guard band, too
  const auto names = edge_planes(params, int(frame.info.more_layers.size()) + 1);
  const auto planes = device.download(whole_frame, {names.begin(), names.end()});
  if (!planes) return planes.error();
  return traced_strokes(frame.info, *planes, params, device.threads());
}

std::array<float, 3> stroke_color(const StrokeParameters& params) {
  if (params.outline.empty()) return {0.0f, 0.0f, 0.0f};
  const auto& outline = as<OutlineParams>(params.outline);
  return {srgb_from_linear(outline.r), srgb_from_linear(outline.g), srgb_from_linear(outline.b)};
}

float stroke_opacity(const StrokeParameters& params) {
  return params.outline.empty() ? 1.0f : as<OutlineParams>(params.outline).opacity;
}

}  // namespace umbrage
