// Passes: the planes of a picture under the words by which people ask for them, `normal` for normal.x, .y and .z.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/recipe.h"

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

/// The channels' letters of a pass: ".x", ".y" and ".z" for `normal`, one empty text for `depth`; nothing for a name
/// that no effect reads or makes.
std::vector<std::string> channels_of(std::string_view pass);
/// Every plane of a first layer that effects read or make, or that a capture has, by name.
const std::vector<std::string>& known_planes();

/// Checks the passes of a request against what the recipe will make, and has traced and averaged what they need. `all`
/// is every pass, and stands alone. Errors: kUsage.
Result<void> take_passes(const Request& request, Recipe& recipe);

/// Checks the passes of a recipe against the planes that a capture for it has of each layer: what only the scene tells
/// of. Errors: kUsage.
Result<void> check_captured(const Recipe& recipe, std::span<const std::string> captured);

/// Leaves out of a recipe what neither its passes nor planes `besides` need, the picture itself with it.
void keep_passes_alone(Recipe& recipe, std::span<const std::string_view> besides = {});

/// The planes of these passes among those of a frame, in the order of the words. Errors: kUsage for one that nothing in
/// the scene makes.
Result<std::vector<PassPlanes>> chosen_planes(const std::vector<std::string>& words,
                                              std::span<const std::string> planes, const PictureInfo& info);

}  // namespace umbrage
