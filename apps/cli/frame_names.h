// Names of numbered pictures: turn.png becomes turn_0000.png, turn_0001.png; turn-%03d.png becomes turn-000.png.
#pragma once
#include <string>

#include "core/result.h"

namespace umbrage::cli {

struct FrameNames {
  std::string before, after;
  int digits = 1;  ///< at least; filled up with zeros
  std::string of(int frame) const;
};

/// The names that `output` stands for. Errors: kUsage for a % that is neither %d nor %04d nor %%, and for two of them.
Result<FrameNames> frame_names(const std::string& output);

}  // namespace umbrage::cli
