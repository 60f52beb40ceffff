#include "renderer/lines.h"

#include <tbb/task_arena.h>

#include <algorithm>

#include "core/srgb.h"
#include "devices/shared/dispatches.h"
#include "devices/shared/host_steps.h"
#include "effects/effects.h"
#include "effects/outline/outline_draw.h"

namespace umbrage {
namespace {

/// Returns the dispatch of `outline` that runs on the host: it traces and draws the lines.
const Dispatch& tracing_dispatch() {
  const auto& dispatches = find_effect("outline")->dispatches;
  return *std::find_if(dispatches.begin(), dispatches.end(),
                       [](const Dispatch& dispatch) { return dispatch.host != nullptr; });
}

/// Returns whether a part of the line may be visible in a picture of width x height pixels.
bool is_inside(const Line& line, int width, int height) {
  if (line.points.empty()) return false;
  float left = line.points[0].x, right = left, top = line.points[0].y, bottom = top;
  for (const LinePoint& p : line.points) {
    const float reach = 0.5f * std::max(p.width, 1.0f);
    left = std::min(left, p.x - reach), right = std::max(right, p.x + reach);
    top = std::min(top, p.y - reach), bottom = std::max(bottom, p.y + reach);
  }
  return left < float(width) && right > 0.0f && top < float(height) && bottom > 0.0f;
}

}  // namespace

Result<ParameterBytes> line_parameters(std::string_view subject, std::span<const std::string_view> effects,
                                       const EffectSettings& settings) {
  if (std::find(effects.begin(), effects.end(), "outline") == effects.end())
    return usage_error("{} no lines: the looks cartoon and technical and the effect outline do", subject);
  const ParameterBytes& params = params_of(settings, "outline");
  const auto& outline = as<OutlineParams>(params);
  if (outline.mode == kOutlinePaper)
    return usage_error("lines of outline.mode=paper are pixels, not curves: outline.mode=robust has curves");
  if (!(outline.opacity > 0.0f)) return usage_error("outline.opacity=0 draws no lines: set it above 0");
  return params;
}

Result<ParameterBytes> line_parameters(const Recipe& recipe) {
  const std::string subject =
      recipe.effects_look ? "the requested effects draw" : fmt::format("the look '{}' draws", recipe.look->name);
  return line_parameters(subject, recipe.look->effects, recipe.settings);
}

std::span<const std::string_view> edge_planes() { return tracing_dispatch().inputs; }

Lines traced_lines(const PictureInfo& info, const Image& planes, const ParameterBytes& outline_params, int threads) {
  OutlineConstants constants{};
  find_effect("outline")->constants(outline_params, info, &constants);
  std::vector<const Plane*> in_table_order;
  for (const std::string_view name : edge_planes()) in_table_order.push_back(&planes.plane(name));
  const std::vector<HostPlane> inputs = host_inputs(tracing_dispatch(), in_table_order);
  const HostFrame frame{info, frame_constants(info, inputs[0].stride, 0), &constants, inputs, {}};
  Lines lines;
  tbb::task_arena arena(std::max(threads, 1));
  arena.execute([&] { lines = trace_lines(frame, constants); });
  lines.width = info.inner_width();
  lines.height = info.inner_height();
  for (Line& line : lines.lines)
    for (LinePoint& p : line.points) p.x -= float(info.guard), p.y -= float(info.guard);
  std::erase_if(lines.lines, [&](const Line& line) { return !is_inside(line, lines.width, lines.height); });
  return lines;
}

Result<Lines> traced_lines(Device& device, const Frame& frame, const ParameterBytes& outline_params) {
  Frame whole_frame = frame;
  whole_frame.info.guard = 0;  // so that download returns the guard band, too
  const auto planes = device.download(whole_frame, {edge_planes().begin(), edge_planes().end()});
  if (!planes) return planes.error();
  return traced_lines(frame.info, *planes, outline_params, device.threads());
}

std::array<float, 3> line_color(const ParameterBytes& outline_params) {
  const auto& outline = as<OutlineParams>(outline_params);
  return {srgb_from_linear(outline.r), srgb_from_linear(outline.g), srgb_from_linear(outline.b)};
}

float line_opacity(const ParameterBytes& outline_params) { return as<OutlineParams>(outline_params).opacity; }

}  // namespace umbrage
