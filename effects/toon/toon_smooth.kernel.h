// Second dispatches of `toon`, once for each round: smooth light along the surface, [1 2 1]/4 along rows or columns.
// The distance of the neighbours halves from round to round and ends at one pixel; so the result varies smoothly from
// pixel to pixel, and the edges of tone steps have no small islands beside them. In the order of the a-trous filter of
// [Dammertz et al. 2010], the last round would leave the noise of its wide gaps.
//
// The key light's visibility is smoothed less, so that thin shadows remain.
// KERNEL toon_across: ALONG_ROWS=1 KEY=toon_key REST=toon_rest VISIBLE=toon_visible NEW_KEY=toon_row_key NEW_REST=toon_row_rest NEW_VISIBLE=toon_row_visible
// KERNEL toon_down: ALONG_ROWS=0 KEY=toon_row_key REST=toon_row_rest VISIBLE=toon_row_visible NEW_KEY=toon_key NEW_REST=toon_rest NEW_VISIBLE=toon_visible
IN_REAL_AS(source_key, KEY)
IN_REAL_AS(source_rest, REST)
IN_REAL_AS(source_visible, VISIBLE)
OUT_REAL_AS(new_key, NEW_KEY)
OUT_REAL_AS(new_rest, NEW_REST)
OUT_REAL_AS(new_visible, NEW_VISIBLE)
#include "kernel/joint.kernel.h"

CONST float kSide = 0.25f;        // weight of each neighbour
CONST float kTolerancePx = 1.0f;  // max distance of a neighbour from the pixel's plane, pixel sizes,
CONST float kCurved = 0.5f;       // and per pixel between the two: allows for curved surfaces
CONST float kTurn = 16.0f;        // full weight up to 20 degrees between the normals, none from 29 on

FN void toon_smooth_pixel(Int px, Int py) {
  int step = C.smooth_px >> F.round;
  step = step > 1 ? step : 1;
  int right = ALONG_ROWS == 1 ? step : 0;
  int down = ALONG_ROWS == 1 ? 0 : step;
  Real key = near_source_key(0, 0);
  Real rest = near_source_rest(0, 0);
  Real visible = near_source_visible(0, 0);
  if (some(is_surface(near_depth(0, 0)))) {
    Vec3 position = view_position(px, py, near_depth(0, 0));
    Vec3 normal = near_normal(0, 0);
    float tolerance = kTolerancePx + kCurved * float(step);
    Real before = joint_weight(-right, -down, px, py, position, normal, tolerance, kTurn) * kSide;
    Real after = joint_weight(right, down, px, py, position, normal, tolerance, kTurn) * kSide;
    key = mad(before, near_source_key(-right, -down) - key, mad(after, near_source_key(right, down) - key, key));
    rest = mad(before, near_source_rest(-right, -down) - rest, mad(after, near_source_rest(right, down) - rest, rest));
    if (step <= C.shadow_px)
      visible = mad(before, near_source_visible(-right, -down) - visible,
                    mad(after, near_source_visible(right, down) - visible, visible));
  }
  store_new_key(key);
  store_new_rest(rest);
  store_new_visible(visible);
}
