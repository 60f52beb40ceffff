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

/// Rows start at multiples of this many floats, so that storing a vector of the widest instruction set (16 lanes) at
/// the end of a row does not overwrite the next row.
inline constexpr int kRowAlignment = 16;

/// Memory of released planes of 64 KiB and more, kept for new planes of the same size: fresh memory costs page faults,
/// which take half the time when pictures are drawn one after the other. Each device has one; threads may share it. It
/// keeps memory only while a PlanePoolLock exists, and frees it with the last one.
class PlanePool {
 public:
  PlanePool() = default;
  ~PlanePool();
  PlanePool(const PlanePool&) = delete;
  PlanePool& operator=(const PlanePool&) = delete;
  /// Returns the bytes that are kept now.
  std::size_t bytes() const;
  /// Returns the max of the bytes of living planes since the last call.
  std::size_t take_peak();
  /// Sets a limit of the bytes of living planes. A plane beyond it throws std::bad_alloc.
  void set_limit(std::size_t bytes);

 private:
  friend class Plane;
  friend class PlanePoolLock;
  void* take(std::size_t size);             // for a new plane; returns null if none is kept
  void forget(std::size_t size);            // of a new plane that was not made
  bool give(std::size_t size, void* base);  // returns false if the pool does not keep it
  void drop_all();                          // requires the lock
  mutable std::mutex mutex_;
  int holders_ = 0;
  std::size_t living_ = 0, peak_ = 0, limit_ = std::size_t(-1);  // bytes
  std::multimap<std::size_t, void*> blocks_;
};
using PlanePoolPtr = std::shared_ptr<PlanePool>;

/// Makes the pool keep memory during its lifetime. It may be created and destroyed on different threads.
class PlanePoolLock {
 public:
  explicit PlanePoolLock(PlanePoolPtr pool);
  ~PlanePoolLock();
  PlanePoolLock(const PlanePoolLock&) = delete;
  PlanePoolLock& operator=(const PlanePoolLock&) = delete;

 private:
  PlanePoolPtr pool_;
};

/// A PlanePoolLock that also makes the planes of this thread use the pool: they take their memory from it, and return
/// it on any thread. Planes may outlive the pool. If a thread has several, the last created is in effect.
class ScopedPlanePool {
 public:
  explicit ScopedPlanePool(PlanePoolPtr pool);
  ~ScopedPlanePool();
  ScopedPlanePool(const ScopedPlanePool&) = delete;
  ScopedPlanePool& operator=(const ScopedPlanePool&) = delete;

 private:
  PlanePoolLock lock_;
  PlanePoolPtr scoped_pool_;
  const PlanePoolPtr* previous_;  // the thread's pool before this one
};

/// Returns the stride, in floats, of all planes of that width. It depends on nothing else, since a kernel has one
/// stride for its planes.
int plane_stride(int width);

/// Returns the memory of a plane, bytes.
std::size_t plane_bytes(int width, int height);

/// One float per pixel. Row y starts at data() + y * stride; row 0 is the top one.
class Plane {
 public:
  Plane() = default;
  /// Creates an uninitialised plane.
  Plane(int width, int height);
  Plane(int width, int height, float value);
  Plane(const Plane& other);
  Plane(Plane&&) noexcept = default;
  Plane& operator=(Plane other) noexcept;
  /// Returns a plane that refers to the caller's floats, rows plane_stride(width) apart, which must outlive it. Copies
  /// own their memory. The width must be a multiple of kRowAlignment.
  static Plane view(const float* data, int width, int height);
  /// Returns a plane that refers to the floats of `of`, which must outlive it.
  static Plane view(const Plane& of);
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
    void* base;        // start of the allocation; pixels start at an offset
    std::size_t size;  // of the allocation, bytes
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
  /// Returns the plane of that name, or null.
  Plane* find(std::string_view name);
  const Plane* find(std::string_view name) const;
  /// Returns the plane of that name; throws InternalError if there is none.
  Plane& plane(std::string_view name);
  const Plane& plane(std::string_view name) const;
  /// Returns the plane of that name; adds it, uninitialised, if it is missing.
  Plane& add(std::string_view name);
};

/// A set of pixels of a picture: those at which a plane is above 0. Captures and dispatches leave out the others.
struct PixelMask {
  Plane plane;        ///< full rows of the picture, guard band included
  int first_row = 0;  ///< row of the picture that is the plane's row 0

  bool at(int x, int y) const { return plane.row(y - first_row)[x] > 0.0f; }
  /// Returns whether the set has a pixel in [x0, x1) x [y0, y1).
  bool any(int x0, int x1, int y0, int y1) const {
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x)
        if (at(x, y)) return true;
    return false;
  }
};

/// Returns the plane without `margin` pixels on each side.
Plane cropped(const Plane& plane, int margin);

/// Averages blocks of factor x factor pixels; the size is divided by the factor, rounded down.
Image downsample(const Image& image, int factor);

}  // namespace umbrage
