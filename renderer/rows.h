// Work on the rows of pictures by the threads of the caller's oneTBB arena.
#pragma once
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace umbrage {

/// Calls work(y) for all rows.
template <class Work>
void for_rows(int height, const Work& work) {
  constexpr int kRowsAtOnce = 32;  // fewer cost more to hand out than to copy
  tbb::parallel_for(tbb::blocked_range<int>(0, height, kRowsAtOnce), [&](const tbb::blocked_range<int>& rows) {
    for (int y = rows.begin(); y < rows.end(); ++y) work(y);
  });
}

}  // namespace umbrage
