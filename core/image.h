// Image: width, height, named planes of float.
#pragma once
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace umbrage {

/// Rows start a multiple of this many floats apart, so that a vector of the widest machine (16 lanes) may be
/// stored over the end of a row.
inline constexpr int kRowAlignment = 16;

/// Memory of planes that are gone, for the next ones of their size: fresh memory costs its page faults, which are half
/// of the time of pictures that are drawn one after the other. A device has one; threads may share it. It keeps nothing
/// unless somebody holds it, and what it has kept goes with the last who does.
class PlanePool {
 public:
  PlanePool() = default;
  ~PlanePool();
  PlanePool(const PlanePool&) = delete;
  PlanePool& operator=(const PlanePool&) = delete;
  /// What is kept now.
  std::size_t bytes() const;

 private:
  friend class Plane;
  friend class HeldPool;
  void* take(std::size_t size);             // null where there is none
  bool give(std::size_t size, void* base);  // false where it is not kept
  void drop_all();                          // under the lock
  mutable std::mutex mutex_;
  int holders_ = 0;
  std::multimap<std::size_t, void*> blocks_;
};
using PlanePoolPtr = std::shared_ptr<PlanePool>;

/// While one of these lives, the pool keeps memory. It may be made on one thread and end on another.
class HeldPool {
 public:
  explicit HeldPool(PlanePoolPtr pool);
  ~HeldPool();
  HeldPool(const HeldPool&) = delete;
  HeldPool& operator=(const HeldPool&) = delete;

 private:
  PlanePoolPtr pool_;
};

/// The same, and the planes that this thread makes meanwhile are the pool's: they take their memory from it, and give
/// it back on whichever thread they end. They may outlive the pool. Of several, the last made counts.
class KeptPlanes {
 public:
  explicit KeptPlanes(PlanePoolPtr pool);
  ~KeptPlanes();
  KeptPlanes(const KeptPlanes&) = delete;
  KeptPlanes& operator=(const KeptPlanes&) = delete;

 private:
  HeldPool held_;
  PlanePoolPtr own_;
  const PlanePoolPtr* before_;  // of this thread
};

/// The stride of planes of that width, floats. It is the same for all, since a kernel has one stride for its planes.
int plane_stride(int width);

/// One float per pixel. Row y starts at data() + y * stride; row 0 is the top one.
class Plane {
 public:
  Plane() = default;
  /// An uninitialised plane.
  Plane(int width, int height);
  Plane(int width, int height, float value);
  Plane(const Plane& other);
  Plane(Plane&&) noexcept = default;
  Plane& operator=(Plane other) noexcept;
  /// The caller's floats, rows plane_stride(width) apart, which outlive it. A copy has memory of its own. The width is
  /// a multiple of kRowAlignment.
  static Plane view(const float* data, int width, int height);
  bool is_view() const { return data_ && !data_.get_deleter().base; }

  int width = 0, height = 0;
  int stride = 0;  ///< floats from one row to the next
  float* data() { return data_.get(); }
  const float* data() const { return data_.get(); }
  float* row(int y) { return data() + std::size_t(y) * stride; }
  const float* row(int y) const { return data() + std::size_t(y) * stride; }
  float& at(int x, int y) { return row(y)[x]; }
  float at(int x, int y) const { return row(y)[x]; }

 private:
  struct Free {
    void* base;        // what was allocated; pixels start a little later
    std::size_t size;  // of it, bytes
    std::weak_ptr<PlanePool> pool = {};
    void operator()(float* data);
  };
  std::unique_ptr<float, Free> data_{nullptr, Free{nullptr, 0, {}}};
};

/// Planes of one size, each with a name such as `depth` or `normal.x`, in the order in which they were added.
struct Image {
  int width = 0, height = 0;
  std::vector<std::string> names;
  std::vector<Plane> planes;

  Image() = default;
  Image(int width_, int height_) : width(width_), height(height_) {}
  /// The plane of that name, or null.
  Plane* find(std::string_view name);
  const Plane* find(std::string_view name) const;
  /// The plane of that name; throws InternalError where there is none.
  Plane& plane(std::string_view name);
  const Plane& plane(std::string_view name) const;
  /// The plane of that name, added uninitialised if it is missing.
  Plane& add(std::string_view name);
};

/// The pixels that remain when `margin` of them are cut off on each side.
Plane cropped(const Plane& plane, int margin);

/// Area-averages blocks of factor x factor pixels; the size is divided by the factor, rounded down.
Image downsample(const Image& image, int factor);

}  // namespace umbrage
