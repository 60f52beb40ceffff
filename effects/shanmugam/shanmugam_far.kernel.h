// The far part of `shanmugam`: coarse occluders, of which the part between near_radius and radius counts. Functions in
// the kernel dialect; the kernel includes this file.

// Returns the arc cosine of x in [0, 1], radians; error below 7e-5 [Abramowitz and Stegun 1964, 4.4.45].
FN Real arc_cosine_of_positive(Real x) {
  Real sum = mad(x, Real(-0.0187293f), Real(0.0742610f));
  sum = mad(sum, x, Real(-0.2121144f));
  sum = mad(sum, x, Real(1.5707288f));
  return sum * sqrt(max(1.0f - x, Real(0.0f)));
}
FN Real arc_cosine(Real x) {
  Real of_positive = arc_cosine_of_positive(min(abs(x), Real(1.0f)));
  return select(x < Real(0.0f), 3.14159265f - of_positive, of_positive);
}

// Returns the fraction of the hemisphere, weighted by cosine, that a sphere hides, above the horizon. `cosine` is that
// between the normal and the direction to its centre, h2 its squared distance in squared radii, above 1.
FN Real share_of_sphere(Real cosine, Real h2) {
  Real share = max(cosine, Real(0.0f)) / h2;
  Real above = 1.0f - h2 * cosine * cosine;  // > 0: the horizon cuts the sphere
  Bool cut = above > Real(0.0f);
  if (some(cut)) {
    Real tangent = sqrt(h2 - 1.0f);
    Real sine = sqrt(max(1.0f - cosine * cosine, Real(1e-12f)));
    Real way = tangent / sine;
    Real of_cut = cosine * arc_cosine(cosine * way * -1.0f) - sqrt(max(above, Real(0.0f))) * tangent;
    of_cut = of_cut / h2 + arc_cosine(way * rsqrt(h2));
    share = select(cut, max(of_cut * 0.318309886f, Real(0.0f)), share);
  }
  return share;
}

// Returns the fraction of a sphere, as seen from a point, that is farther away than `reach`. `distance` is that of its
// centre.
FN Real part_of_sphere_beyond(Real distance, Real radius2, float reach) {
  Real distance2 = distance * distance;
  Real c = (distance2 + reach * reach - radius2) / max(2.0f * reach * distance, Real(1e-30f));
  Real part = 1.0f - (distance2 - c * c * distance2) / radius2;
  part = select(distance2 - radius2 <= Real(reach * reach), Real(0.0f), clamp(part, Real(0.0f), Real(1.0f)));
  return select(distance - sqrt(radius2) >= Real(reach), Real(1.0f), part);
}

// Returns the fraction of a flat patch with this radius that is farther away than `reach`: a patch seen at an angle.
FN Real part_of_patch_beyond(Real distance, Real radius, float reach) {
  return clamp(mad((distance - reach) / radius, Real(0.5f), Real(0.5f)), Real(0.0f), Real(1.0f));
}

// Returns the fraction of the hemisphere, weighted by cosine, that one occluder hides. It is a flat one-sided disc with
// the area of the patch times the length of its mean normal, and a sphere with the remaining area.
FN Real share_of_patch(int first, Vec3 normal, Vec3 direction, Real distance) {
  float radius2 = C.set[first + 3];
  Vec3 mean = Vec3(Real(C.set[first + 4]), Real(C.set[first + 5]), Real(C.set[first + 6]));
  float flat2 = C.set[first + 4] * C.set[first + 4] + C.set[first + 5] * C.set[first + 5] +
                C.set[first + 6] * C.set[first + 6];
  Real patch_radius = sqrt(Real(radius2)) * 2.0f;
  Real part = part_of_patch_beyond(distance, patch_radius, C.near_radius) -
              part_of_patch_beyond(distance, patch_radius, C.radius);
  Real cosine = dot(normal, direction);
  Real share = Real(0.0f);
  if (some(part > Real(0.0f))) {
    Real flat_part = sqrt(Real(flat2));
    Real distance2 = distance * distance;
    Real area4 = 4.0f * radius2 * flat_part;  // over pi
    share = 4.0f * radius2 * max(dot(mean, direction) * -1.0f, Real(0.0f)) * max(cosine, Real(0.0f)) /
            (distance2 + area4);
    Real rest2 = radius2 * max(1.0f - flat_part, Real(1e-6f));
    share = share + share_of_sphere(cosine, max(distance2 / rest2, Real(1.0001f)));
    share = share * part;
  }
  return share;
}

// Returns the same of a sphere with the exact share and split, or by the formulas of the paper.
FN Real share_of_whole_sphere(int first, Vec3 normal, Vec3 direction, Real distance) {
  float radius2 = C.set[first + 3];
  Real distance2 = distance * distance;
  Real cosine = dot(normal, direction);
  if (C.far_form == kShanmugamPaper) {
    Real q2 = min(radius2 / max(distance2, Real(1e-30f)), Real(1.0f));
    Real share = 2.0f * (1.0f - sqrt(1.0f - q2)) * max(cosine, Real(0.0f));
    return select(distance >= Real(C.near_radius) && distance < Real(C.radius), share, Real(0.0f));
  }
  Real part = part_of_sphere_beyond(distance, Real(radius2), C.near_radius) -
              part_of_sphere_beyond(distance, Real(radius2), C.radius);
  if (!some(part > Real(0.0f))) return Real(0.0f);
  return part * share_of_sphere(cosine, max(distance2 / radius2, Real(1.0001f)));
}

// Returns the visibility past all occluders: the shares of one object add up, since its parts do not overlap much, and
// objects occlude independently.
FN Real far_visibility(Vec3 position, Vec3 normal) {
  Real visibility = Real(1.0f);
  Real sum = Real(0.0f);
  for (int i = 0; i < C.occluders; ++i) {
    int first = i * kShanmugamOccluderSize;
    Vec3 way = Vec3(Real(C.set[first]), Real(C.set[first + 1]), Real(C.set[first + 2])) - position;
    Real distance2 = max(dot(way, way), Real(1e-30f));
    Real one_over = rsqrt(distance2);
    Vec3 direction = way * one_over;
    Real distance = distance2 * one_over;
    Real share = C.far_form == kShanmugamPatch ? share_of_patch(first, normal, direction, distance)
                                               : share_of_whole_sphere(first, normal, direction, distance);
    sum = sum + select(distance2 < kMaxDistance2, share, Real(0.0f));
    if (C.set[first + 7] != 0.0f) {
      visibility = visibility * (1.0f - min(sum, Real(1.0f)));
      sum = Real(0.0f);
    }
  }
  return visibility;
}
