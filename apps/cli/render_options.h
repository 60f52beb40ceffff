// What `umbrage render` was told.
#pragma once
#include <string>

#include "apps/cli/options.h"

namespace umbrage::cli {

struct RenderOptions : CommonOptions {
  std::string output, svg, memory = "6G";
  int turntable = 0;  ///< frames; 0: one picture
  double frame_rate = 30.0;
  bool half = false, json = false;

  int bits() const { return text_of("bits") == "16" ? 16 : 8; }
  bool writes_passes() const { return !request.passes.empty(); }
  /// Whether one pass is all that is written, or "all", which stands alone.
  bool writes_only(std::string_view pass) const { return request.passes.size() == 1 && request.passes[0] == pass; }
};

}  // namespace umbrage::cli
