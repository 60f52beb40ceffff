// Colour maps: colours for the positions 0 to 1 on a scale. viridis, magma, inferno, plasma [Smith and van der Walt
// 2015], cividis [Nuñez et al. 2018], turbo [Mikhailov 2019], coolwarm [Moreland 2009], RdBu and Spectral [Brewer
// 2002].
#pragma once
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace umbrage {

/// Colours at evenly spaced positions, sRGB, 0 to 1, and how they are interpolated between them.
struct ColorMap {
  std::string name;
  std::vector<std::array<float, 3>> colors;  ///< at least two
  bool smooth = false;                       ///< by cubic curves; else linearly

  /// Returns the sRGB colour at a position; positions below 0 and above 1 have the colours of the ends.
  std::array<float, 3> at(float position) const;
};

/// Returns the names of the built-in maps; with "_r" they are reversed.
std::vector<std::string_view> color_map_names();

/// Returns the built-in map of that name, or that of a file with one colour per line: three numbers, from 0 to 1 or
/// from 0 to 255, "#rrggbb" or a name of CSS; columns are separated by commas, semicolons or blanks, and a first line
/// of other words is a heading. Errors: kUsage for an unknown name; kFile, naming the line.
Result<ColorMap> color_map(const std::string& name_or_file);

}  // namespace umbrage
