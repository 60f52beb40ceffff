// File names of numbered pictures: turn.png becomes turn_0000.png, turn_0001.png; turn.###.png and turn.%03d.png become
// turn.000.png.
#pragma once
#include <string>
#include <vector>

#include "core/result.h"

namespace umbrage::cli {

struct FrameNames {
  std::string before, after;        ///< text before and after the number
  int digits = 1;                   ///< min number of digits, padded with zeros
  std::string of(int frame) const;  ///< returns the name of a frame's file
  std::string pattern() const;      ///< returns the name with the number as ####
  /// Returns the frames of which a file exists, ascending; none if the number is in the name of a folder. `others`
  /// becomes the names of the files that differ in the number of digits alone; its `digits` are 0 if there are none.
  std::vector<int> existing(FrameNames* others = nullptr) const;
};

/// Returns whether a name has a frame number: ####, %d, %04d, $F or $F4.
bool has_frame_number(const std::string& name);

/// Parses a name with a frame number; without one, _0000 is inserted before the extension. `option`: for errors.
/// Errors: kUsage for a % that is not one of %d, %04d and %%, and for two numbers.
Result<FrameNames> frame_names(const std::string& name, std::string_view option);

}  // namespace umbrage::cli
