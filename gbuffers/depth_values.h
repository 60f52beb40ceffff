// Statistics of stored depths: range, values that mean no surface, resolution.
#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gbuffers/conventions.h"

namespace umbrage {

struct DepthValues {
  std::vector<std::array<double, kTaps>> taps;  ///< of each sample; NaN where there is no surface
  double min = 0.0, max = 0.0;                  ///< of surfaces
  double max_integer = 0.0;                     ///< stored value that means 1; 0: floats
  std::size_t surfaces = 0;                     ///< samples that show one
  double at_low = 0.0, at_high = 0.0;           ///< fractions of the samples at the ends of the integers' range
  bool is_negative = false;                     ///< nearly all values are below 0
  int distinct = 0;                             ///< number of different values, counted up to kManyValues
  static constexpr int kManyValues = 1000;

  bool is_unit() const { return max_integer == 0.0 && min >= 0.0 && max <= 1.0; }
  /// Returns whether integers use the whole range that they have: they are brightnesses rather than lengths.
  bool is_full_range() const {
    constexpr double kEnd = 0.05;  // fraction of the range that may be missing at either end
    return max_integer > 0.0 && min <= kEnd * max_integer && max >= (1.0 - kEnd) * max_integer;
  }
  /// Returns the ends of the range that a relative depth refers to.
  double range_min() const { return max_integer > 0.0 || is_unit() ? 0.0 : min; }
  double range_max() const { return max_integer > 0.0 ? max_integer : is_unit() ? 1.0 : max; }
};

/// Returns whether a stored depth means no surface in any file.
bool is_never_depth(double stored);

/// Collects the stored depths of the samples and recognises their background, which is added to `depth.background`.
/// `faces`: of each sample whether its normal is valid; empty: there are no normals.
DepthValues depth_values(const Samples& samples, const LayeredFile& header, bool may_be_low,
                         const std::vector<char>& faces, DepthConvention& depth);

}  // namespace umbrage
