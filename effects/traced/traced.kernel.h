// One pass of the filter. It averages the mean visibility of rays over five taps of a row or column, each with the
// number of its rays as a weight, up to kMaxTrust, times the joint weight. From the second round on, values that differ
// by more than chance explains are left out: rays are coin tosses, so a mean p of n of them has the deviation sqrt(p (1
// - p) / n). The kernel that includes this file must first define:
//   kAlongRows  whether the pass runs along rows (true) or columns (false)
//   open_at     returns the mean visibility of the pixel (i, j) to the right and below
//   rays_at     returns the number of rays behind that value
//   kLight      whether indirect light is filtered too
//   light_at    returns the mean light of the rays of that pixel; 0 without light (traced_no_light.kernel.h)
#include "kernel/joint.kernel.h"

// Max weight of a value, in rays. Values of more rays weigh alike: open surfaces, where filters gather many rays, would
// otherwise brighten corners, where they gather few.
CONST float kMaxTrust = 2.0f;

struct Filtered {
  Real open;
  Real rays;  // effective number: that of equally weighted rays with the same variance
  Vec3 light;
};

// Returns the variance of a mean of that many rays. Half a ray of either outcome is added, so that a few equal rays do
// not look certain.
FN Real variance(Real open, Real rays) {
  Real one_more = Real(1.0f) / (rays + 1.0f);
  Real p = mad(open, rays, Real(0.5f)) * one_more;
  return p * (Real(1.0f) - p) * one_more;
}

FN Filtered filtered(Int px, Int py) {
  int step = C.step[F.round];
  float deviations = C.deviations[F.round];
  Vec3 position = view_position(px, py, near_depth(0, 0));
  Vec3 normal = near_normal(0, 0);
  Real open = open_at(0, 0);
  Real rays = rays_at(0, 0);
  Real own_variance = variance(open, rays);
  Real change = Real(0.0f);  // a sum of differences, so that a constant stays bitwise identical
  Real weight_sum = min(rays, Real(kMaxTrust));
  Real square_sum = weight_sum * weight_sum / max(rays, Real(1e-12f));
  Vec3 light = light_at(0, 0);
  Vec3 light_sum = light;
  if (kLight) light_sum = light_sum * weight_sum;
  for (int k = -2; k <= 2; ++k) {
    if (k == 0) continue;
    float tap = k == -1 || k == 1 ? C.near_weight[F.round] : C.far_weight[F.round];
    if (tap == 0.0f) continue;
    int i = kAlongRows ? k * step : 0;
    int j = kAlongRows ? 0 : k * step;
    Real weight = joint_weight(i, j, px, py, position, normal, C.distance, C.turn) * Real(tap);
    Real there = open_at(i, j);
    Real rays_there = rays_at(i, j);
    if (deviations > 0.0f) {
      // Of both values, so that two pixels weigh each other alike: else dark ones would take from bright ones only.
      Real both = (own_variance + variance(there, rays_there)) * Real(deviations * deviations);
      weight = weight * clamp(Real(2.0f) - abs(there - open) * rsqrt(both + 1e-12f), Real(0.0f), Real(1.0f));
    }
    weight = weight * min(rays_there, Real(kMaxTrust));
    change = mad(weight, there - open, change);
    weight_sum = weight_sum + weight;
    if (kLight) light_sum = light_sum + light_at(i, j) * weight;
    square_sum = mad(weight, weight / max(rays_there, Real(1e-12f)), square_sum);
  }
  Bool some_rays = weight_sum > 0.0f;
  Real inverse_sum = Real(1.0f) / max(weight_sum, Real(1e-12f));
  if (kLight) {
    light = select(some_rays, light_sum * inverse_sum, light);
    if (C.light_only[F.round] != 0) return Filtered(open, rays, light);
  }
  return Filtered(mad(change, inverse_sum, open),
                  select(some_rays, weight_sum * weight_sum / max(square_sum, Real(1e-12f)), Real(0.0f)), light);
}
