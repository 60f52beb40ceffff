// Image: width, height, named planes of float.
#pragma once
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace umbrage {

/// Rows start a multiple of this many floats apart, so that a vector of the widest machine (16 lanes) may be
/// stored over the end of a row.
inline constexpr int kRowAlignment = 16;

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
    void operator()(float* data);
  };
  std::unique_ptr<float, Free> data_{nullptr, Free{nullptr, 0}};
};

/// While one of these lives, the memory of planes that are gone serves the next ones of their size: fresh memory costs
/// its page faults, which are half of the time of pictures that are drawn one after the other.
class KeptPlanes {
 public:
  KeptPlanes();
  ~KeptPlanes();
  KeptPlanes(const KeptPlanes&) = delete;
  KeptPlanes& operator=(const KeptPlanes&) = delete;
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
