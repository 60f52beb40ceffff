#include "core/image.h"

#include <sys/mman.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <new>
#include <utility>

#include "core/check.h"

namespace umbrage {
namespace {

constexpr std::size_t kCacheLine = 64;
constexpr std::size_t kHugePage = std::size_t(2) << 20;
constexpr std::size_t kPage = 4096;
/// Min size of pooled planes, bytes. The allocator keeps smaller blocks itself, but maps most larger ones anew.
constexpr std::size_t kMinPooled = std::size_t(64) << 10;

/// Rows and planes whose starts are a multiple of this many bytes apart map to the same lines of the first-level cache,
/// and a loop over a dozen planes then evicts its own data.
constexpr std::size_t kCacheWay = 1024;
constexpr std::size_t kStagger = 17 * kCacheLine;
constexpr unsigned kStaggers = 32;

/// Returns the offset at which a large plane starts in its memory, bytes. The planes of a thread cycle through
/// kStaggers offsets.
std::size_t next_stagger() {
  thread_local unsigned count = 0;
  return count++ % kStaggers * kStagger;
}

/// The pool of the planes that this thread creates, owned by a ScopedPlanePool; null: none.
thread_local const PlanePoolPtr* pool_of_thread = nullptr;

}  // namespace

int plane_stride(int width) {
  const int stride = (width + kRowAlignment - 1) / kRowAlignment * kRowAlignment;
  const bool aliased = stride * sizeof(float) % kCacheWay == 0;
  return aliased ? stride + kRowAlignment : stride;
}

std::size_t plane_bytes(int width, int height) {
  const std::size_t bytes = std::size_t(plane_stride(width)) * height * sizeof(float);
  const bool large = bytes >= kHugePage;
  const std::size_t rounding = large ? kPage : kCacheLine;
  // Equal for all planes of one size, whatever their offset, so that their memory is interchangeable.
  const std::size_t needed = bytes + (large ? (kStaggers - 1) * kStagger : 0);
  return (needed + rounding - 1) / rounding * rounding;
}

PlanePool::~PlanePool() { drop_all(); }

std::size_t PlanePool::bytes() const {
  const std::lock_guard lock(mutex_);
  std::size_t sum = 0;
  for (const auto& [size, base] : blocks_) sum += size;
  return sum;
}

std::size_t PlanePool::take_peak() {
  const std::lock_guard lock(mutex_);
  return std::exchange(peak_, living_);
}

void PlanePool::set_limit(std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  limit_ = bytes;
}

void* PlanePool::take(std::size_t size) {
  const std::lock_guard lock(mutex_);
  if (living_ + size > limit_) throw std::bad_alloc();
  living_ += size;
  peak_ = std::max(peak_, living_);
  const auto found = blocks_.find(size);
  if (found == blocks_.end()) return nullptr;
  void* base = found->second;
  blocks_.erase(found);
  return base;
}

void PlanePool::forget(std::size_t size) {
  const std::lock_guard lock(mutex_);
  living_ -= size;
}

bool PlanePool::give(std::size_t size, void* base) {
  const std::lock_guard lock(mutex_);
  living_ -= size;
  if (holders_ == 0) return false;
  try {
    blocks_.emplace(size, base);
  } catch (const std::bad_alloc&) {
    return false;
  }
  return true;
}

void PlanePool::drop_all() {
  for (const auto& [size, base] : blocks_) std::free(base);
  blocks_.clear();
}

PlanePoolLock::PlanePoolLock(PlanePoolPtr pool) : pool_(std::move(pool)) {
  const std::lock_guard lock(pool_->mutex_);
  ++pool_->holders_;
}

PlanePoolLock::~PlanePoolLock() {
  const std::lock_guard lock(pool_->mutex_);
  if (--pool_->holders_ == 0) pool_->drop_all();
}

ScopedPlanePool::ScopedPlanePool(PlanePoolPtr pool)
    : lock_(pool), scoped_pool_(std::move(pool)), previous_(pool_of_thread) {
  pool_of_thread = &scoped_pool_;
}

ScopedPlanePool::~ScopedPlanePool() { pool_of_thread = previous_; }

void Plane::Free::operator()(float*) {
  if (const PlanePoolPtr owner = pool.lock(); owner && owner->give(size, base)) return;
  std::free(base);
}

Plane::Plane(int width_, int height_) : width(width_), height(height_), stride(plane_stride(width_)) {
  const std::size_t bytes = std::size_t(stride) * height * sizeof(float);
  if (bytes == 0) return;
  // Large planes use huge pages, since the page faults of fresh memory take as long as an effect. The part beyond the
  // last full huge page uses small pages: the system clears whole huge pages, and a plane of 1024 x 1024 is slightly
  // larger than two.
  const bool large = bytes >= kHugePage;
  const std::size_t offset = large ? next_stagger() : 0;
  const std::size_t alignment = large ? kHugePage : kCacheLine;
  const std::size_t whole = plane_bytes(width, height);
  const PlanePoolPtr pool = bytes >= kMinPooled && pool_of_thread ? *pool_of_thread : nullptr;
  void* base = pool ? pool->take(whole) : nullptr;
  if (!base) {
    if (posix_memalign(&base, alignment, whole) != 0) {
      if (pool) pool->forget(whole);
      throw std::bad_alloc();
    }
    if (large) {
      const std::size_t huge = whole / kHugePage * kHugePage;
      madvise(base, huge, MADV_HUGEPAGE);
      if (huge < whole) madvise(static_cast<std::byte*>(base) + huge, whole - huge, MADV_NOHUGEPAGE);
    }
  }
  data_ = {reinterpret_cast<float*>(static_cast<std::byte*>(base) + offset), Free{base, whole, pool}};
}

Plane Plane::view(const Plane& of) {
  Plane view;
  view.width = of.width;
  view.height = of.height;
  view.stride = of.stride;
  view.data_ = {const_cast<float*>(of.data()), Free{nullptr, 0, {}}};
  return view;
}

Plane Plane::view(const float* data, int width, int height) {
  check_equal(width % kRowAlignment, 0, "width of a view");
  Plane view;
  view.width = width;
  view.height = height;
  view.stride = plane_stride(width);
  view.data_ = {const_cast<float*>(data), Free{nullptr, 0, {}}};
  return view;
}

Plane::Plane(int width_, int height_, float value) : Plane(width_, height_) {
  std::fill_n(data(), std::size_t(stride) * height, value);
}

Plane::Plane(const Plane& other) : Plane(other.width, other.height) {
  // Does not copy the padding of the last row, since the memory of a view may end before it.
  if (data_) std::memcpy(data(), other.data(), (std::size_t(stride) * (height - 1) + width) * sizeof(float));
}

Plane& Plane::operator=(Plane other) noexcept {
  width = other.width;
  height = other.height;
  stride = other.stride;
  data_ = std::move(other.data_);
  return *this;
}

const Plane* Image::find(std::string_view name) const {
  const auto it = std::find(names.begin(), names.end(), name);
  return it == names.end() ? nullptr : &planes[it - names.begin()];
}

Plane* Image::find(std::string_view name) { return const_cast<Plane*>(std::as_const(*this).find(name)); }

const Plane& Image::plane(std::string_view name) const {
  const Plane* found = find(name);
  if (!found) fail_check(fmt::format("the image has no plane '{}'", name));
  return *found;
}

Plane& Image::plane(std::string_view name) { return const_cast<Plane&>(std::as_const(*this).plane(name)); }

Plane& Image::add(std::string_view name) {
  if (Plane* found = find(name)) return *found;
  names.emplace_back(name);
  return planes.emplace_back(width, height);
}

Plane cropped(const Plane& plane, int margin) {
  if (margin == 0) return plane;
  check_less(2 * margin, std::min(plane.width, plane.height), "margin of a crop");
  Plane out(plane.width - 2 * margin, plane.height - 2 * margin);
  for (int y = 0; y < out.height; ++y) std::copy_n(plane.row(y + margin) + margin, out.width, out.row(y));
  return out;
}

Image downsample(const Image& image, int factor) {
  Image out(image.width / factor, image.height / factor);
  const float fraction = 1.0f / float(factor * factor);
  for (std::size_t p = 0; p < image.planes.size(); ++p) {
    Plane& plane = out.add(image.names[p]);
    for (int y = 0; y < out.height; ++y)
      for (int x = 0; x < out.width; ++x) {
        float sum = 0.0f;
        for (int j = 0; j < factor; ++j)
          for (int i = 0; i < factor; ++i) sum += image.planes[p].at(x * factor + i, y * factor + j);
        plane.at(x, y) = sum * fraction;
      }
  }
  return out;
}

}  // namespace umbrage
