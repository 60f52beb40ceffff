#include "devices/shared/host_steps.h"

#include <algorithm>

#include "core/check.h"
#include "core/guarded.h"
#include "machine/host_frame.h"

namespace umbrage {

std::vector<Plane> run_host_step(const PassRun& run, std::span<const Plane* const> inputs) {
  fault_point();
  const Pass& pass = run.pass;
  const PictureInfo& info = run.info;
  check_equal(inputs.size(), pass.inputs.size(), pass.name);
  std::vector<HostPlane> in, out;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    check_equal(inputs[k]->width, info.width, pass.inputs[k]);
    check_equal(inputs[k]->height, info.height, pass.inputs[k]);
    // The step does not write to it.
    in.push_back({pass.inputs[k], const_cast<float*>(inputs[k]->data()), inputs[k]->stride});
  }
  std::vector<Plane> outputs;
  int stride = 0;
  for (const std::string_view name : pass.outputs) {
    Plane& plane = outputs.emplace_back(run.is_there(name) ? Plane(info.width, info.height) : Plane());
    out.push_back({name, plane.data(), plane.stride});
    stride = std::max(stride, plane.stride);
  }
  pass.host({info, frame_constants(info, stride, run.round), run.constants.data(), in, out});
  return outputs;
}

}  // namespace umbrage
