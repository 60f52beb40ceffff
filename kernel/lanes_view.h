// Access of the SIMD lanes to the planes of a frame. Included once per SIMD target.
#if defined(UMBRAGE_MACHINE_LANES_VIEW_H) == defined(HWY_TARGET_TOGGLE)
#ifdef UMBRAGE_MACHINE_LANES_VIEW_H
#undef UMBRAGE_MACHINE_LANES_VIEW_H
#else
#define UMBRAGE_MACHINE_LANES_VIEW_H
#endif

#include <cstddef>

#include "kernel/kernel_frame.h"
#include "kernel/lanes.h"

HWY_BEFORE_NAMESPACE();
namespace umbrage {
namespace HWY_NAMESPACE {
namespace {

// Max distance in pixels of neighbours that are read without border checks, if the border is farther away than that.
constexpr int kMargin = 16;
// The same in blocks of up to 4 x 4 pixels, counting the pixel's own block as one.
constexpr int kMarginBlocks = 3;

struct LanesView {
  const KernelFrame& frame;
  float real_stride = float(frame.frame.stride);
  // Whether all plane indices are exact as floats.
  bool exact = (std::int64_t(frame.frame.height) + 1) * frame.frame.stride <= 1 << 24;
  int first_row = frame.first_row, last_row = HWY_MIN(frame.last_row, frame.frame.height - 1);
  int x = 0, y = 0;         // pixel of the first lane
  bool inner = false;       // all lanes are at least kMargin inside the picture
  std::ptrdiff_t here = 0;  // index of pixel (x, y) in a plane
  // Whether the lanes are the pixels (column, row), which can be anywhere. If so, x, y and here are invalid, and corner
  // and block must not be called.
  bool scattered = false;
  Int column = 0, row = 0;

  HWY_INLINE void move(int to_x, int to_y) {
    x = to_x;
    y = to_y;
    inner =
        x >= kMargin && x + kLanes + kMargin <= frame.frame.width && y >= kMargin && y + kMargin < frame.frame.height;
    here = std::ptrdiff_t(y) * frame.frame.stride + x;
  }
  HWY_INLINE void move_to(Int columns, Int rows) {
    scattered = true;
    inner = false;
    column = columns;
    row = rows;
  }

  float* plane(std::string_view name) const { return frame.plane(name); }
  HWY_INLINE Real load(const float* plane, Int X, Int Y) const {
    const Int column = clamp(X, Int(0), Int(frame.frame.width - 1));
    const Int row = clamp(Y, Int(first_row), Int(last_row));
    return hn::GatherIndex(D(), plane, (row * Int(frame.frame.stride) + column).v);
  }
  HWY_INLINE Int place_of(Real X, Real Y) const {
    if (HWY_LIKELY(exact)) return to_int(Y * Real(real_stride) + X);
    return to_int(Y) * Int(frame.frame.stride) + to_int(X);
  }
  HWY_INLINE Real read(const float* plane, Int place) const { return hn::GatherIndex(D(), plane, place.v); }
  HWY_INLINE void write_list(float* list, Real v) const { hn::StoreU(v.v, D(), list); }
  HWY_INLINE void write_list(std::uint32_t* list, Uint v) const { hn::StoreU(v.v, DU(), list); }
  HWY_INLINE Real read_list(const float* list) const { return hn::LoadU(D(), list); }
  HWY_INLINE Uint read_list(const std::uint32_t* list) const { return hn::LoadU(DU(), list); }
  HWY_INLINE Real near(const float* plane, int i, int j) const {
    const bool close = unsigned(i + kMargin) <= 2u * kMargin && unsigned(j + kMargin) <= 2u * kMargin;
    if (HWY_LIKELY(inner && close)) return hn::LoadU(D(), plane + here + std::ptrdiff_t(j) * frame.frame.stride + i);
    return near_border(plane, i, j);
  }
  HWY_NOINLINE Real near_border(const float* plane, int i, int j) const {
    if (scattered) return load(plane, column + Int(i), row + Int(j));
    const int line = HWY_MIN(HWY_MAX(y + j, 0), frame.frame.height - 1);
    const int first = x + i;
    const float* start = plane + std::ptrdiff_t(line) * frame.frame.stride;
    if (first >= 0 && first + kLanes <= frame.frame.width) return hn::LoadU(D(), start + first);
    return hn::GatherIndex(D(), start, clamp(Int(hn::Iota(DI(), first)), Int(0), Int(frame.frame.width - 1)).v);
  }
  // f is 1, 2 or 4. If there are at least f lanes, the first is at a multiple of f.
  HWY_INLINE Real corner(const float* plane, int f, int i, int j) const {
#if HWY_TARGET != HWY_SCALAR
    const bool close =
        unsigned(i + kMarginBlocks) <= 2u * kMarginBlocks && unsigned(j + kMarginBlocks) <= 2u * kMarginBlocks;
    if (HWY_LIKELY(inner && close)) {
      const auto v = hn::LoadU(D(), plane + here + std::ptrdiff_t(j * f - (y & (f - 1))) * frame.frame.stride + i * f);
      return f == 4 ? hn::Broadcast<0>(v) : f == 2 ? hn::DupEven(v) : v;
    }
#endif
    return corner_border(plane, f, i, j);
  }
  HWY_NOINLINE Real corner_border(const float* plane, int f, int i, int j) const {
    const int row = HWY_MIN(HWY_MAX((y / f + j) * f, 0), frame.frame.height - 1);
    const float* start = plane + std::ptrdiff_t(row) * frame.frame.stride;
    const Int first = hn::AndNot(hn::Set(DI(), f - 1), hn::Iota(DI(), x));
    return hn::GatherIndex(D(), start, clamp(first + Int(i * f), Int(0), Int(frame.frame.width - 1)).v);
  }
  HWY_INLINE Real block(const float* plane, int f, int i, int j) const {
    const int shift = f / 2;
#if HWY_TARGET != HWY_SCALAR
    const bool close =
        unsigned(i + kMarginBlocks) <= 2u * kMarginBlocks && unsigned(j + kMarginBlocks) <= 2u * kMarginBlocks;
    if (HWY_LIKELY(inner && close))
      return hn::TableLookupLanes(
          hn::LoadU(D(), plane + std::ptrdiff_t((y >> shift) + j) * frame.frame.stride + (x >> shift) + i),
          hn::IndicesFromVec(D(), hn::ShiftRightSame(hn::Iota(DI(), 0), shift)));
#endif
    return block_border(plane, shift, i, j);
  }
  HWY_NOINLINE Real block_border(const float* plane, int shift, int i, int j) const {
    const int row = HWY_MIN(HWY_MAX((y >> shift) + j, 0), frame.frame.height - 1);
    const Int at = Int(hn::ShiftRightSame(hn::Iota(DI(), x), shift)) + Int(i);
    return hn::GatherIndex(D(), plane + std::ptrdiff_t(row) * frame.frame.stride,
                           clamp(at, Int(0), Int(frame.frame.width - 1)).v);
  }
  HWY_INLINE Bool inside(int i, int j) const {
    if (HWY_LIKELY(inner && unsigned(i + kMargin) <= 2u * kMargin && unsigned(j + kMargin) <= 2u * kMargin))
      return Int(0) == Int(0);
    const Int columns = scattered ? column + Int(i) : Int(hn::Iota(DI(), x + i));
    const Int rows = scattered ? row + Int(j) : Int(y + j);
    return columns >= Int(0) && columns < Int(frame.frame.width) && rows >= Int(0) && rows < Int(frame.frame.height);
  }
  HWY_INLINE void store(float* plane, Real v) const {
    if (HWY_UNLIKELY(scattered))
      scatter(plane, v);
    else
      hn::StoreU(v.v, D(), plane + here);
  }
  HWY_NOINLINE void scatter(float* plane, Real v) const {
    hn::ScatterIndex(v.v, D(), plane, (row * Int(frame.frame.stride) + column).v);
  }
};

/// Iterates over the pixels of a tile, kLanes at a time: over its rows or, if FrameConstants::missing is set, over the
/// pixels where `ao` is kMissing, wherever they are. If fewer than kLanes of these are left, the remaining lanes repeat
/// the last one: they compute the same value and store it to the same place.
class TilePixels {
 public:
  TilePixels(const KernelFrame& frame, const Tile& tile)
      : packs(frame.frame.missing != 0), frame_(frame), tile_(tile), column_(tile.x0), row_(tile.y0) {}

