// Averages the mean visibility of rays, and with LIGHT their light, over five taps of a row or column. The weight of a
// tap is its confidence, n / (n + 1) for n rays, times the joint weight. Where `deviations` is set, values that differ
// by more than chance explains are left out: rays are coin tosses, so the mean p of n rays has a standard deviation of
// sqrt(p (1 - p) / n).
// KERNEL traced_across: ALONG_ROWS=1 LIGHT=0 OPEN=ao NEW_OPEN=traced_across CONFIDENCE=traced_confidence NEW_CONFIDENCE=traced_across_confidence
// KERNEL traced_down: ALONG_ROWS=0 LIGHT=0 OPEN=traced_across NEW_OPEN=ao CONFIDENCE=traced_across_confidence NEW_CONFIDENCE=traced_confidence
// KERNEL traced_light_across: ALONG_ROWS=1 LIGHT=1 OPEN=ao NEW_OPEN=traced_across CONFIDENCE=traced_confidence NEW_CONFIDENCE=traced_across_confidence INDIRECT=indirect NEW_INDIRECT=traced_light
// KERNEL traced_light_down: ALONG_ROWS=0 LIGHT=1 OPEN=traced_across NEW_OPEN=ao CONFIDENCE=traced_across_confidence NEW_CONFIDENCE=traced_confidence INDIRECT=traced_light NEW_INDIRECT=indirect
IN_REAL_AS(source_open, OPEN)
IN_REAL_AS(source_confidence, CONFIDENCE)
IN_COLOR_IF(LIGHT, source_light, INDIRECT)
OUT_REAL_AS(new_open, NEW_OPEN)
OUT_REAL_AS(new_confidence, NEW_CONFIDENCE)
OUT_COLOR_IF(LIGHT, new_light, NEW_INDIRECT)
CONST bool kAlongRows = ALONG_ROWS == 1;
CONST bool kLight = LIGHT == 1;

#include "effects/traced/joints.kernel.h"

// Return the mean visibility of the rays of the pixel (i, j) to the right and below, its confidence, and their light.
FN Real open_at(int i, int j) { return near_source_open(i, j); }
FN Real confidence_at(int i, int j) { return near_source_confidence(i, j); }
FN Vec3 light_at(int i, int j) { return near_source_light(i, j); }

// Returns the variance of a mean of rays. Half a ray of either outcome is added, so that a few equal rays do not look
// certain.
FN Real variance(Real open, Real confidence) {
  Real doubt = Real(1.0f) - confidence;
  Real p = mad(doubt, Real(0.5f) - open, open);
  return p * (Real(1.0f) - p) * doubt;
}

FN void traced_filter_pixel(Int px, Int py) {
  float deviations = C.deviations[F.round];
  Real joints = near_traced_joints(0, 0);
  Real open = open_at(0, 0);
  Real confidence = confidence_at(0, 0);
  Real own_variance = variance(open, confidence);
  Real change = Real(0.0f);  // a sum of differences, so that a constant stays bitwise identical
  Real weight_sum = confidence;
  Real square_sum = confidence * (Real(1.0f) - confidence);  // of squared weights, each divided by its rays
  Vec3 light = light_at(0, 0);
  Vec3 light_sum = light;
  if (kLight) light_sum = light_sum * weight_sum;
  for (int tap = 0; tap < 2; ++tap) {
    float scale = (tap == 0 ? C.near_weight[F.round] : C.far_weight[F.round]) / float(kMaxJoint);
    if (scale == 0.0f) continue;
    int power = C.power[F.round] + tap;
    for (int side = -1; side <= 1; side += 2) {
      int i = kAlongRows ? side * (1 << power) : 0;
      int j = kAlongRows ? 0 : side * (1 << power);
      Real joint = (side < 0 ? joint_before(power, kAlongRows) : joint_of(joints, power, kAlongRows)) * Real(scale);
      Real there = open_at(i, j);
      Real confidence_there = confidence_at(i, j);
      if (deviations > 0.0f) {
        // Of both values, so that two pixels weigh each other alike: else dark ones would take from bright ones only.
        Real both = (own_variance + variance(there, confidence_there)) * Real(deviations * deviations);
        joint = joint * clamp(Real(2.0f) - abs(there - open) * rsqrt(both + 1e-12f), Real(0.0f), Real(1.0f));
      }
      Real weight = joint * confidence_there;
      change = mad(weight, there - open, change);
      weight_sum = weight_sum + weight;
      if (kLight) light_sum = light_sum + light_at(i, j) * weight;
      square_sum = mad(joint * weight, Real(1.0f) - confidence_there, square_sum);
    }
  }
  Bool some_rays = weight_sum > 0.0f;
  Real inverse_sum = Real(1.0f) / max(weight_sum, Real(1e-12f));
  if (kLight) {
    light = select(some_rays, light_sum * inverse_sum, light);
  }
  // That of the number of equally weighted rays with the same variance.
  Real squared = weight_sum * weight_sum;
  bool light_only = kLight && C.light_only[F.round] != 0;
  store_new_open(light_only ? open : mad(change, inverse_sum, open));
  store_new_confidence(light_only ? confidence : squared / max(squared + square_sum, Real(1e-24f)));
  store_new_light(light);
}
