// Parallel loops over the rows of pictures.
#pragma once
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace umbrage {

/// Calls work(y) for all y from `begin` to `end` - 1, in parallel, in the caller's oneTBB arena.
template <class Work>
void for_rows(int begin, int end, const Work& work) {
  constexpr int kRowsAtOnce = 32;  // with fewer rows, scheduling costs more than copying
  tbb::parallel_for(tbb::blocked_range<int>(begin, end, kRowsAtOnce), [&](const tbb::blocked_range<int>& rows) {
    for (int y = rows.begin(); y < rows.end(); ++y) work(y);
  });
}

}  // namespace umbrage
