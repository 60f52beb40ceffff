// File names of numbered pictures: turn.png becomes turn_0000.png, turn_0001.png; turn-%03d.png becomes turn-000.png.
#pragma once
#include <string>

#include "core/result.h"

namespace umbrage::cli {

struct FrameNames {
  std::string before, after;        ///< text before and after the number
  int digits = 1;                   ///< min number of digits, padded with zeros
  std::string of(int frame) const;  ///< returns the name of a frame's file
};

/// Parses the value of --output. Errors: kUsage for a % that is not one of %d, %04d and %%, and for two numbers.
Result<FrameNames> frame_names(const std::string& output);

}  // namespace umbrage::cli
