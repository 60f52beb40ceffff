#include "devices/cpu/soften.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "devices/shared/passes.h"
#include "devices/shared/soften_passes.h"
#include "machine/kernel_frame.h"

namespace umbrage {
namespace {

constexpr int kSegmentBlocks = 8;
constexpr int kSegment = kSegmentBlocks * kSoftenBlock;  // pixels of a row that are filtered together, or not at all

/// Something that holds or not for each segment of each row of blocks.
struct Segments {
  int columns, rows;
  std::vector<std::uint8_t> holds;

  Segments(int columns_, int rows_)
      : columns(columns_), rows(rows_), holds(std::size_t(columns_) * std::size_t(rows_)) {}
  std::uint8_t& at(int i, int j) { return holds[std::size_t(j) * std::size_t(columns) + std::size_t(i)]; }
  bool at(int i, int j) const { return holds[std::size_t(j) * std::size_t(columns) + std::size_t(i)] != 0; }
};

/// What holds up to so many segments aside or blocks above and below.
Segments around(const Segments& in, int aside, int above) {
  Segments out(in.columns, in.rows);
  for (int j = 0; j < in.rows; ++j)
    for (int i = 0; i < in.columns; ++i)
      if (in.at(i, j))
        for (int y = std::max(0, j - above); y <= std::min(in.rows - 1, j + above); ++y)
          for (int x = std::max(0, i - aside); x <= std::min(in.columns - 1, i + aside); ++x) out.at(x, y) = 1;
  return out;
}

/// Calls work(j) for all rows of blocks, from all threads.
template <class Work>
void over_rows(int rows, const Work& work) {
  tbb::parallel_for(tbb::blocked_range<int>(0, rows, 4), [&](const tbb::blocked_range<int>& range) {
    for (int j = range.begin(); j < range.end(); ++j) work(j);
  });
}

/// Where a shadow changes, and must be looked at: within a segment, or from it to the next one, aside or below.
Segments changing(const Plane& shadow) {
  Segments out((shadow.width + kSegment - 1) / kSegment, soften_blocks(shadow.height));
  over_rows(out.rows, [&](int j) {
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

/// One run of a pass over the segments of a picture.
struct Run {
  FrameConstants frame;
  SoftenConstants constants;
  std::vector<KernelPlane> planes;
  CpuKernel kernel;
};

void run_segments(const Run& run, const Segments& where) {
  const KernelFrame frame{run.frame, &run.constants, run.planes};
  over_rows(where.rows, [&](int j) {
    const int y0 = j * kSoftenBlock, y1 = std::min(y0 + kSoftenBlock, run.frame.height);
    for (int i = 0; i < where.columns; ++i) {
      const int begin = i;
      while (i < where.columns && where.at(i, j)) ++i;
      if (i > begin) run.kernel(frame, {begin * kSegment, y0, std::min(i * kSegment, run.frame.width), y1});
    }
  });
}

float* data_of(const Plane& plane) { return const_cast<float*>(plane.data()); }  // a kernel stores to its outputs alone

}  // namespace

int soften_blocks(int pixels) { return (pixels + kSoftenBlock - 1) / kSoftenBlock; }

void soften_shadows(const PictureInfo& info, std::span<const PenumbraRadii> radii, bool scalar, Image& image) {
  const auto kernel_of = [&](const Pass& pass) { return scalar ? pass.scalar : pass.lanes; };
  for (const PenumbraRadii& of : radii) {
    Plane& shadow = image.plane(shadow_plane(of.light));
    Plane between(shadow.width, shadow.height), reach(shadow.width, soften_blocks(shadow.height));
    Run run{.frame = frame_constants(info, shadow.stride, 0), .kernel = kernel_of(soften_pass())};
    // What is filtered along columns needs rows above and below that are filtered along themselves.
    const auto filter = [&](bool second, bool down, const Segments& where) {
      run.constants = {.dx = down ? 0 : 1, .dy = down ? 1 : 0, .second = second ? 1 : 0};
      run.planes = {{"depth", data_of(image.plane("depth"))},
                    {"normal.x", data_of(image.plane("normal.x"))},
                    {"normal.y", data_of(image.plane("normal.y"))},
                    {"normal.z", data_of(image.plane("normal.z"))},
                    {"soften_from", down ? between.data() : shadow.data()},
                    {"soften_to", down ? shadow.data() : between.data()},
                    {"soften_reach", reach.data()}};
      run_segments(run, where);
    };
    const Segments changes = changing(shadow);
    const Segments near = around(changes, 1, 1);
    filter(false, false, around(near, 0, 1));
    filter(false, true, near);

    const Segments far = around(changes, 1, 1 + kSoftenBlocks);
    for (const bool down : {false, true}) {
      Run blocks{.frame = run.frame, .kernel = kernel_of(soften_reach_pass())};
      blocks.frame.width = soften_blocks(shadow.width);
      blocks.frame.height = soften_blocks(shadow.height);
      blocks.planes = {{"penumbra", data_of(down ? of.down : of.across)}, {"soften_reach", reach.data()}};
      const KernelFrame frame{blocks.frame, &blocks.constants, blocks.planes};
      over_rows(blocks.frame.height, [&](int j) { blocks.kernel(frame, {0, j, blocks.frame.width, j + 1}); });
      filter(true, down, down ? far : around(far, 0, kSoftenBlocks));
    }
  }
}

}  // namespace umbrage
