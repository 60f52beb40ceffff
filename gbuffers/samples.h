// Samples: pixels spread over a picture, each with four neighbours, from which the conventions of a G-buffer are
// recognised.
#pragma once
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "gbuffers/raw_planes.h"

namespace umbrage {

/// The pixels of a sample: itself, and its neighbours at a distance of `reach` pixels.
enum Tap { kCenter, kLeft, kRight, kAbove, kBelow };
inline constexpr int kTaps = 5;

/// The values of a plane: [tap][sample].
using TapValues = std::array<std::vector<float>, kTaps>;

struct Samples {
  int width = 0, height = 0;  ///< of the picture
  int reach = 1;              ///< 0: the picture is too small for neighbours, which then equal the pixel
  std::vector<int> x, y;      ///< of each sample
  std::vector<std::string> names;
  std::vector<TapValues> values;  ///< of each plane

  std::size_t size() const { return x.size(); }
  /// Returns the values of a role's channel; null if there is none.
  const TapValues* find(Role role, std::size_t channel) const;
  /// Returns the values of a role's first three channels, each null if there is none.
  std::array<const TapValues*, 3> find_three(Role role) const;
};

/// Returns rows as RawPlanes::rows does.
using RowsOf = std::function<Result<RawRows>(const Rows&)>;

/// Returns at most about `count` samples on a regular grid. Errors: kFile; those of `rows_of`.
Result<Samples> sample(int width, int height, const RowsOf& rows_of, int reach, int count);
Result<Samples> sample(const RawPlanes& raw, int reach, int count);

}  // namespace umbrage
