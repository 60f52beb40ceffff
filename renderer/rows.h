// Parallel loops over the rows of pictures, in the caller's oneTBB arena.
#pragma once
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace umbrage {

/// Calls work(y) for all y from 0 to height - 1, in parallel.
template <class Work>
void for_rows(int height, const Work& work) {
  constexpr int kRowsAtOnce = 32;  // with fewer rows, scheduling costs more than copying
  tbb::parallel_for(tbb::blocked_range<int>(0, height, kRowsAtOnce), [&](const tbb::blocked_range<int>& rows) {
    for (int y = rows.begin(); y < rows.end(); ++y) work(y);
  });
}

}  // namespace umbrage
