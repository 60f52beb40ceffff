// Packings: how one depth is stored in the bytes of several channels, as by simulators and by web maps.
#pragma once
#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "gbuffers/samples.h"

namespace umbrage {

struct Packing {
  std::string_view name;          ///< of the option
  std::array<double, 4> weights;  ///< of the channels r g b a: the stored depth is their weighted sum and the offset
  double offset = 0.0;
  double max_integer = 0.0;  ///< the max sum; 0: the sum is a real number
  bool is_bits = false;      ///< the sum is the bits of a 32-bit float
  bool is_height = false;    ///< elevation, in metres

  /// Returns the number of channels.
  std::size_t channels() const { return weights[3] != 0.0 ? 4 : 3; }
  /// Returns the stored depth of channels() bytes.
  float decoded(const std::array<float, 4>& bytes) const;
};

/// Returns all packings: those of the option but `none`.
std::span<const Packing> packings();

/// Returns the packing of this name; null for "none".
const Packing* find_packing(std::string_view name);

/// Returns the packings by which the bytes of the sampled depth make a much smoother picture than the highest byte
/// alone, which those of a picture of light do not; empty if there is none.
std::vector<const Packing*> recognised_packings(const Samples& samples);

}  // namespace umbrage
