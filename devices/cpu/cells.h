// Cells of sparse planes: which of them a pass has to compute, and keeping them true.
#pragma once
#include <cstdint>
#include <span>

#include "core/image.h"

namespace umbrage {

/// A sparse plane, and how far from a pixel it counts.
struct NearCells {
  const Cells* cells;
  int columns, rows;
};

/// Sets those cells of row y near which any of the planes may hold something: `near` has the row's words.
void find_near_cells(std::span<const NearCells> planes, int y, std::uint64_t* near);

/// Sets the pixels of those cells of row y to 0 that are among the plane's own or, if `clear_kept`, that are kept, and
/// makes the kept ones the plane's.
void keep_cells(Plane& plane, int y, const std::uint64_t* kept, bool clear_kept);

/// Leaves of the plane's cells of row y those that hold something.
void note_cells(Plane& plane, int y);

/// Makes all cells of row y the plane's.
void keep_all_cells(Plane& plane, int y);

}  // namespace umbrage
