// Checked conversions of pointers and images that callers pass to the C interface.
#pragma once
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <string_view>

#include "core/camera.h"
#include "core/result.h"
#include "renderer/shared_image.h"
#include "umbrage/umbrage.h"

namespace umbrage {

/// Converts a UmbType. Errors: kUsage for an unknown number.
Result<PixelType> pixel_type(int type);
/// Returns a name for messages, such as "32-bit floats".
std::string_view name_of(PixelType type);

/// Checks that `count` elements can be `stride` bytes apart: that they span no more than a process can address. `what`:
/// the subject of an error message. Errors: kUsage.
Result<void> check_stride(std::string_view what, std::ptrdiff_t stride, std::size_t count);

/// Converts and checks an image of the caller. `what`: the subject of an error message. `data` may be null. Errors:
/// kUsage.
Result<SharedImage> shared_image(std::string_view what, const UmbImage& image);
UmbImage as_umb(const SharedImage& image);

/// Returns whether the pixels of two images share a byte; for images with different strides, whether they may share
/// one.
bool overlap(const SharedImage& a, const SharedImage& b);
/// Returns whether values of one image share a byte.
bool overlaps_itself(const SharedImage& image);

/// Returns a copy of a text that is never freed. Use it only for names, of which there are few.
const char* interned_text(std::string_view text);

/// Returns `v` normalized, or 0 if its length is 0, not finite, or at least 1e30.
inline glm::vec3 unit_or_zero(glm::vec3 v) {
  const float length = glm::length(v);
  return length > 0.0f && length < 1e30f ? v / length : glm::vec3(0.0f);
}

/// Convert between a camera of a scene with this Scene::origin and its form in the C interface, which is in the
/// coordinates of the file. camera_of: errors: kUsage for values that are no camera.
UmbView view_of(const Camera& camera, const glm::dvec3& origin);
Result<Camera> camera_of(const UmbView& view);
/// Returns the view matrix in double precision.
glm::dmat4 matrix_of(const UmbView& view);

}  // namespace umbrage
