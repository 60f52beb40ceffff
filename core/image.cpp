#include "core/image.h"

#include <sys/mman.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <new>
#include <utility>

#include "core/check.h"

namespace umbrage {
namespace {

constexpr std::size_t kCacheLine = 64;
constexpr std::size_t kHugePage = std::size_t(2) << 20;
constexpr std::size_t kPage = 4096;

/// Rows and planes that start a multiple of this apart fall on the same lines of the first-level cache, and a pass over
/// a dozen planes then evicts itself.
constexpr std::size_t kCacheWay = 1024;
constexpr std::size_t kStagger = 17 * kCacheLine;
constexpr unsigned kStaggers = 32;

int padded_stride(int width) {
  const int stride = (width + kRowAlignment - 1) / kRowAlignment * kRowAlignment;
  const bool aliased = stride * sizeof(float) % kCacheWay == 0;
  return aliased ? stride + kRowAlignment : stride;
}

/// Memory of planes that are gone, by its size, while somebody wants it kept.
struct Kept {
  std::mutex mutex;
  int wanted_by = 0;
  std::multimap<std::size_t, void*> blocks;
};

/// Where in its memory a large plane starts, bytes: another place each time.
std::size_t next_stagger() {
  static std::atomic<unsigned> count{0};
  return count++ % kStaggers * kStagger;
}

Kept& kept() {
  static Kept& all = *new Kept;  // planes may outlive what is static
  return all;
}

void* take_kept(std::size_t size) {
  Kept& all = kept();
  const std::lock_guard lock(all.mutex);
  const auto found = all.blocks.find(size);
  if (found == all.blocks.end()) return nullptr;
  void* base = found->second;
  all.blocks.erase(found);
  return base;
}

}  // namespace

KeptPlanes::KeptPlanes() {
  const std::lock_guard lock(kept().mutex);
  ++kept().wanted_by;
}

KeptPlanes::~KeptPlanes() {
  Kept& all = kept();
  const std::lock_guard lock(all.mutex);
  if (--all.wanted_by > 0) return;
  for (const auto& [size, base] : all.blocks) std::free(base);
  all.blocks.clear();
}

void Plane::Free::operator()(float*) {
  if (size >= kHugePage) {
    Kept& all = kept();
    const std::lock_guard lock(all.mutex);
    if (all.wanted_by > 0) {
      try {
        all.blocks.emplace(size, base);
        return;
      } catch (const std::bad_alloc&) {  // it is not kept
      }
    }
  }
  std::free(base);
}

Plane::Plane(int width_, int height_) : width(width_), height(height_), stride(padded_stride(width_)) {
  const std::size_t bytes = std::size_t(stride) * height * sizeof(float);
  if (bytes == 0) return;
  // Large planes ask for huge pages: a picture's planes are fresh memory, whose page faults cost as much as an effect.
  // What is left over takes small ones: of a huge page the system clears all, and a plane of 1024 x 1024 is a little
  // more than two.
  const bool large = bytes >= kHugePage;
  const std::size_t offset = large ? next_stagger() : 0;
  const std::size_t alignment = large ? kHugePage : kCacheLine;
  const std::size_t rounding = large ? kPage : kCacheLine;
  // The same for all planes of one size, so that one serves the next.
  const std::size_t needed = bytes + (large ? (kStaggers - 1) * kStagger : 0);
  const std::size_t whole = (needed + rounding - 1) / rounding * rounding;
  void* base = large ? take_kept(whole) : nullptr;
  if (!base) {
    if (posix_memalign(&base, alignment, whole) != 0) throw std::bad_alloc();
    if (large) {
      const std::size_t huge = whole / kHugePage * kHugePage;
      madvise(base, huge, MADV_HUGEPAGE);
      if (huge < whole) madvise(static_cast<std::byte*>(base) + huge, whole - huge, MADV_NOHUGEPAGE);
    }
  }
  data_ = {reinterpret_cast<float*>(static_cast<std::byte*>(base) + offset), Free{base, whole}};
}

Plane::Plane(int width_, int height_, float value) : Plane(width_, height_) {
  std::fill_n(data(), std::size_t(stride) * height, value);
}

Plane::Plane(const Plane& other) : Plane(other.width, other.height) {
  if (data_) std::memcpy(data(), other.data(), std::size_t(stride) * height * sizeof(float));
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
  const float share = 1.0f / float(factor * factor);
  for (std::size_t p = 0; p < image.planes.size(); ++p) {
    Plane& plane = out.add(image.names[p]);
    for (int y = 0; y < out.height; ++y)
      for (int x = 0; x < out.width; ++x) {
        float sum = 0.0f;
        for (int j = 0; j < factor; ++j)
          for (int i = 0; i < factor; ++i) sum += image.planes[p].at(x * factor + i, y * factor + j);
        plane.at(x, y) = sum * share;
      }
  }
  return out;
}

}  // namespace umbrage
