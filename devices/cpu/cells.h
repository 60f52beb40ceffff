// Cells of sparse planes: which of them a pass has to compute, and keeping them true.
#pragma once
#include <cstdint>
#include <span>

#include "core/image.h"

namespace umbrage {

/// A sparse plane, and how far from a pixel it counts; in columns less than kCellsInWord cells.
struct NearCells {
  const Cells* cells;
  int columns, rows;
};

/// Sets those cells of row y near which any of the planes may hold something: `near` has the row's words.
void find_near_cells(std::span<const NearCells> planes, int y, std::uint64_t* near);

/// Makes the kept cells of row y the plane's. The pixels of all others are 0 then or, if `clear_kept`, all are.
void keep_cells(Plane& plane, int y, const std::uint64_t* kept, bool clear_kept);

/// Leaves of the plane's cells of row y those that hold something.
void note_cells(Plane& plane, int y);

/// Makes all cells of row y the plane's.
void keep_all_cells(Plane& plane, int y);

}  // namespace umbrage
