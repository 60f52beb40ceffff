#include "devices/shared/host_steps.h"

#include <algorithm>

#include "core/check.h"
#include "core/guarded.h"

namespace umbrage {

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
