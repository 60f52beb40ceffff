// The direction of ambient light: open bits take the light that comes from their directions.
//
// Ambient light is a constant plus L(d) = l.d + d'Qd, spherical harmonics up to the second degree. In a slice with view
// direction V and unit vector o, at the angle t from V towards o,
//   L = (V'QV + o'Qo)/2 + cos(t) l.V + sin(t) l.o + cos(2t) (V'QV - o'Qo)/2 + sin(2t) V'Qo
// so that four sums over the bits suffice. `composite` adds ambient light times visibility. What is missing there is
//   (L of open bits) - visibility (L of all bits)
// in which the constant cancels. It is 0 where everything is open: open surfaces get no noise.
#include "kernel/sky.kernel.h"

// Sums over bits: their number, and of the angles t of their directions.
struct BitSums {
  Real count, cos1, sin1, cos2, sin2;
};

// The factors of these sums in L, for a colour channel in a slice.
FN BitSums sky_factors(int channel, Vec3 eye, Vec3 outwards) {
  Real along_eye = sky_quadratic(channel, eye, eye);
  Real along_slice = sky_quadratic(channel, outwards, outwards);
  return BitSums((along_eye + along_slice) * 0.5f, sky_linear(channel, eye), sky_linear(channel, outwards),
                 (along_eye - along_slice) * 0.5f, sky_quadratic(channel, eye, outwards));
}

// Returns L of bits with these sums.
FN Real sky_of(BitSums factors, BitSums sums) {
  Real first = mad(sums.cos1, factors.cos1, sums.sin1 * factors.sin1);
  Real second = mad(sums.cos2, factors.cos2, sums.sin2 * factors.sin2);
  return mad(sums.count, factors.count, first + second);
}

// The light of open bits and of all bits, times 32.
struct SkyLight {
  Vec3 open, all;
};

// Adds the light of the bits in `bits`, those of a slice or of one of its sides. `covered`: bits that are not open.
// `sn`: sine of the angle from the view direction to the normal's projection, towards `outwards`.
FN SkyLight with_sky_light(SkyLight sum, Uint bits, Uint covered, Real weight, Real sn, Vec3 eye, Vec3 outwards) {
  // The nearest row of the table, whose rows are in equal steps of that angle.
  Real angle = Real(1.57079633f) - angle_of_cosine(sn);
  Int row = clamp(to_int(mad(angle, Real(float(kBitmaskRows - 1) / 3.14159265f), Real(0.5f * float(kBitmaskRows)))),
                  Int(0), Int(kBitmaskRows - 1));
  Real none = Real(0.0f);
  BitSums open = BitSums(none, none, none, none, none);
  BitSums all = open;
  for (int g = 0; g < kBitmaskGroups; ++g) {
    Real count = to_real(popcount(((bits & ~covered) >> (4 * g)) & Uint(15u)));
    Real whole = to_real(popcount((bits >> (4 * g)) & Uint(15u)));
    Int at = row * Int(4 * kBitmaskGroups) + Int(4 * g);
    Real cos1 = entry_of(C.angles, at);
    Real sin1 = entry_of(C.angles, at + Int(1));
    Real cos2 = entry_of(C.angles, at + Int(2));
    Real sin2 = entry_of(C.angles, at + Int(3));
    open = BitSums(open.count + count, mad(count, cos1, open.cos1), mad(count, sin1, open.sin1),
                   mad(count, cos2, open.cos2), mad(count, sin2, open.sin2));
    all = BitSums(all.count + whole, mad(whole, cos1, all.cos1), mad(whole, sin1, all.sin1), mad(whole, cos2, all.cos2),
                  mad(whole, sin2, all.sin2));
  }
  BitSums red = sky_factors(0, eye, outwards);
  BitSums green = sky_factors(1, eye, outwards);
  BitSums blue = sky_factors(2, eye, outwards);
  Vec3 of_open = Vec3(sky_of(red, open), sky_of(green, open), sky_of(blue, open));
  Vec3 of_all = Vec3(sky_of(red, all), sky_of(green, all), sky_of(blue, all));
  return SkyLight(sum.open + of_open * weight, sum.all + of_all * weight);
}
