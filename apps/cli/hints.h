// Hints on standard error: what is odd about a picture.
#pragma once
#include <string>
#include <vector>

#include "apps/cli/render_options.h"
#include "core/image.h"

namespace umbrage::cli {

/// What is seen in a picture, for hints.
struct Seen {
  long surfaces = 0;  ///< pixels that show one
  bool has_ao = false;
  long changed = 0;  ///< that occlusion changes, where it is known

  void add(const Plane& depth, const Plane* ao);
};

/// The planes that tell it; occlusion only where it is asked for.
std::vector<std::string> seen_planes(const Recipe& recipe);

/// Says on standard error what is odd about a picture.
void print_hints(const Recipe& recipe, const Seen& seen, const Scene& scene);

}  // namespace umbrage::cli
