// Converts images of another program into a G-buffer.
#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/gbuffer.h"
#include "core/result.h"
#include "renderer/request.h"

namespace umbrage {

/// The caller's ids, sorted, by plane name. Each plane holds indices into its list.
using SharedIds = std::map<std::string, std::vector<std::uint32_t>, std::less<>>;

/// A G-buffer that shares the caller's images where possible.
struct SharedGBuffer {
  GBuffer gbuffer;
  SharedIds ids;
  std::vector<std::string> warnings;
  long copied = 0;  ///< number of planes that were copied; the others are views of the images, which must outlive them
};

/// Converts images to a G-buffer in the conventions of the library; make_shading_recipe must have accepted the request.
/// Errors: kUsage.
Result<SharedGBuffer> gbuffer_of(const Request& request, std::span<const NamedImage> images);

/// Returns the error for an image that no effect reads or writes.
Error unknown_image(const std::string& name);

/// Returns whether a pass holds ids.
bool is_id(std::string_view pass);

/// Returns the caller's id at `index` of the sorted list `known`; 0 where there is no surface.
std::uint32_t caller_id(std::span<const std::uint32_t> known, float index);

}  // namespace umbrage
