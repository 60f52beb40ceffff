#include "renderer/strokes.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/color.h"
#include "core/lists.h"
#include "devices/shared/dispatches.h"
#include "effects/hidden/hidden.h"
#include "effects/outline/outline.h"
#include "kernel/host_frame.h"

namespace umbrage {
namespace {

/// Appends the lines of an effect to `strokes`.
void append_strokes(const EffectStep& lines, const PictureInfo& info, const Image& planes, int threads,
                    std::vector<Stroke>& strokes) {
  Strokes traced;
  run_tracing(lines, info, planes, threads,
              [&](const Dispatch& dispatch, const HostFrame& frame) { traced = dispatch.trace(frame); });
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

/// Returns the object beside the line at its middle that is not its own; its own if there is no other one.
int object_beside(const Stroke& stroke, const Plane& objects) {
  if (stroke.points.size() < 2) return stroke.object;
  const StrokePoint *b = &stroke.points[stroke.points.size() / 2], *a = b - 1;
  const float dx = b->x - a->x, dy = b->y - a->y, length = std::max(std::hypot(dx, dy), 1e-6f);
  for (const float side : {-1.0f, 1.0f}) {
    const float x = 0.5f * (a->x + b->x) - side * dy / length, y = 0.5f * (a->y + b->y) + side * dx / length;
    if (!(x >= 0.0f && x < float(objects.width) && y >= 0.0f && y < float(objects.height))) continue;
    if (const float id = objects.row(int(y))[int(x)]; std::abs(id) < 1e9f && int(id) != stroke.object) return int(id);
  }
  return stroke.object;
}

}  // namespace

const Dispatch& tracing_dispatch(const Effect& effect) {
  return *std::find_if(effect.dispatches.begin(), effect.dispatches.end(),
                       [](const Dispatch& dispatch) { return dispatch.trace != nullptr; });
}

void run_tracing(const EffectStep& lines, const PictureInfo& info, const Image& planes, int threads,
                 const std::function<void(const Dispatch&, const HostFrame&)>& step) {
  std::vector<std::byte> constants(lines.effect->constants_size);
  lines.effect->constants(lines.params, info, constants.data());
  const Dispatch& dispatch = tracing_dispatch(*lines.effect);
  std::vector<const Plane*> in_table_order;
  // Tracing reads neither layers that do not exist nor the plane to which lines are added: any plane serves for them.
  for (const std::string_view name : dispatch.inputs) {
    const Plane* plane = planes.find(name);
    in_table_order.push_back(plane ? plane : &planes.plane(dispatch.inputs[0]));
  }
  const std::vector<HostPlane> inputs = host_inputs(dispatch, in_table_order);
  const HostFrame frame{info, frame_constants(info, inputs[0].stride, 0), constants.data(), inputs, {}};
  tbb::task_arena arena(std::max(threads, 1));
  arena.execute([&] { step(dispatch, frame); });
}

StrokeParameters take_lines(std::span<const Effect* const> effects, EffectSettings& settings) {
  StrokeParameters taken;
  for (const Effect* effect : effects) {
    if (effect->without_lines.empty()) continue;
    EffectSettings alone = settings;
    apply_presets(effect->name, effect->lines_alone, alone);
    ParameterBytes& lines = params_of(alone, effect->name);
    if (!runs(tracing_dispatch(*effect), lines)) continue;
    apply_presets(effect->name, effect->without_lines, settings);
    taken.push_back({effect, std::move(lines)});
  }
  return taken;
}

StrokeParameters take_lines_over_average(const Recipe& recipe, EffectSettings& settings) {
  auto steps = steps_of(look_run(recipe));
  const auto& outline = params_of<OutlineParams>(settings);
  const bool drawn = outline.opacity > 0.0f && contains(steps, &effect_with<OutlineParams>());
  if (drawn && outline.mode == kOutlinePaper) std::erase(steps, &effect_with<HiddenParams>());
  return take_lines(steps, settings);
}

Result<StrokeParameters> stroke_parameters(const Recipe& recipe) {
  EffectSettings settings = recipe.settings;
  std::vector<const Effect*> effects;
  for (const std::string_view name : recipe.look->effects)
    if (const Effect* effect = find_effect(name)) effects.push_back(effect);
  const bool outlines = contains(effects, &effect_with<OutlineParams>());
  if (outlines && params_of<OutlineParams>(settings).mode == kOutlinePaper)
    return usage_error("lines of outline.mode=paper are pixels, not curves: outline.mode=robust has curves");
  if (auto lines = take_lines(effects, settings); !lines.empty()) return lines;
  if (outlines) return usage_error("outline.opacity=0 draws no lines: set it above 0");
  return usage_error(
      "{} no lines: the looks cartoon, hatching and technical and the effects hatching, hidden and outline do",
      recipe.effects_look ? "the requested effects draw" : fmt::format("the look '{}' draws", recipe.look->name));
}

StrokeParameters stroke_parameters_or_none(const Recipe& recipe) {
  auto params = stroke_parameters(recipe);
  return params ? std::move(*params) : StrokeParameters();
}

std::vector<std::string_view> edge_planes(const StrokeParameters& params, int layers) {
  std::vector<std::string_view> planes;
  for (const EffectStep& lines : params) {
    const Dispatch& dispatch = tracing_dispatch(*lines.effect);
    for (const std::string_view plane : dispatch.inputs)  // a plane to which lines are added is not traced
      if (layer_of_plane(plane) < layers && !contains(dispatch.outputs, plane) && !contains(planes, plane))
        planes.push_back(plane);
  }
  return planes;
}

Strokes traced_strokes(const PictureInfo& info, const Image& planes, const StrokeParameters& params, int threads) {
  Strokes strokes{info.inner_width(), info.inner_height(), {}};
  for (const EffectStep& lines : params) append_strokes(lines, info, planes, threads, strokes.strokes);
  const Plane* objects = planes.find("object_id");
  for (Stroke& stroke : strokes.strokes) stroke.beside = objects ? object_beside(stroke, *objects) : stroke.object;
  for (Stroke& stroke : strokes.strokes)
    for (StrokePoint& p : stroke.points) p.x -= float(info.guard), p.y -= float(info.guard);
  std::erase_if(strokes.strokes,
                [&](const Stroke& stroke) { return !is_inside(stroke, strokes.width, strokes.height); });
  return strokes;
}

Result<Strokes> traced_strokes(Device& device, const Frame& frame, const StrokeParameters& params) {
  const auto names = edge_planes(params, int(frame.info.more_layers.size()) + 1);
  const auto planes = device.download_with_guard(frame, {names.begin(), names.end()});
  if (!planes) return planes.error();
  return traced_strokes(frame.info, *planes, params, device.threads());
}

std::array<float, 3> stroke_color(const StrokeParameters& params) {
  const auto* outline = find_params<OutlineParams>(params);
  if (!outline) return {0.0f, 0.0f, 0.0f};
  return {srgb_from_linear(outline->r), srgb_from_linear(outline->g), srgb_from_linear(outline->b)};
}

float stroke_opacity(const StrokeParameters& params) {
  const auto* outline = find_params<OutlineParams>(params);
  return outline ? outline->opacity : 1.0f;
}

}  // namespace umbrage
