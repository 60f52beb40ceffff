// Repairs the edges of G-buffers whose depth, normals or ids were averaged over the area of a pixel, as colour is.
//
// At a depth discontinuity such an average belongs to neither surface: occlusion draws a fringe there, and lines are
// doubled. A mixed pixel is one whose depth lies between what the planes of two surfaces predict, each of which two
// pixels in one line with it show. It gets the depth, normal and ids of the surface that covers more of it, by linear
// extrapolation.
#pragma once
#include "core/image.h"
#include "core/strip.h"

namespace umbrage {

/// Rows above and below a pixel that repaired_rows reads.
inline constexpr int kRepairMargin = 5;

/// What repaired_rows changes.
struct EdgeRepair {
  bool depth = false;    ///< mixed pixels get depth, normal and ids of one surface
  bool normals = false;  ///< normals beside a depth discontinuity that mix those of both sides

  bool any() const { return depth || normals; }
  bool operator==(const EdgeRepair&) const = default;
};

/// Depth discontinuities of a picture, from which `auto` decides.
struct EdgeCounts {
  long sharp = 0, mixed = 0;                  ///< with no mixed pixel between the surfaces, and with one
  long rough = 0;                             ///< as mixed, on surfaces that are rough themselves: no averages
  long clean_normals = 0, mixed_normals = 0;  ///< beside sharp ones: normals of the own surface, and mixed ones

  void add(const EdgeCounts& other);
  /// Returns what needs repair: most discontinuities are mixed. False where there are too few to tell.
  EdgeRepair needed() const;
};

/// Counts the discontinuities in these rows of a picture, which need not be all. `rows`: planes of core/gbuffer.h, at
/// least depth. `pixel_size`: width of a pixel at depth 1, or at any depth if `orthographic`.
EdgeCounts count_edges(const Image& rows, float pixel_size, bool orthographic);

/// Returns `rows` with the rows [own.begin, own.end), counted from the first of `rows`, repaired; the others are
/// removed. There must be kRepairMargin further rows on either side, except at the border of the picture. Planes other
/// than depth, normal.x, .y, .z, object_id and material_id are unchanged.
Image repaired_rows(const Image& rows, const Rows& own, const EdgeRepair& repair, float pixel_size, bool orthographic);

}  // namespace umbrage
