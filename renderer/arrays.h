// Arrays that another program has drawn become a G-buffer.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/gbuffer.h"
#include "core/result.h"
#include "umbrage/umbrage.h"

namespace umbrage {

/// Ids as the caller has them, by the name of their plane, which holds places in the list.
using SharedIds = std::map<std::string, std::vector<std::uint32_t>, std::less<>>;

struct SharedGBuffer {
  GBuffer gbuffer;
  SharedIds ids;
};

/// The arrays, in our conventions, of a request that make_recipe has found good. Errors: kUsage.
Result<SharedGBuffer> gbuffer_of(const ShadeRequest& request);

/// Whether a pass holds ids.
bool is_id(std::string_view pass);

/// Gives passes and strokes of a picture the caller's ids.
void give_back_ids(const SharedIds& ids, Picture& picture);

}  // namespace umbrage
