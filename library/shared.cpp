#include "library/shared.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "renderer/options.h"
#include "scene/scene.h"

namespace umbrage {
namespace {

/// Returns the first byte of an image's pixels, and the byte after the last.
std::pair<std::intptr_t, std::intptr_t> bytes_of(const SharedImage& image) {
  auto first = reinterpret_cast<std::intptr_t>(image.data), last = first;
  const auto extend = [&](std::ptrdiff_t stride, int count) {
    const std::ptrdiff_t far = stride * (count - 1);
    (far < 0 ? first : last) += far;
  };
  extend(image.channel_stride, image.channels);
  extend(image.pixel_stride, image.width);
  extend(image.row_stride, image.height);
  return {first, last + std::ptrdiff_t(size_of(image.type))};
}

}  // namespace

const char* interned_text(std::string_view text) {
  static std::mutex& mutex = *new std::mutex;
  static auto& texts = *new std::map<std::string, std::unique_ptr<std::string>, std::less<>>;
  const std::lock_guard lock(mutex);
  auto found = texts.find(text);
  if (found == texts.end()) found = texts.emplace(std::string(text), std::make_unique<std::string>(text)).first;
  return found->second->c_str();
}

Result<PixelType> pixel_type(int type) {
  if (type >= UMB_TYPE_FLOAT32 && type <= UMB_TYPE_UINT32) return PixelType(type);
  return usage_error("there is no type {}: see UmbType", type);
}

std::string_view name_of(PixelType type) {
  switch (type) {
    case PixelType::kFloat32:
      return "32-bit floats";
    case PixelType::kFloat16:
      return "16-bit floats";
    case PixelType::kUint8:
      return "8-bit integers";
    case PixelType::kUint16:
      return "16-bit integers";
    case PixelType::kUint32:
      return "32-bit integers";
  }
  return "";
}

Result<void> check_stride(std::string_view what, std::ptrdiff_t stride, std::size_t count) {
  constexpr std::ptrdiff_t kMaxStride = std::ptrdiff_t(1) << 40, kMaxSpan = std::ptrdiff_t(1) << 57;
  const std::ptrdiff_t size = std::abs(std::clamp(stride, -kMaxStride - 1, kMaxStride + 1));
  if (size <= kMaxStride && (size == 0 || count <= std::size_t(kMaxSpan / size))) return {};
  return usage_error("{} cannot have {} elements with a stride of {} bytes", what, count, stride);
}

Result<SharedImage> shared_image(std::string_view what, const UmbImage& image) {
  const auto type = pixel_type(image.type);
  if (!type) return usage_error("{}: {}", what, type.error().message);
  for (const int side : {image.width, image.height})
    if (side < 1 || side > kMaxSide)
      return usage_error("{} cannot have {} x {} pixels: it takes 1 to {} each", what, image.width, image.height,
                         kMaxSide);
  constexpr int kMaxChannels = 64;
  if (image.channels < 1 || image.channels > kMaxChannels)
    return usage_error("{} cannot have {} channels: it takes 1 to {}", what, image.channels, kMaxChannels);
  for (const auto& [stride, count] : {std::pair(image.channel_stride, image.channels),
                                      {image.pixel_stride, image.width},
                                      {image.row_stride, image.height}})
    if (const auto fits = check_stride(what, stride, std::size_t(count)); !fits) return fits.error();
  return with_strides({.data = image.data,
                       .type = *type,
                       .width = image.width,
                       .height = image.height,
                       .channels = image.channels,
                       .channel_stride = image.channel_stride,
                       .pixel_stride = image.pixel_stride,
                       .row_stride = image.row_stride});
}

UmbImage as_umb(const SharedImage& image) {
  return {image.data,     int32_t(image.type),  image.width,        image.height,
          image.channels, image.channel_stride, image.pixel_stride, image.row_stride};
}

namespace {

/// Returns whether a value of one channel of `a` shares a byte with a value of one channel of `b`. `byte`: offset of
/// the channel of `b` from that of `a`. Both images have the same strides.
bool channels_overlap(const SharedImage& a, const SharedImage& b, std::ptrdiff_t byte) {
  const auto size_a = std::ptrdiff_t(size_of(a.type)), size_b = std::ptrdiff_t(size_of(b.type));
  for (std::ptrdiff_t dy = -(a.height - 1); dy < b.height; ++dy) {
    const std::ptrdiff_t rest = byte + a.row_stride * dy;
    // The columns between which the distance changes its sign, and one more on either side.
    const std::ptrdiff_t near = -rest / a.pixel_stride;
    for (std::ptrdiff_t dx = near - 2; dx <= near + 2; ++dx) {
      const std::ptrdiff_t distance = rest + a.pixel_stride * dx;
      if (dx > -a.width && dx < b.width && distance < size_a && -distance < size_b) return true;
    }
  }
  return false;
}

}  // namespace

bool overlap(const SharedImage& a, const SharedImage& b) {
  if (!a.data || !b.data) return false;
  const auto [a_first, a_end] = bytes_of(a);
  const auto [b_first, b_end] = bytes_of(b);
  if (a_end <= b_first || b_end <= a_first) return false;
  // Images that are parts of one array may be interleaved.
  if (a.pixel_stride != b.pixel_stride || a.row_stride != b.row_stride || a.pixel_stride == 0) return true;
  const auto start = [](const SharedImage& image, int channel) {
    return reinterpret_cast<std::intptr_t>(image.data) + image.channel_stride * channel;
  };
  for (int i = 0; i < a.channels; ++i)
    for (int j = 0; j < b.channels; ++j)
      if (channels_overlap(a, b, start(b, j) - start(a, i))) return true;
  return false;
}

bool overlaps_itself(const SharedImage& image) {
  std::array<std::pair<std::ptrdiff_t, int>, 3> steps = {{{std::abs(image.channel_stride), image.channels},
                                                          {std::abs(image.pixel_stride), image.width},
                                                          {std::abs(image.row_stride), image.height}}};
  std::sort(steps.begin(), steps.end());
  auto needed = std::ptrdiff_t(size_of(image.type));
  for (const auto& [stride, count] : steps) {
    if (count > 1 && stride < needed) return true;
    needed += stride * (count - 1);
  }
  return false;
}

UmbView view_of(const Camera& camera, const glm::dvec3& origin) {
  UmbView view{};
  const glm::dmat4 view_from_world = view_from_file(camera.view_from_world, origin);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) view.view_from_world[4 * row + column] = view_from_world[column][row];
  view.left = camera.left;
  view.right = camera.right;
  view.bottom = camera.bottom;
  view.top = camera.top;
  view.orthographic = camera.projection == Projection::kOrthographic;
  return view;
}

glm::dmat4 matrix_of(const UmbView& view) {
  glm::dmat4 matrix(1.0);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) matrix[column][row] = view.view_from_world[4 * row + column];
  return matrix;
}

Result<Camera> camera_of(const UmbView& view) {
  Camera camera;
  camera.view_from_world = glm::mat4(matrix_of(view));
  bool finite = true;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row) finite = finite && std::isfinite(camera.view_from_world[column][row]);
  camera.left = view.left;
  camera.right = view.right;
  camera.bottom = view.bottom;
  camera.top = view.top;
  camera.projection = view.orthographic ? Projection::kOrthographic : Projection::kPerspective;
  const float width = view.right - view.left, height = view.top - view.bottom;
  if (finite && width > 0.0f && height > 0.0f && std::isfinite(width) && std::isfinite(height)) return camera;
  return usage_error("the view is no camera: it takes finite numbers, left below right and bottom below top");
}

}  // namespace umbrage
