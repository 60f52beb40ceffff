#include "devices/shared/dispatches.h"

#include <algorithm>

#include "core/check.h"
#include "core/guarded.h"

namespace umbrage {

FrameConstants frame_constants(const PictureInfo& info, int stride, int round, PixelSet pixels) {
  const Camera& camera = info.camera;
  return {.width = info.width,
          .height = info.height,
          .stride = stride,
          .orthographic = camera.projection == Projection::kOrthographic ? 1 : 0,
          .round = round,
          .missing = pixels == PixelSet::kMissing ? 1 : 0,
          .ray_scale_x = (camera.right - camera.left) / float(info.width),
          .ray_offset_x = camera.left,
          .ray_scale_y = -(camera.top - camera.bottom) / float(info.height),
          .ray_offset_y = camera.top};
}

std::string DispatchRun::plane(std::string_view name) const { return layer_plane(layer, name); }

bool DispatchRun::has_layer_of(std::string_view output) const {
  return layer_of_plane(output) <= int(info.more_layers.size());
}

Result<RunState> run_dispatches(const Effect& effect, const ParameterBytes& params, const Frame& frame,
                                const EffectRun& settings,
                                const std::function<Result<RunState>(const DispatchRun&)>& run) {
  check_equal(params.size(), effect.params_size, effect.name);
  if (!effect.constants) fail_check(fmt::format("{} does not run on a device", effect.name));
  if (settings.pixels == PixelSet::kMissing && !runs_for_missing(effect, params))
    fail_check(fmt::format("{} does not run for missing pixels", effect.name));
  std::vector<std::byte> constants(effect.constants_size);
  const PictureInfo info = layer_info(frame.info, settings.layer);
  effect.constants(params, info, constants.data());
  std::vector<const Dispatch*> dispatches;
  std::vector<int> round_of;
  for (const auto& [dispatch, round] : dispatches_in_order(effect, params, info, settings.pixels)) {
    dispatches.push_back(dispatch);
    round_of.push_back(round);
  }
  for (std::size_t k = 0; k < dispatches.size(); ++k) {
    auto state = run({effect, *dispatches[k], params, constants, info, settings.layer, round_of[k], settings.pixels,
                      std::span(dispatches).subspan(k + 1)});
    if (!state || !state->finished) return state;
  }
  return RunState();
}

Error missing_plane(const DispatchRun& run, std::string_view plane) {
  return usage_error("{} needs the plane '{}', which this picture does not have", run.effect.name, plane);
}

Error missing_scene(const DispatchRun& run) {
  return usage_error("{} needs the model: it cannot shade a G-buffer", run.effect.name);
}

Result<void> check_capture(const CaptureSettings& settings) {
  check_less(0, settings.layers, "layers of a capture");
  check_less(settings.layers, kMaxLayers + 1, "layers of a capture");
  check_less(-1, settings.guard, "guard band of a capture");
  check_less(-1, settings.extra_views, "extra views of a capture");
  check_less(settings.extra_views, kMaxExtraViews + 1, "extra views of a capture");
  static_assert(kMaxMixedLayers == kLayersRead);
  const auto count = layer_count(settings);
  return count ? Result<void>() : count.error();
}

std::vector<HostPlane> host_inputs(const Dispatch& dispatch, std::span<const Plane* const> planes) {
  check_equal(planes.size(), dispatch.inputs.size(), dispatch.name);
  std::vector<HostPlane> inputs;
  for (std::size_t k = 0; k < planes.size(); ++k)
    inputs.push_back({dispatch.inputs[k], const_cast<float*>(planes[k]->data()), planes[k]->stride});
  return inputs;
}

std::vector<Plane> run_host_step(const DispatchRun& run, std::span<const Plane* const> inputs) {
  fault_point();
  const Dispatch& dispatch = run.dispatch;
  const PictureInfo& info = run.info;
  const std::vector<HostPlane> in = host_inputs(dispatch, inputs);
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    check_equal(inputs[k]->width, info.width, dispatch.inputs[k]);
    check_equal(inputs[k]->height, info.height, dispatch.inputs[k]);
  }
  std::vector<HostPlane> out;
  std::vector<Plane> outputs;
  int stride = 0;
  for (const std::string_view name : dispatch.outputs) {
    Plane& plane = outputs.emplace_back(run.has_layer_of(name) ? Plane(info.width, info.height) : Plane());
    out.push_back({name, plane.data(), plane.stride});
    stride = std::max(stride, plane.stride);
  }
  dispatch.host({info, frame_constants(info, stride, run.round), run.constants.data(), in, out});
  return outputs;
}

}  // namespace umbrage
