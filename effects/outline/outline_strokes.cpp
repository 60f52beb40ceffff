// The share of each pixel that lines cover, in mode `robust`.
#include <tbb/parallel_for.h>

#include <algorithm>

#include "effects/outline/outline.h"
#include "machine/host_frame.h"

namespace umbrage {

void outline_strokes(const HostFrame& frame) {
  const auto& c = *static_cast<const OutlineConstants*>(frame.constants);
  const int width = frame.frame.width, height = frame.frame.height;
  const HostPlane &object = frame.input("object_id"), &outline = frame.output("outline");
  tbb::parallel_for(0, height, [&](int y) {
    const float *row = object.row(y), *below = object.row(std::min(y + 1, height - 1));
    for (int x = 0; x < width; ++x) {
      const bool edge = row[x] != row[std::min(x + 1, width - 1)] || row[x] != below[x];
      outline.row(y)[x] = edge ? c.opacity : 0.0f;
    }
  });
}

}  // namespace umbrage
