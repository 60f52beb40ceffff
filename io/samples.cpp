#include "io/samples.h"

#include <Imath/half.h>

#include <algorithm>
#include <cstring>

namespace umbrage {
namespace {

template <class Value>
void convert(const unsigned char* from, std::ptrdiff_t step, int count, bool is_swapped, float* out) {
  for (int i = 0; i < count; ++i, from += step) {
    unsigned char bytes[sizeof(Value)];
    std::memcpy(bytes, from, sizeof bytes);
    if (is_swapped) std::reverse(bytes, bytes + sizeof bytes);
    Value value;
    std::memcpy(&value, bytes, sizeof value);
    out[i] = float(value);
  }
}

template <class Byte, class Two, class Four, class Eight>
void convert_any(const SampleType& type, const unsigned char* from, std::ptrdiff_t step, int count, float* out) {
  if (type.bytes == 1) convert<Byte>(from, step, count, false, out);
  if (type.bytes == 2) convert<Two>(from, step, count, type.is_swapped, out);
  if (type.bytes == 4) convert<Four>(from, step, count, type.is_swapped, out);
  if (type.bytes == 8) convert<Eight>(from, step, count, type.is_swapped, out);
}

}  // namespace

ChannelType channel_type(const SampleType& type) {
  if (type.kind == SampleKind::kFloat)
    return type.bytes == 2 ? ChannelType::kHalf : type.bytes == 4 ? ChannelType::kFloat : ChannelType::kDouble;
  if (type.kind == SampleKind::kSigned) return ChannelType::kInt;
  return type.bytes == 1 ? ChannelType::kUint8 : type.bytes == 2 ? ChannelType::kUint16 : ChannelType::kUint32;
}

void to_floats(const SampleType& type, const void* values, std::ptrdiff_t step, int count, float* out) {
  const auto* from = static_cast<const unsigned char*>(values);
  if (type.kind == SampleKind::kUnsigned)
    convert_any<std::uint8_t, std::uint16_t, std::uint32_t, std::uint64_t>(type, from, step, count, out);
  else if (type.kind == SampleKind::kSigned)
    convert_any<std::int8_t, std::int16_t, std::int32_t, std::int64_t>(type, from, step, count, out);
  else
    convert_any<std::uint8_t, Imath::half, float, double>(type, from, step, count, out);
}

}  // namespace umbrage
