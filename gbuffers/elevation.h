// Elevation models without a name or tags: recognised by their values, with a cell size for those that state none.
#pragma once
#include <string>
#include <vector>

#include "gbuffers/depth_values.h"

namespace umbrage {

/// What the values of a single-channel layer say of elevation.
struct ElevationSigns {
  std::vector<double> no_data;  ///< values by which elevation models mark cells without data, beside other values
  bool has_both_signs = false;  ///< many different values on either side of 0: depths have one sign
  bool any() const { return has_both_signs || !no_data.empty(); }
  /// Returns the reason as messages give it: "by values below zero and nodata -9999".
  std::string reason() const;
};

/// `samples`: with depth in one channel.
ElevationSigns elevation_signs(const Samples& samples);

/// Returns a cell size, in units of elevation, that gives the model slopes as those of hills; 1 if it is flat. `reach`:
/// distance of the taps, pixels.
double assumed_cell_size(const DepthValues& elevations, int reach);

}  // namespace umbrage
