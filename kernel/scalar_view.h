// Access of the scalar dialect to the planes of a frame. lanes_view.h has the same functions.
#pragma once
#include <algorithm>

#include "kernel/kernel_frame.h"
#include "kernel/scalar.h"

namespace umbrage::scalar {

struct ScalarView {
  const KernelFrame& frame;
  int x = 0, y = 0;

  bool is_computed(int at_x, int at_y) const {
    return frame.frame.missing == 0 || frame.ao[std::ptrdiff_t(at_y) * frame.frame.stride + at_x] >= kMissing;
  }

  float* plane(std::string_view name) const { return frame.plane(name); }
  /// Returns the value at any pixel; coordinates outside are clamped to the border.
  Real load(const float* plane, Int X, Int Y) const {
    X = clamp(X, 0, frame.frame.width - 1);
    Y = clamp(Y, frame.first_row, std::min(frame.last_row, frame.frame.height - 1));
    return plane[std::ptrdiff_t(Y) * frame.frame.stride + X];
  }
  /// Returns the value of the pixel i columns right of this one and j rows down, clamped to the border.
  Real near(const float* plane, int i, int j) const { return load(plane, x + i, y + j); }
  /// Returns the value at the upper left pixel of the block of f x f pixels that is i blocks right and j blocks down of
  /// this pixel's block, clamped to the border; f is 1, 2 or 4.
  Real corner(const float* plane, int f, int i, int j) const { return load(plane, (x / f + i) * f, (y / f + j) * f); }
  /// Returns the value of that block in a reduced picture, one pixel per block, in the upper left corner of the plane.
  Real block(const float* plane, int f, int i, int j) const { return load(plane, x / f + i, y / f + j); }
  Bool inside(int i, int j) const {
    return x + i >= 0 && x + i < frame.frame.width && y + j >= 0 && y + j < frame.frame.height;
  }
  /// Returns the index of a pixel in a plane. X and Y are integers inside the picture.
  Int place_of(Real X, Real Y) const { return Int(Y) * frame.frame.stride + Int(X); }
  Real read(const float* plane, Int place) const { return plane[place]; }
  template <class T>
  void write_list(T* list, T v) const {
    *list = v;
  }
  template <class T>
  T read_list(const T* list) const {
    return *list;
  }
  void store(float* plane, Real v) const { plane[std::ptrdiff_t(y) * frame.frame.stride + x] = v; }
};

}  // namespace umbrage::scalar
