// What calls hand over by pointer, checked.
#pragma once
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>

#include "core/result.h"
#include "renderer/shared_image.h"
#include "umbrage/umbrage.h"

namespace umbrage {

/// Errors: kUsage for a number that names no type.
Result<PixelType> pixel_type(int type);
/// "32-bit floats".
std::string_view name_of(PixelType type);

/// An image of the caller's; `what` begins the sentence where it cannot be. `data` may be null. Errors: kUsage.
Result<SharedImage> shared_image(std::string_view what, const UmbImage& image);
UmbImage as_umb(const SharedImage& image);

/// Whether the pixels of two images share a byte; with different strides, whether they may.
bool overlap(const SharedImage& a, const SharedImage& b);
/// Whether numbers of one image do.
bool overlaps_itself(const SharedImage& image);

/// The same text, which lives as long as the library: of names, of which there are few.
const char* kept_text(std::string_view text);

inline glm::vec3 unit_or_zero(glm::vec3 v) {
  const float length = glm::length(v);
  return length > 0.0f && length < 1e30f ? v / length : glm::vec3(0.0f);
}

}  // namespace umbrage
