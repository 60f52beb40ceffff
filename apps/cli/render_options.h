// What `umbrage render` was told.
#pragma once
#include <optional>
#include <string>

#include "apps/cli/options.h"

namespace umbrage::cli {

struct RenderOptions : CommonOptions {
  std::string output, svg, turntable, frame_rate = "30", memory = "6G";
  std::optional<std::string> passes;
  int bits = 8;
  bool half = false, json = false;
};

}  // namespace umbrage::cli
