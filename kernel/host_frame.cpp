#include "kernel/host_frame.h"

#include <stdexcept>
#include <string>

namespace umbrage {
namespace {

const HostPlane& find(std::span<const HostPlane> planes, std::string_view name) {
  for (const HostPlane& plane : planes)
    if (plane.name == name) return plane;
  throw std::logic_error("a host step uses plane '" + std::string(name) + "', which its pass does not list");
}

}  // namespace

const HostPlane& HostFrame::input(std::string_view name) const { return find(inputs, name); }

const HostPlane& HostFrame::output(std::string_view name) const { return find(outputs, name); }

}  // namespace umbrage
