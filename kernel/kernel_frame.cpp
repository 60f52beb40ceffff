#include "kernel/kernel_frame.h"

#include <mutex>
#include <set>
#include <stdexcept>
#include <string>

namespace umbrage {

float* KernelFrame::plane(std::string_view name) const {
  for (const KernelPlane& plane : planes)
    if (plane.name == name) return plane.data;
  throw std::logic_error("a kernel reads plane '" + std::string(name) + "', which its pass does not list");
}

std::vector<std::string_view> of_all_layers(const std::vector<std::string_view>& planes) {
  static std::set<std::string> names;  // owns the characters of the returned views
  static std::mutex guard;
  const std::lock_guard lock(guard);
  std::vector<std::string_view> all = planes;
  for (int layer = 1; layer < kLayersRead; ++layer)
    for (std::string_view plane : planes)
      all.push_back(*names.insert("layer" + std::to_string(layer) + "." + std::string(plane)).first);
  return all;
}

}  // namespace umbrage
