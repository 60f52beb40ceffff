// Computes `unsharp` on the CPU at a cost that hardly grows with the window. The result is bitwise identical to that of
// unsharp.kernel.h, since sums of integer steps are exact in any order. There are two methods:
//   no threshold  running sums over columns and rows take the same few additions per pixel for any window
//   threshold     the window is divided into blocks of 16, 8 and 4 pixels with known min, max and sum: a block entirely
//                 within the threshold is added at once, one entirely outside is skipped, and any other is split
// A Gaussian window uses the plain kernel. docs/performance.md lists the measured times.
#include "effects/unsharp/unsharp.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>
#define UMBRAGE_KERNEL_CONSTANTS UnsharpConstants
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/unsharp/unsharp.tuned.cpp"
#include "hwy/foreach_target.h"
#include "kernel/lanes.h"
#include "kernel/lanes_view.h"

HWY_BEFORE_NAMESPACE();
namespace umbrage {
namespace HWY_NAMESPACE {
namespace {

// The functions of the kernel text.
struct Formulas {
  LanesView view;
#include "kernel/kernel_begin.h"

#include "effects/unsharp/unsharp.kernel.h"

#include "kernel/kernel_end.h"
};

using VI = hn::Vec<DI>;
using MI = hn::Mask<DI>;

// Marks a sample that never counts. It differs from every depth by more than any threshold.
constexpr std::int32_t kAbsent = 1 << 30;
constexpr int kSlack = 16;  // max number of elements that vectors read past the end of a row

// The samples of a tile and of its surroundings that windows contain, with the border mode applied.
struct Patch {
  int width = 0, height = 0, stride = 0;
  std::vector<std::int32_t> steps;
  const std::int32_t* row(int y) const { return steps.data() + std::ptrdiff_t(y) * stride; }
};

// Returns i modulo size, in [0, size).
int wrapped(int i, int size) {
  i %= size;
  return i < 0 ? i + size : i;
}

// Fills the patch of a tile.
void load_patch(const KernelFrame& frame, const UnsharpConstants& c, const Tile& tile, Patch& patch) {
  const FrameConstants& f = frame.frame;
  const float* plane = frame.plane("unsharp_depth");
  patch.width = tile.x1 - tile.x0 + c.last_column - c.first_column;
  patch.height = tile.y1 - tile.y0 + c.last_row - c.first_row;
  patch.stride = (patch.width + kSlack + 15) / 16 * 16;
  patch.steps.resize(std::size_t(patch.stride) * patch.height);
  const auto sample = [&](int x, int y) {
    const float v = plane[std::ptrdiff_t(y) * f.stride + x];
    return v >= 0.0f ? std::int32_t(v) : kAbsent;
  };
  const std::int32_t outside = c.border == kUnsharpBorderZero ? std::int32_t(c.border_depth) : kAbsent;
  const int left = tile.x0 + c.first_column;
  const int inside_begin = std::clamp(-left, 0, patch.width), inside_end = std::clamp(f.width - left, 0, patch.width);
  for (int r = 0; r < patch.height; ++r) {
    std::int32_t* out = patch.steps.data() + std::ptrdiff_t(r) * patch.stride;
    int y = tile.y0 + c.first_row + r;
    const bool above_or_below = y < 0 || y >= f.height;
    if (c.border == kUnsharpBorderClamp) y = std::clamp(y, 0, f.height - 1);
    if (c.border == kUnsharpBorderRepeat) y = wrapped(y, f.height);
    if (above_or_below && c.border < kUnsharpBorderClamp) {
      std::fill_n(out, patch.stride, outside);
      continue;
    }
    for (int i = inside_begin; i < inside_end; ++i) out[i] = sample(left + i, y);
    for (int i = 0; i < patch.width; ++i) {
      if (i == inside_begin) i = inside_end;
      if (i >= patch.width) break;
      if (c.border < kUnsharpBorderClamp)
        out[i] = outside;
      else
        out[i] = sample(
            c.border == kUnsharpBorderClamp ? std::clamp(left + i, 0, f.width - 1) : wrapped(left + i, f.width), y);
    }
    std::fill(out + patch.width, out + patch.stride, kAbsent);
  }
}

// Returns a mask of the pixels whose depth is finite.
template <class DInt>
HWY_INLINE hn::Mask<DInt> surface_at(DInt di, const float* depth) {
  const hn::RebindToFloat<DInt> d;
  return hn::RebindMask(di, hn::Le(hn::Abs(hn::LoadU(d, depth)), hn::Set(d, 3.402823466e38f)));
}

// The results for one row of a tile: the excess of the windows (see the kernel text), split into the multiple of 4096
// and the remainder, and their numbers of samples.
struct Row {
  std::vector<float> upper, lower, count;
  explicit Row(int columns)
      : upper(columns + kSlack, 0.0f), lower(columns + kSlack, 0.0f), count(columns + kSlack, 1.0f) {}
};

// Stores a row into `ao` by the formulas of the kernel text; 1 where there is no surface.
void store_row(Formulas& formulas, const Row& row, int columns, const float* depth, float* ao) {
  const D d;
  for (int x = 0; x < columns; x += kLanes) {
    const Real excess = formulas.excess_of(hn::LoadU(d, row.upper.data() + x), hn::LoadU(d, row.lower.data() + x));
    const Real value = formulas.ao_from_excess(excess, hn::LoadU(d, row.count.data() + x));
    const Bool surface{hn::RebindMask(d, surface_at(DI(), depth + x))};
    hn::StoreU(select(surface, value, Real(1.0f)).v, d, ao + x);
  }
}

// ---- no threshold
// ----------------------------------------------------------------------------------------------------

// Returns a number that represents one sample and can be added: the count in the upper 20 bits, the depth in the
// lower 44. The sum of 1023 x 1023 samples of 24 bits fits.
constexpr int kCountShift = 44;
HWY_INLINE std::uint64_t packed(std::int32_t steps) {
  return steps == kAbsent ? 0 : (std::uint64_t(1) << kCountShift) + std::uint64_t(steps);
}

void RunWithoutThreshold(const KernelFrame& frame, const Tile& tile, Formulas& formulas, const Patch& patch) {
  const int rows = tile.y1 - tile.y0, columns = tile.x1 - tile.x0;
  const int window_rows = patch.height - rows + 1, window_columns = patch.width - columns + 1;
  std::vector<std::uint64_t> column(patch.width, 0), before(patch.width + 1, 0);
  Row row(columns);
  const float* depth = frame.plane("depth");
  float* ao = frame.plane("ao");
  for (int y = 0; y < window_rows - 1; ++y)
    for (int x = 0; x < patch.width; ++x) column[x] += packed(patch.row(y)[x]);
  for (int y = 0; y < rows; ++y) {
    const std::int32_t* entering = patch.row(y + window_rows - 1);
    for (int x = 0; x < patch.width; ++x) column[x] += packed(entering[x]);
    for (int x = 0; x < patch.width; ++x) before[x + 1] = before[x] + column[x];
    const std::int32_t* centre = patch.row(y - formulas.C.first_row) - formulas.C.first_column;
    for (int x = 0; x < columns; ++x) {
      const std::uint64_t window = before[x + window_columns] - before[x];
      const std::int64_t samples = std::int64_t(window >> kCountShift);
      const std::int64_t sum = std::int64_t(window & ((std::uint64_t(1) << kCountShift) - 1));
      const std::int64_t excess = sum - samples * (centre[x] == kAbsent ? 0 : centre[x]);
      row.upper[x] = float(excess >> 12);
      row.lower[x] = float(excess & 4095);
      row.count[x] = float(std::max<std::int64_t>(samples, 1));
    }
    const std::size_t at = std::size_t(tile.y0 + y) * frame.frame.stride + tile.x0;
    store_row(formulas, row, columns, depth + at, ao + at);
    const std::int32_t* leaving = patch.row(y);
    for (int x = 0; x < patch.width; ++x) column[x] -= packed(leaving[x]);
  }
}

// ---- threshold
// -------------------------------------------------------------------------------------------------------

// The min, max and sum of a block of size x size samples, for each sample of a patch as its upper left one. The sum may
// overflow in blocks that contain absent samples; it is not used there.
struct Level {
  std::vector<std::int32_t> min, max, sum;
};

// Computes a level from the next finer one, whose blocks have the side `half`.
void compute_level(const std::int32_t* min, const std::int32_t* max, const std::int32_t* sum, int stride, int height,
                   int half, Level& out) {
  const DI di;
  const std::size_t count = std::size_t(stride) * height;
  for (auto* plane : {&out.min, &out.max, &out.sum}) plane->resize(count);
  // The last rows and columns remain undefined: their blocks extend past the patch and are never read.
  const std::size_t down = std::size_t(half) * stride;
  const std::size_t end = count > down + half + kSlack ? count - down - half - kSlack : 0;
  for (std::size_t i = 0; i < end; i += kLanes) {
    const auto at = [&](const std::int32_t* p, std::size_t k) { return hn::LoadU(di, p + i + k); };
    hn::StoreU(hn::Min(hn::Min(at(min, 0), at(min, half)), hn::Min(at(min, down), at(min, down + half))), di,
               out.min.data() + i);
    hn::StoreU(hn::Max(hn::Max(at(max, 0), at(max, half)), hn::Max(at(max, down), at(max, down + half))), di,
               out.max.data() + i);
    hn::StoreU(hn::Add(hn::Add(at(sum, 0), at(sum, half)), hn::Add(at(sum, down), at(sum, down + half))), di,
               out.sum.data() + i);
  }
}

constexpr int kLevels = 5;  // block sides 1, 2, 4, 8, 16

struct Block {
  int x, y, level;  // position in the window; the side is 2^level
};

// Divides a rectangle of a window into blocks, as many as possible of the given level and the rest of lower levels, and
// appends these to `blocks`.
void cover(int x, int y, int width, int height, int level, std::vector<Block>& blocks) {
  if (width <= 0 || height <= 0) return;
  const int size = 1 << level;
  const int across = width / size, down = height / size;
  for (int j = 0; j < down; ++j)
    for (int i = 0; i < across; ++i) blocks.push_back({x + i * size, y + j * size, level});
  if (level == 0) return;
  cover(x + across * size, y, width - across * size, down * size, level - 1, blocks);
  cover(x, y + down * size, width, height - down * size, level - 1, blocks);
}

struct Pyramid {
  Patch patch;
  Level levels[kLevels];  // levels[0] is the patch itself and stays empty
};

// The sums of the windows of one vector of pixels. A sample is added as its difference to low = centre - reach. As an
// unsigned number, this is at most 2 reach exactly if the sample counts. Since SIMD compares signed numbers, the
// difference is computed to low + 2^31 instead; flush() corrects the top bit after an odd number of samples.
struct Sums {
  VI low, high, reach;
  VI biased_low;               // low + 2^31
  VI biased_span;              // 2 reach - 2^31
  VI excess = hn::Zero(DI());  // sum of (sample - low) since the last flush
  VI top = hn::Zero(DI()), upper = hn::Zero(DI()), lower = hn::Zero(DI());  // multiples of 2^28, 2^12 and 1
  VI count = hn::Zero(DI()), flushed = hn::Zero(DI());
};

// Adds `excess` to the sums of higher precision and resets it.
HWY_INLINE void flush(Sums& s) {
  const DI di;
  const VI added = hn::Sub(s.count, s.flushed);
  s.flushed = s.count;
  // Converts biased differences to `low` into differences to the centre.
  s.excess = hn::Sub(s.excess, hn::Add(hn::ShiftLeft<31>(added), hn::Mul(added, s.reach)));
  s.upper = hn::Add(s.upper, hn::ShiftRight<12>(s.excess));
  s.lower = hn::Add(s.lower, hn::And(s.excess, hn::Set(di, 4095)));
  s.top = hn::Add(s.top, hn::ShiftRight<16>(s.upper));
  s.upper = hn::And(s.upper, hn::Set(di, 0xffff));
  s.excess = hn::Zero(di);
}

HWY_INLINE void add_sample(Sums& s, MI mask, const std::int32_t* steps) {
  const VI distance = hn::Sub(hn::LoadU(DI(), steps), s.biased_low);
  const MI counts = hn::AndNot(hn::Gt(distance, s.biased_span), mask);
  s.excess = masked_add(counts, s.excess, distance);
  s.count = masked_add(counts, s.count, hn::Set(DI(), 1));
}

// Adds a block. Blocks of level 0 and 1 are added sample by sample.
template <int kLevel>
HWY_INLINE void add_block(Sums& s, MI mask, const Pyramid& p, std::ptrdiff_t at) {
  const DI di;
  constexpr int kSize = 1 << kLevel;
  if constexpr (kLevel <= 1) {
    for (int j = 0; j < kSize; ++j)
      for (int i = 0; i < kSize; ++i)
        add_sample(s, mask, p.patch.steps.data() + at + std::ptrdiff_t(j) * p.patch.stride + i);
  } else {
    const Level& level = p.levels[kLevel];
    const VI min = hn::LoadU(di, level.min.data() + at);
    const VI max = hn::LoadU(di, level.max.data() + at);
    const MI outside = hn::Or(hn::Lt(max, s.low), hn::Gt(min, s.high));
    const MI beyond = hn::Or(hn::Lt(min, s.low), hn::Gt(max, s.high));
    const MI whole = hn::And(mask, hn::Not(beyond));
    const VI sum = hn::Sub(hn::LoadU(di, level.sum.data() + at), hn::ShiftLeft<2 * kLevel>(s.low));
    s.excess = masked_add(whole, s.excess, sum);
    s.count = masked_add(whole, s.count, hn::Set(di, kSize * kSize));
    const MI mixed = hn::And(mask, hn::And(beyond, hn::Not(outside)));
    if (hn::AllFalse(di, mixed)) return;
    if constexpr (kLevel == 2) {
      // Blocks of level 1 are not tested: that would cost more than it saves.
      for (int j = 0; j < kSize; ++j)
        for (int i = 0; i < kSize; ++i)
          add_sample(s, mixed, p.patch.steps.data() + at + std::ptrdiff_t(j) * p.patch.stride + i);
    } else {
      constexpr int kHalf = kSize / 2;
      const std::ptrdiff_t down = std::ptrdiff_t(kHalf) * p.patch.stride;
      add_block<kLevel - 1>(s, mixed, p, at);
      add_block<kLevel - 1>(s, mixed, p, at + kHalf);
      add_block<kLevel - 1>(s, mixed, p, at + down);
      add_block<kLevel - 1>(s, mixed, p, at + down + kHalf);
    }
  }
}

void RunThreshold(const KernelFrame& frame, const Tile& tile, Formulas& formulas, Pyramid& p, int reach) {
  const DI di;
  const Patch& patch = p.patch;
  const int side = patch.width - (tile.x1 - tile.x0) + 1;
  // 32 bits do not overflow with 256 samples up to 2^22 above `low`, or with 64 samples at any distance.
  constexpr int kFarReach = 1 << 21;
  const int coarsest = reach < kFarReach ? kLevels - 1 : kLevels - 2;
  int top = 0;
  while (top < coarsest && (2 << top) <= side) ++top;
  const std::int32_t *min = patch.steps.data(), *max = min, *sum = min;
  for (int level = 1; level <= top; ++level) {
    compute_level(min, max, sum, patch.stride, patch.height, 1 << (level - 1), p.levels[level]);
    min = p.levels[level].min.data();
    max = p.levels[level].max.data();
    sum = p.levels[level].sum.data();
  }
  std::vector<Block> blocks;
  cover(0, 0, side, side, top, blocks);
  // Max number of samples that can be added without overflow of 32 bits.
  const int budget = int((std::int64_t(1) << 30) / (reach + 1)) - 1;

  const float* depth = frame.plane("depth");
  float* ao = frame.plane("ao");
  const int columns = tile.x1 - tile.x0;
  Row row(columns);
  const hn::RebindToFloat<DI> df;
  const VI reaches = hn::Set(di, reach), bias = hn::Set(di, std::numeric_limits<std::int32_t>::min());
  for (int y = 0; y < tile.y1 - tile.y0; ++y) {
    const std::size_t out = std::size_t(tile.y0 + y) * frame.frame.stride + tile.x0;
    for (int x = 0; x < columns; x += kLanes) {
      const MI surface = surface_at(di, depth + out + x);
      if (hn::AllFalse(di, surface)) continue;
      const VI centre = hn::LoadU(di, patch.row(y - formulas.C.first_row) - formulas.C.first_column + x);
      const VI low = hn::Sub(centre, reaches);
      Sums s{low, hn::Add(centre, reaches), reaches, hn::Add(low, bias), hn::Add(hn::Set(di, 2 * reach), bias)};
      int pending = 0;
      for (const Block& block : blocks) {
        const int samples = 1 << (2 * block.level);
        if (pending + samples > budget) {
          flush(s);
          pending = 0;
        }
        pending += samples;
        const std::ptrdiff_t at = std::ptrdiff_t(y + block.y) * patch.stride + x + block.x;
        switch (block.level) {
          case 4:
            add_block<4>(s, surface, p, at);
            break;
          case 3:
            add_block<3>(s, surface, p, at);
            break;
          case 2:
            add_block<2>(s, surface, p, at);
            break;
          case 1:
            add_block<1>(s, surface, p, at);
            break;
          default:
            add_block<0>(s, surface, p, at);
            break;
        }
      }
      flush(s);
      s.upper = hn::Add(s.upper, hn::ShiftRight<12>(s.lower));
      s.lower = hn::And(s.lower, hn::Set(di, 4095));
      // Only this sum is rounded, once, as in the kernel text, which converts `upper` at once.
      const auto upper = hn::Add(hn::Mul(hn::ConvertTo(df, s.top), hn::Set(df, 65536.0f)), hn::ConvertTo(df, s.upper));
      hn::StoreU(upper, df, row.upper.data() + x);
      hn::StoreU(hn::ConvertTo(df, s.lower), df, row.lower.data() + x);
      hn::StoreU(hn::ConvertTo(df, hn::Max(s.count, hn::Set(di, 1))), df, row.count.data() + x);
    }
    store_row(formulas, row, columns, depth + out, ao + out);
  }
}

void RunTuned(const KernelFrame& frame, const Tile& tile) {
  Formulas formulas{{frame}};
  const DI di;
  // In a tile without surfaces all results are 1.
  const float* depth = frame.plane("depth");
  bool empty = true;
  for (int y = tile.y0; y < tile.y1 && empty; ++y)
    for (int x = tile.x0; x < tile.x1 && empty; x += kLanes)
      empty = hn::AllFalse(di, surface_at(di, depth + std::size_t(y) * frame.frame.stride + x));
  if (empty) {
    float* ao = frame.plane("ao");
    for (int y = tile.y0; y < tile.y1; ++y)
      std::fill_n(ao + std::size_t(y) * frame.frame.stride + tile.x0, tile.x1 - tile.x0, 1.0f);
    return;
  }
  // Reused for all tiles, since allocating a megabyte per tile takes longer than filling it.
  static thread_local Pyramid pyramid;
  load_patch(frame, formulas.C, tile, pyramid.patch);
  if (formulas.C.threshold >= kUnsharpSteps)
    RunWithoutThreshold(frame, tile, formulas, pyramid.patch);
  else
    RunThreshold(frame, tile, formulas, pyramid, int(std::ceil(formulas.C.threshold)) - 1);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace umbrage
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace umbrage {
namespace {

HWY_EXPORT(RunTuned);
}  // namespace

void run_lanes_unsharp(const KernelFrame&, const Tile&);

void run_tuned_unsharp(const KernelFrame& frame, const Tile& tile) {
  const auto& c = *static_cast<const UnsharpConstants*>(frame.constants);
  if (c.gaussian != 0)
    run_lanes_unsharp(frame, tile);
  else
    HWY_DYNAMIC_DISPATCH(RunTuned)(frame, tile);
}

}  // namespace umbrage
#endif
