// Values as files store them: integers and floats of 1 to 8 bytes in either byte order.
#pragma once
#include <cstddef>
#include <cstdint>

#include "io/layers.h"

namespace umbrage {

enum class SampleKind { kUnsigned, kSigned, kFloat };

/// How a value is stored.
struct SampleType {
  SampleKind kind = SampleKind::kUnsigned;
  int bytes = 1;            ///< 1, 2, 4 or 8; a float has at least 2
  bool is_swapped = false;  ///< the byte order is not that of the machine
};

/// Returns the type of a channel of such values.
ChannelType channel_type(const SampleType& type);

/// Converts `count` values, which begin `step` bytes apart, to floats.
void to_floats(const SampleType& type, const void* values, std::ptrdiff_t step, int count, float* out);

}  // namespace umbrage
