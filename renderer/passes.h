// Passes: groups of planes under the names that users request, such as `normal` for normal.x, .y and .z.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/recipe.h"

namespace umbrage {

/// Returns the pass of a plane: `normal` for normal.x, `layer1.depth` for itself.
std::string pass_of(std::string_view plane);

/// A pass and its planes.
struct PassPlanes {
  std::string name;
  std::vector<std::string> planes;
};

/// Groups planes by pass, in the order of first occurrence.
std::vector<PassPlanes> grouped_planes(std::span<const std::string> planes);

/// Returns the channel suffixes of a pass: ".x", ".y" and ".z" for `normal`, one empty string for `depth`; empty for a
/// name that no effect reads or writes.
std::vector<std::string> channels_of(std::string_view pass);
/// Returns all planes of a first layer that effects read or write or that a capture contains, sorted by name.
const std::vector<std::string>& known_planes();

/// A pass that users can request, and what it holds.
struct PassEntry {
  std::string name, summary;
};

/// Returns the passes of the first layer that a picture of this look can have, with default settings.
std::vector<PassEntry> passes_of_look(const Look& look);

/// Checks the passes of a request against those that the recipe produces, and enables the shadow rays and averages that
/// they need. `all` selects every pass and must be the only name. Errors: kUsage.
Result<void> take_passes(const Request& request, Recipe& recipe);

/// Checks the passes of a recipe against the planes that its capture contains in each layer, which depend on the scene.
/// Errors: kUsage.
Result<void> check_captured(const Recipe& recipe, std::span<const std::string> captured);

/// Removes from a recipe everything that neither its passes nor the planes `besides` need, including the picture.
void keep_only_passes(Recipe& recipe, std::span<const std::string_view> besides = {});

/// Selects the planes of these passes among those of a frame, in the order of `words`. Errors: kUsage for a pass that
/// nothing in the scene produces.
Result<std::vector<PassPlanes>> chosen_planes(const std::vector<std::string>& words,
                                              std::span<const std::string> planes, const PictureInfo& info);

}  // namespace umbrage
