// Images that another program has drawn become a G-buffer.
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

/// Ids as the caller has them, by the name of their plane, which holds places in the list.
using SharedIds = std::map<std::string, std::vector<std::uint32_t>, std::less<>>;

struct SharedGBuffer {
  GBuffer gbuffer;
  SharedIds ids;
  long copied = 0;  ///< planes; the others are views of the images, which must outlive them
};

/// The images, in our conventions, of a request that make_shading_recipe has found good. Errors: kUsage.
Result<SharedGBuffer> gbuffer_of(const Request& request, std::span<const NamedImage> images);

/// The error for an image that no effect reads.
Error unknown_image(const std::string& name);

/// Whether a pass holds ids.
bool is_id(std::string_view pass);

/// The caller's id for a place in the list of those that there are; 0 where there is no surface.
std::uint32_t callers_id(std::span<const std::uint32_t> known, float place);

}  // namespace umbrage
