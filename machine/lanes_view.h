// The planes of a frame as lanes see them: this pixel and its right-hand neighbours. Included once per SIMD target.
#if defined(UMBRAGE_MACHINE_LANES_VIEW_H) == defined(HWY_TARGET_TOGGLE)
#ifdef UMBRAGE_MACHINE_LANES_VIEW_H
#undef UMBRAGE_MACHINE_LANES_VIEW_H
#else
#define UMBRAGE_MACHINE_LANES_VIEW_H
#endif

#include <cstddef>

#include "machine/kernel_frame.h"
#include "machine/lanes.h"

HWY_BEFORE_NAMESPACE();
namespace umbrage {
namespace HWY_NAMESPACE {
namespace {

// Neighbours up to so many pixels away are read without looking for the border, where it is farther.
constexpr int kMargin = 16;
// The same in blocks of up to 4 x 4 pixels, with room for the one that holds the pixel.
constexpr int kMarginBlocks = 3;

struct LanesView {
  const KernelFrame& frame;
  float real_stride = float(frame.frame.stride);
  // Floats hold all places in a plane.
  bool exact = (std::int64_t(frame.frame.height) + 1) * frame.frame.stride <= 1 << 24;
  int first_row = frame.first_row, last_row = HWY_MIN(frame.last_row, frame.frame.height - 1);
  int x = 0, y = 0;         // the first lane's pixel
  bool inner = false;       // all lanes lie kMargin or more inside the picture
  std::ptrdiff_t here = 0;  // of pixel (x, y) in a plane
  // Lanes are pixels from anywhere, these; x, y and here are then without meaning, and there is no corner and no block.
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
  HWY_INLINE void write(float* list, Real v) const { hn::StoreU(v.v, D(), list); }
  HWY_INLINE void write(std::uint32_t* list, Uint v) const { hn::StoreU(v.v, DU(), list); }
  HWY_INLINE Real listed(const float* list) const { return hn::LoadU(D(), list); }
  HWY_INLINE Uint listed(const std::uint32_t* list) const { return hn::LoadU(DU(), list); }
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
  // Loads by steps of f, 1, 2 or 4: lanes start at a multiple of it wherever they are as many as f.
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

/// The same where lanes are pixels from anywhere in the picture, always: neighbours are gathered. Of kernels that are
/// compiled for passes whose pixels are few, see Pass::packed. There is no corner and no block.
struct PackedView : LanesView {
  Int place = 0;  // of each pixel in a plane

  HWY_INLINE void move(int to_x, int to_y) { move_to(Int(hn::Iota(DI(), to_x)), Int(to_y)); }
  HWY_INLINE void move_to(Int columns, Int rows) {
    LanesView::move_to(columns, rows);
    place = rows * Int(frame.frame.stride) + columns;
    const Bool within = columns >= Int(kMargin) && columns < Int(frame.frame.width - kMargin) && rows >= Int(kMargin) &&
                        rows < Int(frame.frame.height - kMargin);
    inner = !some(!within);
  }
  HWY_INLINE Real near(const float* plane, int i, int j) const {
    const bool close = unsigned(i + kMargin) <= 2u * kMargin && unsigned(j + kMargin) <= 2u * kMargin;
    if (HWY_LIKELY(inner && close))
      return hn::GatherIndex(D(), plane + std::ptrdiff_t(j) * frame.frame.stride + i, place.v);
    return near_border(plane, i, j);
  }
  HWY_INLINE void store(float* plane, Real v) const { hn::ScatterIndex(v.v, D(), plane, place.v); }
};

/// Runs of a tile's pixels, each in one row: whole rows, or cells that are neighbours.
struct Stretches {
  const Tile& tile;
  int y = tile.y0;
  int x = 0, end = 0;
  int seen = 0;  // of row y: cells that have been looked at, or whether it has been

  /// The next one; false after the last.
  HWY_INLINE bool next() {
    for (; y < tile.y1; ++y, seen = 0) {
      if (!tile.cells) {
        if (seen++ > 0) continue;
        x = tile.x0;
        end = tile.x1;
        return true;
      }
      const int first = next_cell(seen, true);
      x = first * kTileCell;
      if (x >= tile.x1) continue;
      seen = next_cell(first, false);
      end = HWY_MIN(seen * kTileCell, tile.x1);
      return true;
    }
    return false;
  }

