// Planes of the dispatch `sent`, for effects that run hemisphere_sent.kernel.h.
#pragma once
#include <string_view>
#include <vector>

#include "kernel/kernel_frame.h"

namespace umbrage {

using PlaneNames = std::vector<std::string_view>;

/// Returns the names of both lists.
inline PlaneNames joined(PlaneNames a, const PlaneNames& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// Returns the outputs: the normal and the outgoing light of each pixel, packed.
inline PlaneNames packed_planes() {
  return of_all_layers({"hemisphere_facing", "hemisphere_sum", "hemisphere_shares"});
}

/// Returns the inputs that the first round does not read.
inline PlaneNames sent_later_inputs() {
  return {"albedo.r", "albedo.g", "albedo.b", "indirect.r", "indirect.g", "indirect.b", "ao"};
}

/// Returns all inputs.
inline PlaneNames sent_inputs() {
  return joined(of_all_layers({"normal.x", "normal.y", "normal.z", "direct.r", "direct.g", "direct.b", "ambient.r",
                               "ambient.g", "ambient.b"}),
                sent_later_inputs());
}

/// Returns the planes of occluders that send light: their depth and the packed planes.
inline PlaneNames outgoing_light_planes() {
  return of_all_layers({"depth", "hemisphere_facing", "hemisphere_sum", "hemisphere_shares"});
}

}  // namespace umbrage
