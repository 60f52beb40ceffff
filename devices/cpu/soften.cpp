#include "devices/cpu/soften.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "devices/shared/capture_info.h"
#include "devices/shared/dispatches.h"
#include "kernel/kernel_frame.h"

namespace umbrage {
namespace {

constexpr int kSegmentBlocks = 8;
constexpr int kSegment = kSegmentBlocks * kSoftenBlock;  // pixels of a row that are filtered together, or not at all

/// A flag for each segment of each row of blocks.
struct Segments {
  int columns, rows;
  std::vector<std::uint8_t> flags;

  Segments(int columns_, int rows_)
      : columns(columns_), rows(rows_), flags(std::size_t(columns_) * std::size_t(rows_)) {}
  std::uint8_t& at(int i, int j) { return flags[std::size_t(j) * std::size_t(columns) + std::size_t(i)]; }
  bool at(int i, int j) const { return flags[std::size_t(j) * std::size_t(columns) + std::size_t(i)] != 0; }
};

/// Returns the flags dilated by `aside` segments to both sides and `above` blocks up and down.
Segments dilated(const Segments& in, int aside, int above) {
  Segments out(in.columns, in.rows);
  for (int j = 0; j < in.rows; ++j)
    for (int i = 0; i < in.columns; ++i)
      if (in.at(i, j))
        for (int y = std::max(0, j - above); y <= std::min(in.rows - 1, j + above); ++y)
          for (int x = std::max(0, i - aside); x <= std::min(in.columns - 1, i + aside); ++x) out.at(x, y) = 1;
  return out;
}

/// Calls work(j) for all rows of blocks, on all threads.
template <class Work>
void for_block_rows(int rows, const Work& work) {
  tbb::parallel_for(tbb::blocked_range<int>(0, rows, 4), [&](const tbb::blocked_range<int>& range) {
    for (int j = range.begin(); j < range.end(); ++j) work(j);
  });
}

/// Returns flags for the segments in which a shadow changes, or differs from the adjacent pixels to the right or below.
Segments changing(const Plane& shadow) {
  Segments out((shadow.width + kSegment - 1) / kSegment, soften_blocks(shadow.height));
  for_block_rows(out.rows, [&](int j) {
    const int y0 = j * kSoftenBlock, y1 = std::min(y0 + kSoftenBlock + 1, shadow.height);
    for (int i = 0; i < out.columns; ++i) {
      const int x0 = i * kSegment, x1 = std::min(x0 + kSegment + 1, shadow.width);
      const float first = shadow.at(x0, y0);
      bool same = true;
      for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) same &= shadow.row(y)[x] == first;
      out.at(i, j) = !same;
    }
  });
  return out;
}

/// Returns the rows of blocks, counted from the first one in memory, whose `neighbours` rows above and below are in
/// memory or outside the picture.
Rows computable_blocks(int height, const Rows& rows, int neighbours) {
  return {rows.begin == 0 ? 0 : neighbours,
          rows.end == height ? soften_blocks(rows.count()) : rows.count() / kSoftenBlock - neighbours};
}

/// Returns the address of row 0 of a plane whose first row is row `first` of the picture.
float* data_of(const Plane& plane, int first = 0) {
  return row_zero(const_cast<float*>(plane.data()), plane.stride, first);  // a kernel stores only to its outputs
}

/// A kernel and its arguments, to run over the segments of a picture.
struct Run {
  FrameConstants frame;
  SoftenConstants constants;
  std::vector<KernelPlane> planes;
  CpuKernel kernel;
};

/// Runs the kernel on the flagged segments, in the rows of blocks that computable_blocks returns.
void run_segments(const Run& run, const Rows& rows, const Segments& where, int neighbours) {
  const KernelFrame frame{run.frame, &run.constants, run.planes};
  const Rows blocks = computable_blocks(run.frame.height, rows, neighbours);
  for_block_rows(where.rows, [&](int j) {
    if (j < blocks.begin || j >= blocks.end) return;
    const int y0 = rows.begin + j * kSoftenBlock, y1 = std::min(y0 + kSoftenBlock, rows.end);
    for (int i = 0; i < where.columns; ++i) {
      const int begin = i;
      while (i < where.columns && where.at(i, j)) ++i;
      if (i > begin) run.kernel(frame, {begin * kSegment, y0, std::min(i * kSegment, run.frame.width), y1});
    }
  });
}

}  // namespace

int soften_blocks(int pixels) { return (pixels + kSoftenBlock - 1) / kSoftenBlock; }

void soften_shadows(const PictureInfo& info, const Rows& rows, std::span<const PenumbraRadii> radii, bool scalar,
                    Image& image) {
  const auto kernel_of = [&](const Dispatch& dispatch) {
    return scalar ? dispatch.kernel.scalar : dispatch.kernel.lanes;
  };
  for (const PenumbraRadii& penumbrae : radii) {
    Plane& shadow = image.plane(shadow_plane(penumbrae.light));
    Plane between(shadow.width, shadow.height);
    Plane reach(shadow.width, soften_blocks(shadow.height), kSoftenMin);  // value where it is not computed
    Run run{.frame = frame_constants(info, shadow.stride, 0), .kernel = kernel_of(soften_dispatch())};
    // The filter along columns needs rows above and below that the filter along rows has processed.
    const auto filter = [&](bool second, bool down, const Segments& where) {
      run.constants = {.dx = down ? 0 : 1, .dy = down ? 1 : 0, .second = second ? 1 : 0};
      const int first = rows.begin;
      run.planes = {{"depth", data_of(image.plane("depth"), first)},
                    {"normal.x", data_of(image.plane("normal.x"), first)},
                    {"normal.y", data_of(image.plane("normal.y"), first)},
                    {"normal.z", data_of(image.plane("normal.z"), first)},
                    {"soften_from", data_of(down ? between : shadow, first)},
                    {"soften_to", data_of(down ? shadow : between, first)},
                    {"soften_reach", data_of(reach, first / kSoftenBlock)}};
      run_segments(run, rows, where, !down ? 0 : second ? kSoftenReachBlocks - 1 : 1);
    };
    const Segments changes = changing(shadow);
    const Segments near = dilated(changes, 1, 1);
    filter(false, false, dilated(near, 0, 1));
    filter(false, true, near);

    const Segments far = dilated(changes, 1, 1 + kSoftenReachBlocks);
    for (const bool down : {false, true}) {
      Run blocks{.frame = run.frame, .kernel = kernel_of(soften_reach_dispatch())};
      blocks.frame.width = soften_blocks(shadow.width);
      blocks.frame.height = soften_blocks(info.height);
      const int first = rows.begin / kSoftenBlock;
      blocks.planes = {{"penumbra", data_of(down ? penumbrae.down : penumbrae.across, first)},
                       {"soften_reach", data_of(reach, first)}};
      const KernelFrame frame{blocks.frame, &blocks.constants, blocks.planes};
      const Rows computable = computable_blocks(info.height, rows, kSoftenReachBlocks);
      for_block_rows(computable.end, [&](int j) {
        if (j >= computable.begin) blocks.kernel(frame, {0, first + j, blocks.frame.width, first + j + 1});
      });
      filter(true, down, down ? far : dilated(far, 0, kSoftenReachBlocks));
    }
  }
}

}  // namespace umbrage
