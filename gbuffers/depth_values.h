// Statistics of stored depths: range, values that mean no surface, resolution.
#pragma once
#include <array>
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
  /// Many samples are background because they are 0, or 1 or the max integer, of other values between: the ends of the
  /// range of a depth buffer.
  bool has_low_end = false, has_high_end = false;
  int distinct = 0;   ///< number of different values, counted up to kManyValues
  double step = 0.0;  ///< min difference of these
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

/// What stored depths may be, by their name and by options.
struct MayBe {
  bool be_low = false;     ///< values of 0 and below are surfaces, and the min may be the background
  bool be_buffer = false;  ///< a depth buffer, whose background is at the end of its range
  bool be_bytes = false;   ///< a depth buffer of 8 bits, or one that begins near 0, too
};

/// Collects the stored depths of the samples and recognises their background, which is added to `depth.background`.
/// `max_integer`: stored value that means 1; 0: floats. `faces`: of each sample whether its normal is valid; empty:
/// there are no normals.
DepthValues depth_values(const Samples& samples, double max_integer, MayBe may, const std::vector<char>& faces,
                         DepthConvention& depth);

}  // namespace umbrage
