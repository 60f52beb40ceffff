#include "importer/gltf_accessor.h"

#include <algorithm>
#include <cstring>

namespace umbrage {
namespace {

/// The component types of glTF, by OpenGL's numbers.
enum Component { kInt8 = 5120, kUint8, kInt16, kUint16, kUint32 = 5125, kFloat };

std::size_t size_of(int component) {
  switch (component) {
    case kInt8:
    case kUint8:
      return 1;
    case kInt16:
    case kUint16:
      return 2;
    case kUint32:
    case kFloat:
      return 4;
    default:
      return 0;
  }
}

template <class T>
T value_at(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// Where the elements of an accessor, or of the parts of a sparse one, are.
struct Elements {
  ByteSpan bytes;
  std::size_t count = 0, stride = 0, size = 0;
  int component = 0, width = 0;
  bool is_normalized = false;
};

/// Returns the elements in a buffer view. Errors: kFile if they are not inside.
Result<Elements> elements_of(GltfFile& file, const Json& place, std::size_t count, int component, int width,
                             bool is_matrix) {
  const std::size_t size = size_of(component);
  if (size == 0) return file_error("an accessor has the unknown component type {}", component);
  const int index = index_of(member(place, "bufferView"));
  const auto view = file.buffer_view(index);
  if (!view) return view.error();
  Elements elements{.count = count, .size = size * std::size_t(width), .component = component, .width = width};
  // Columns of matrices start at multiples of 4 bytes; matrices of small integers have gaps and are not used.
  if (is_matrix && size < 4) return file_error("an accessor of matrices has the component type {}", component);
  const std::size_t given = file.stride_of_view(index);
  elements.stride = given > 0 ? given : elements.size;
  const std::int64_t offset = std::max(integer_of(member(place, "byteOffset")), std::int64_t(0));
  if (elements.stride < elements.size)
    return file_error("an accessor's elements of {} bytes overlap: their stride is {}", elements.size, elements.stride);
  if (count == 0) return elements;
  const std::size_t room = std::size_t(offset) <= view->size() ? view->size() - std::size_t(offset) : 0;
  if (room < elements.size || (room - elements.size) / elements.stride < count - 1)
    return file_error("an accessor's {} elements of {} bytes do not fit in the {} bytes of buffer view {}", count,
                      elements.size, view->size(), index);
  elements.bytes = view->subspan(std::size_t(offset));
  return elements;
}

template <class T>
void copy_values(const Elements& from, float* to) {
  for (std::size_t i = 0; i < from.count; ++i) {
    const std::uint8_t* element = from.bytes.data() + i * from.stride;
    for (int k = 0; k < from.width; ++k, ++to) {
      const double value = double(value_at<T>(element + std::size_t(k) * sizeof(T)));
      *to = from.is_normalized ? normalized(value, from.component) : float(value);
    }
  }
}

void copy_numbers(const Elements& from, float* to) {
  switch (from.component) {
    case kInt8:
      return copy_values<std::int8_t>(from, to);
    case kUint8:
      return copy_values<std::uint8_t>(from, to);
    case kInt16:
      return copy_values<std::int16_t>(from, to);
    case kUint16:
      return copy_values<std::uint16_t>(from, to);
    case kUint32:
      return copy_values<std::uint32_t>(from, to);
    default:
      break;
  }
  if (from.count == 0) return;
  if (from.stride == from.size) {
    std::memcpy(to, from.bytes.data(), from.count * from.size);
    return;
  }
  for (std::size_t i = 0; i < from.count; ++i, to += from.width)
    std::memcpy(to, from.bytes.data() + i * from.stride, from.size);
}

Result<std::vector<std::uint32_t>> integers_of(const Elements& from) {
  std::vector<std::uint32_t> values(from.count);
  for (std::size_t i = 0; i < from.count; ++i) {
    const std::uint8_t* element = from.bytes.data() + i * from.stride;
    switch (from.component) {
      case kUint8:
        values[i] = *element;
        break;
      case kUint16:
        values[i] = value_at<std::uint16_t>(element);
        break;
      case kUint32:
        values[i] = value_at<std::uint32_t>(element);
        break;
      default:
        return file_error("an accessor of indices has the component type {}", from.component);
    }
  }
  return values;
}

/// Replaces elements of a sparse accessor.
Result<void> apply_sparse(GltfFile& file, const Json& accessor, GltfNumbers& numbers, bool is_normalized) {
  const Json& sparse = member(accessor, "sparse");
  if (!sparse.is_object()) return {};
  const std::int64_t count = integer_of(member(sparse, "count"));
  if (count < 0 || std::uint64_t(count) > numbers.count)
    return file_error("a sparse accessor has {} values for {} elements", count, numbers.count);
  const Json &where = member(sparse, "indices"), &what = member(sparse, "values");
  const auto indices = elements_of(file, where, std::size_t(count), index_of(member(where, "componentType")), 1, false);
  if (!indices) return indices.error();
  const auto at = integers_of(*indices);
  if (!at) return at.error();
  auto values =
      elements_of(file, what, std::size_t(count), index_of(member(accessor, "componentType")), numbers.width, false);
  if (!values) return values.error();
  values->is_normalized = is_normalized;
  std::vector<float> replacements(std::size_t(count) * std::size_t(numbers.width));
  copy_numbers(*values, replacements.data());
  for (std::size_t i = 0; i < at->size(); ++i) {
    if ((*at)[i] >= numbers.count) return file_error("a sparse accessor has the index {} out of range", (*at)[i]);
    std::copy_n(replacements.data() + i * std::size_t(numbers.width), numbers.width,
                numbers.values.data() + std::size_t((*at)[i]) * std::size_t(numbers.width));
  }
  return {};
}

constexpr std::int64_t kMaxCount = std::int64_t(1) << 31;

}  // namespace

int width_of(const Json& accessor) {
  static const std::map<std::string, int> kWidths = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                                                     {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};
  const auto found = kWidths.find(text_of(member(accessor, "type")));
  return found == kWidths.end() ? 0 : found->second;
}

float normalized(double integer, int component_type) {
  switch (component_type) {
    case kInt8:
      return float(std::max(integer / 127.0, -1.0));
    case kUint8:
      return float(integer / 255.0);
    case kInt16:
      return float(std::max(integer / 32767.0, -1.0));
    case kUint16:
      return float(integer / 65535.0);
    case kUint32:
      return float(integer / 4294967295.0);
    default:
      return float(integer);
  }
}

Result<GltfNumbers> read_numbers(GltfFile& file, int index, int min_width, int max_width) {
  const Json& accessor = file.list("accessors", std::size_t(index));
  if (index < 0 || !accessor.is_object()) return file_error("it has no accessor {}", index);
  const int width = width_of(accessor), component = index_of(member(accessor, "componentType"));
  const std::int64_t count = integer_of(member(accessor, "count"));
  if (count < 0 || count >= kMaxCount) return file_error("the accessor {} has no valid count", index);
  if (width < min_width || width > max_width)
    return file_error("the accessor {} has the type '{}', which is not valid here", index,
                      text_of(member(accessor, "type")));
  const Json& normalize = member(accessor, "normalized");
  const bool is_normalized = normalize.is_boolean() && normalize.get<bool>();
  GltfNumbers numbers{.count = std::size_t(count), .width = width};
  if (member(accessor, "bufferView").is_null()) {
    // All zeros, which only a sparse accessor makes useful. A count alone must not allocate much memory: elsewhere the
    // file has data for as many vertices, at least 1 / 64 byte each if it is compressed.
    constexpr std::size_t kMaxPerByte = 64;
    if (numbers.count > kMaxPerByte * file.byte_count())
      return file_error("the accessor {} has {} elements without data", index, count);
    numbers.values.assign(numbers.count * std::size_t(width), 0.0f);
  } else {
    auto elements = elements_of(file, accessor, numbers.count, component, width, width > 4);
    if (!elements) return elements.error();
    elements->is_normalized = is_normalized;
    numbers.values.resize(numbers.count * std::size_t(width));
    copy_numbers(*elements, numbers.values.data());
  }
  if (auto status = apply_sparse(file, accessor, numbers, is_normalized); !status) return status.error();
  return numbers;
}

Result<std::vector<std::uint32_t>> read_indices(GltfFile& file, int index) {
  const Json& accessor = file.list("accessors", std::size_t(index));
  if (index < 0 || !accessor.is_object()) return file_error("it has no accessor {}", index);
  const std::int64_t count = integer_of(member(accessor, "count"));
  if (count < 0 || count >= kMaxCount || width_of(accessor) != 1)
    return file_error("the accessor {} is not a valid list of indices", index);
  if (member(accessor, "sparse").is_object())
    return file_error("the accessor {} is a sparse list of indices, which is not read", index);
  const auto elements =
      elements_of(file, accessor, std::size_t(count), index_of(member(accessor, "componentType")), 1, false);
  if (!elements) return elements.error();
  return integers_of(*elements);
}

}  // namespace umbrage