  const bool packs;
  int y = 0, x = 0, end = 0;  // the current row: columns x to end (exclusive)
  Int columns = 0, rows = 0;  // the current packed pixels; x and end then make the caller take one step

  /// Moves to the next row or the next packed pixels; returns false after the last.
  HWY_NOINLINE bool next() {
    if (packs) return pack();
    if (row_ >= tile_.y1) return false;
    y = row_++;
    x = tile_.x0;
    end = tile_.x1;
    return true;
  }

 private:
  bool pack() {
    while (count_ < kLanes && row_ < tile_.y1) {
      take();
      column_ += kLanes;
      if (column_ < tile_.x1) continue;
      column_ = tile_.x0;
      ++row_;
    }
    if (count_ == 0) return false;
    for (int i = count_; i < kLanes; ++i) {
      found_columns_[i] = found_columns_[count_ - 1];
      found_rows_[i] = found_rows_[count_ - 1];
    }
    columns = to_signed(hn::Load(DU(), found_columns_));
    rows = to_signed(hn::Load(DU(), found_rows_));
    end = 1;
    hn::Store(hn::Load(DU(), found_columns_ + kLanes), DU(), found_columns_);
    hn::Store(hn::Load(DU(), found_rows_ + kLanes), DU(), found_rows_);
    count_ = HWY_MAX(count_ - kLanes, 0);
    return true;
  }

  /// Collects the pixels with kMissing among the next kLanes pixels.
  HWY_INLINE void take() {
    const Int here = hn::Iota(DI(), column_);
    const auto ao = hn::LoadU(D(), frame_.ao + std::ptrdiff_t(row_) * frame_.frame.stride + column_);
    const Bool missing = Bool{hn::Ge(ao, hn::Set(D(), kMissing))} && here < Int(tile_.x1);
    if (HWY_LIKELY(!some(missing))) return;
    hn::StoreU(packed(missing, to_uint(here)).v, DU(), found_columns_ + count_);
    hn::StoreU(to_uint(Int(row_)).v, DU(), found_rows_ + count_);
    count_ += count_lanes(missing);
  }

  const KernelFrame& frame_;
  const Tile& tile_;
  int column_, row_;  // the next pixel to be examined
  int count_ = 0;     // pixels collected and not yet returned
  HWY_ALIGN std::uint32_t found_columns_[2 * kLanes];
  HWY_ALIGN std::uint32_t found_rows_[2 * kLanes];
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace umbrage
HWY_AFTER_NAMESPACE();

#endif
