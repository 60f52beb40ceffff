// Hints on standard error about a picture that is probably not what the user intends.
#pragma once
#include <string>
#include <vector>

#include "apps/cli/render_options.h"
#include "core/image.h"

namespace umbrage::cli {

/// Statistics of a picture, for hints.
struct HintStatistics {
  long surfaces = 0;  ///< pixels that show a surface
  bool has_ao = false;
  long changed = 0;  ///< surface pixels that occlusion changes visibly; 0 without `ao`

  /// Adds the pixels of a picture or of some of its rows. `ao` may be null.
  void add(const Plane& depth, const Plane* ao);
};

/// Returns the planes that the statistics need: depth, and ao if the user set its radius and the picture has occlusion.
std::vector<std::string> hint_planes(const Recipe& recipe);

/// Prints hints about a picture to standard error.
void print_hints(const Recipe& recipe, const HintStatistics& statistics, const Scene& scene);

}  // namespace umbrage::cli