  /// The first cell from `cell` on that is set, or is not.
  HWY_INLINE int next_cell(int cell, bool set) const {
    const std::uint64_t* bits = tile.cells + std::ptrdiff_t(y - tile.y0) * tile.words;
    while (cell < tile.words * 64) {
      const std::uint64_t rest = (set ? bits[cell / 64] : ~bits[cell / 64]) >> (cell % 64);
      if (rest != 0) return cell + int(hwy::Num0BitsBelowLS1Bit_Nonzero64(rest));
      cell += 64 - cell % 64;
    }
    return cell;
  }
};

/// What a tile computes, in steps of kLanes pixels: runs of its pixels or, wherever they are, those where `ao` is
/// kMissing or any of KernelFrame::packed_by is not 0. Those where the first of these is not 0 run together, and so do
/// the others, since kernels often ask one plane after the other. Where fewer are left than lanes, the last of them
/// stands in all other lanes: they compute the same, and store it to the same place.
class TilePixels {
 public:
  TilePixels(const KernelFrame& frame, const Tile& tile)
      : packs(frame.frame.missing != 0 || !frame.packed_by.empty()), frame_(frame), stretches_{tile} {}

  const bool packs;
  int y = 0, x = 0, end = 0;  // of a run
  Int columns = 0, rows = 0;  // of packed pixels, for which x to end is one step

  /// The next run or packed pixels; false after the last.
  HWY_NOINLINE bool next() {
    if (packs) return pack();
    if (!stretches_.next()) return false;
    y = stretches_.y;
    x = stretches_.x;
    end = stretches_.end;
    return true;
  }

 private:
  /// Pixels found, and not yet handed out.
  struct Queue {
    int count = 0;
    HWY_ALIGN std::uint32_t columns[2 * kLanes];
    HWY_ALIGN std::uint32_t rows[2 * kLanes];

    HWY_INLINE void add(Bool where, Uint x, Uint y) {
      hn::StoreU(packed(where, x).v, DU(), columns + count);
      hn::StoreU(y.v, DU(), rows + count);
      count += how_many(where);
    }
  };

  bool pack() {
    for (; first_.count < kLanes && others_.count < kLanes; at_ += kLanes) {
      if (at_ >= stretches_.end) {
        if (!stretches_.next()) break;
        at_ = stretches_.x;
      }
      take_from(at_);
    }
    Queue& queue = first_.count >= kLanes || others_.count == 0 ? first_ : others_;
    if (queue.count == 0) return false;
    for (int i = queue.count; i < kLanes; ++i) {
      queue.columns[i] = queue.columns[queue.count - 1];
      queue.rows[i] = queue.rows[queue.count - 1];
    }
    columns = to_signed(hn::Load(DU(), queue.columns));
    rows = to_signed(hn::Load(DU(), queue.rows));
    end = 1;
    hn::Store(hn::Load(DU(), queue.columns + kLanes), DU(), queue.columns);
    hn::Store(hn::Load(DU(), queue.rows + kLanes), DU(), queue.rows);
    queue.count = HWY_MAX(queue.count - kLanes, 0);
    return true;
  }

  HWY_INLINE void take_from(int from) {
    const std::ptrdiff_t here = std::ptrdiff_t(stretches_.y) * frame_.frame.stride + from;
    const Int x_here = hn::Iota(DI(), from);
    const Uint y_here = to_uint(Int(stretches_.y));
    const Bool inside = x_here < Int(stretches_.tile.x1);
    if (frame_.frame.missing != 0) {
      const Bool missing = {hn::Ge(hn::LoadU(D(), frame_.ao + here), hn::Set(D(), kMissing))};
      if (HWY_UNLIKELY(some(missing))) first_.add(missing && inside, to_uint(x_here), y_here);
      return;
    }
    const auto by_first = hn::BitCast(DU(), hn::LoadU(D(), frame_.packed_by[0] + here));
    auto any = by_first;
    for (const float* plane : frame_.packed_by.subspan(1))
      any = hn::Or(any, hn::BitCast(DU(), hn::LoadU(D(), plane + here)));
    const Bool chosen = inside && !(to_signed(Uint(any)) == Int(0));
    if (HWY_LIKELY(!some(chosen))) return;
    const Bool in_first = chosen && !(to_signed(Uint(by_first)) == Int(0));
    first_.add(in_first, to_uint(x_here), y_here);
    others_.add(chosen && !in_first, to_uint(x_here), y_here);
  }

  const KernelFrame& frame_;
  Stretches stretches_;
  int at_ = 0;  // of the stretch
  Queue first_, others_;
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace umbrage
HWY_AFTER_NAMESPACE();

#endif
