// Passes: groups of planes under the names that users request, such as `normal` for normal.x, .y and .z.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/recipe.h"

namespace umbrage {

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
/// Returns the names of all planes of the first layer that effects read or write or that a capture contains, sorted.
const std::vector<std::string>& known_planes();

/// A pass that users can request, and what it holds.
struct PassEntry {
  std::string name, summary;
};

/// Returns the passes of the first layer that a picture of this look can have, with default settings.
std::vector<PassEntry> passes_of_look(const Look& look);

/// Returns the passes of the preset `beauty` that a picture of this request has: the picture, its parts and the
/// geometry, for compositing. Errors: those of make_recipe.
Result<std::vector<std::string>> beauty_passes(const Request& request);

/// Enables the planes that effects write only on request, `beauty` and its parts, if the request has these passes or a
/// scene-linear picture.
void enable_passes(const Request& request, Recipe& recipe);

/// Checks the passes of a request against the passes that the recipe produces, stores them in the recipe, and enables
/// the shadow rays and averages that they need. `all` selects every pass and must be the only name. Errors: kUsage.
Result<void> apply_passes(const Request& request, Recipe& recipe);

/// Returns whether a needed plane is a mean of samples. Lines that are curves are not: they come from sample 0.
bool averages_something(const Recipe& recipe);

/// Removes everything from a recipe that is needed neither for its passes, or the picture if it has none, nor for the
/// planes `besides`. If it has passes, the picture itself is removed, too. Changes nothing for the pass `all`.
void reduce_to_passes(Recipe& recipe, std::span<const std::string_view> besides = {});

/// Removes everything from a recipe that is not needed for these planes.
void reduce_to_planes(Recipe& recipe, std::vector<std::string> planes);

/// Selects the planes of these passes among those of a frame, in the order of `words`. Errors: kUsage for a pass that
/// nothing in the scene produces.
Result<std::vector<PassPlanes>> chosen_planes(const std::vector<std::string>& words,
                                              std::span<const std::string> planes, const PictureInfo& info);

}  // namespace umbrage
