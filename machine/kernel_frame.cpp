#include "machine/kernel_frame.h"

#include <cstdio>
#include <cstdlib>

namespace umbrage {

float* KernelFrame::plane(std::string_view name) const {
  for (const KernelPlane& plane : planes)
    if (plane.name == name) return plane.data;
  std::fprintf(stderr, "umbrage: internal error: a kernel reads plane '%.*s', which its pass does not list\n",
               int(name.size()), name.data());
  std::abort();
}

}  // namespace umbrage
