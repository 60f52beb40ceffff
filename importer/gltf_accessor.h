// Accessors of glTF files: arrays of numbers, of any component type, normalised, sparse, or compressed.
#pragma once
#include <cstdint>
#include <vector>

#include "importer/gltf_file.h"

namespace umbrage {

/// Elements of `width` numbers each. Integers of 32 bits are rounded, see read_indices.
struct GltfNumbers {
  std::size_t count = 0;  ///< elements
  int width = 0;          ///< numbers per element: VEC3: 3; MAT4: 16
  std::vector<float> values;

  const float* at(std::size_t i) const { return values.data() + i * std::size_t(width); }
};

/// The number of components of an accessor's type; 0 if it is unknown.
int width_of(const Json& accessor);

/// Reads an accessor whose elements have `min_width` to `max_width` numbers. Normalised integers become fractions.
/// Errors: kFile.
Result<GltfNumbers> read_numbers(GltfFile& file, int accessor, int min_width, int max_width);

/// Reads an accessor of unsigned integers. Errors: kFile.
Result<std::vector<std::uint32_t>> read_indices(GltfFile& file, int accessor);

/// Returns an integer component as a number: of a normalised accessor as a fraction.
float normalized(double integer, int component_type);

}  // namespace umbrage
