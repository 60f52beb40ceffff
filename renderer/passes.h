// Passes: the planes of a picture under the words by which people ask for them, `normal` for normal.x, .y and .z.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/job.h"

namespace umbrage {

/// The word for a plane: `normal` for normal.x, `layer1.depth` for itself.
std::string pass_of(std::string_view plane);

/// A word and its planes.
struct PassPlanes {
  std::string name;
  std::vector<std::string> planes;
};

/// Planes by their words, in the order in which each comes first.
std::vector<PassPlanes> grouped_planes(std::span<const std::string> planes);

/// Checks words against what the look will make, before any work. `all` is one, alone. Errors: kUsage.
Result<void> check_passes(const std::vector<std::string>& words, const DrawSettings& draw);

/// Has traced and averaged what is drawn for the sake of these passes alone.
void want_passes(const std::vector<std::string>& words, DrawSettings& draw);

/// The planes of these passes among those of a frame, in the order of the words. Errors: kUsage for one that nothing in
/// the scene makes.
Result<std::vector<PassPlanes>> chosen_planes(const std::vector<std::string>& words,
                                              std::span<const std::string> planes, const PictureInfo& info);

}  // namespace umbrage
