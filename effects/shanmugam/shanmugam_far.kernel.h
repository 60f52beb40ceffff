// The far part of `shanmugam`: coarse occluders, of which the part between near_radius and radius counts. Functions in
// the kernel dialect; the kernel includes this file.

CONST float kMaxCoordinate = 1e15f;    // squares of distances stay finite
CONST float kMinDistance2 = 1e-30f;  // instead of 0

// Returns the vector from a position to the centre of an occluder.
FN Vec3 way_to(int first, Vec3 position) {
  return Vec3(Real(C.set[first]), Real(C.set[first + 1]), Real(C.set[first + 2])) - position;
}

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
FN Real hidden_by_sphere(Real cosine, Real h2) {
  Real hides = max(cosine, Real(0.0f)) / h2;
  Real above = 1.0f - h2 * cosine * cosine;  // > 0: the horizon cuts the sphere
  Bool cut = above > Real(0.0f);
  if (some(cut)) {
    Real tangent = sqrt(h2 - 1.0f);
    Real sine = sqrt(max(1.0f - cosine * cosine, Real(1e-12f)));
    Real way = tangent / sine;
    Real of_cut = cosine * arc_cosine(cosine * way * -1.0f) - sqrt(max(above, Real(0.0f))) * tangent;
    of_cut = of_cut / h2 + arc_cosine(way * rsqrt(h2));
    hides = select(cut, max(of_cut * 0.318309886f, Real(0.0f)), hides);
  }
  return hides;
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

// Returns the fraction of a patch that is farther away than `reach`. `per_length` is the inverse of
// its diameter, or of 2 reach if that is less, so that nothing is nearer than 0.
FN Real part_of_patch_beyond(Real distance, float per_length, float reach) {
  return clamp(mad(distance - reach, Real(per_length), Real(0.5f)), Real(0.0f), Real(1.0f));
}

// Returns about what hidden_by_sphere does, for spheres that are not near: with t = h cosine, (1 + t)^2 / (4 h^3) where
// the horizon cuts the sphere, -1 < t < 1. `q` is the inverse of h.
FN Real roughly_hidden_by_sphere(Real cosine, Real q) {
  Real above = max(mad(cosine, Real(0.5f), q * 0.5f), Real(0.0f));  // (1 + t) q / 2
  return q * select(cosine >= q, q * cosine, above * above);
}

// Returns the fraction of the hemisphere, weighted by cosine, that one occluder hides. It is a flat one-sided disc with
// the area of the patch times the length of its mean normal, and a sphere with the remaining area.
FN Real hidden_by_patch(int first, Real cosine, Vec3 direction, Real distance, Real one_over) {
  Vec3 flat_part = Vec3(Real(C.set[first + kShanmugamFacing]), Real(C.set[first + kShanmugamFacing + 1]),
                        Real(C.set[first + kShanmugamFacing + 2]));
  Real part = part_of_patch_beyond(distance, C.set[first + kShanmugamPerNear], C.near_radius) -
              part_of_patch_beyond(distance, C.set[first + kShanmugamPerFar], C.radius);
  Real facing = max(dot(flat_part, direction) * -1.0f, Real(0.0f));
  Real hides = facing * max(cosine, Real(0.0f)) / mad(distance, distance, Real(C.set[first + kShanmugamFlat]));
  return part * (hides + roughly_hidden_by_sphere(cosine, min(one_over * C.set[first + kShanmugamRest], Real(1.0f))));
}

// Returns the same of a sphere with the exact fraction and split, or by the formulas of the paper.
FN Real hidden_by_whole_sphere(int first, Real cosine, Real distance) {
  float radius2 = C.set[first + kShanmugamRadius2];
  Real distance2 = distance * distance;
  if (C.far_form == kShanmugamPaper) {
    Real q2 = min(radius2 / max(distance2, Real(1e-30f)), Real(1.0f));
    Real hides = 2.0f * (1.0f - sqrt(1.0f - q2)) * max(cosine, Real(0.0f));
    return select(distance >= Real(C.near_radius) && distance < Real(C.radius), hides, Real(0.0f));
  }
  Real part = part_of_sphere_beyond(distance, Real(radius2), C.near_radius) -
              part_of_sphere_beyond(distance, Real(radius2), C.radius);
  if (!some(part > Real(0.0f))) return Real(0.0f);
  return part * hidden_by_sphere(cosine, max(distance2 / radius2, Real(1.0001f)));
}

// Returns the components of a view-space vector along the axes of the world.
FN Vec3 in_world(Vec3 v) {
  return Vec3(mad(v.x, Real(C.world_axes[0]), mad(v.y, Real(C.world_axes[1]), v.z * C.world_axes[2])),
              mad(v.x, Real(C.world_axes[3]), mad(v.y, Real(C.world_axes[4]), v.z * C.world_axes[5])),
              mad(v.x, Real(C.world_axes[6]), mad(v.y, Real(C.world_axes[7]), v.z * C.world_axes[8])));
}

// Returns the fraction of the hemisphere that occluders hide together which add up to `sum` in one lobe of directions.
// The lobe of a half axis weights each direction by its squared component along the axis. It holds (1 + n)^2 / 8 of the
// hemisphere, where n is the component of the normal; the six lobes hold all of it.
FN Real hidden_in_lobe(Real sum, Real n) {
  Real side = n + 1.0f;
  Real whole = max(side * side * 0.125f, Real(1e-9f));
  Real filled = min(sum / whole, Real(1e9f));
  return whole * filled * rsqrt(mad(filled, filled, Real(1.0f)));
}

// Returns the visibility past all patches. Patches one behind the other hide less than their sum, so that the sum in
// each direction approaches what the directions hold.
FN Real visibility_past_patches(Vec3 position, Vec3 normal) {
  Vec3 upwards = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  Vec3 downwards = upwards;
  for (int i = 0; i < C.occluders; ++i) {
    int first = i * kShanmugamOccluderSize;
    Vec3 way = way_to(first, position);
    Real distance2 = max(dot(way, way), Real(kMinDistance2));
    Real height = dot(way, normal);
    float limit = C.radius + 0.5f / C.set[first + kShanmugamPerFar];
    // Else all of it is below the horizon or beyond the radius.
    if (some(height > Real(-C.set[first + kShanmugamRest]) && distance2 < Real(limit * limit))) {
      Real one_over = rsqrt(distance2);
      Vec3 direction = way * one_over;
      Real hides = hidden_by_patch(first, height * one_over, direction, distance2 * one_over, one_over);
      Vec3 weighted = direction * hides;
      Vec3 up = Vec3(max(direction.x, Real(0.0f)), max(direction.y, Real(0.0f)), max(direction.z, Real(0.0f)));
      Vec3 down = up - direction;
      upwards = Vec3(mad(up.x, weighted.x, upwards.x), mad(up.y, weighted.y, upwards.y),
                     mad(up.z, weighted.z, upwards.z));
      downwards = Vec3(mad(-down.x, weighted.x, downwards.x), mad(-down.y, weighted.y, downwards.y),
                       mad(-down.z, weighted.z, downwards.z));
    }
  }
  Real hidden = hidden_in_lobe(upwards.x, normal.x) + hidden_in_lobe(upwards.y, normal.y) +
                hidden_in_lobe(upwards.z, normal.z) +
                hidden_in_lobe(downwards.x, -normal.x) + hidden_in_lobe(downwards.y, -normal.y) +
                hidden_in_lobe(downwards.z, -normal.z);
  return max(1.0f - hidden, Real(0.0f));
}

// Returns the visibility past all spheres: spheres of one object add up, and objects occlude independently.
FN Real visibility_past_spheres(Vec3 position, Vec3 normal) {
  Real visibility = Real(1.0f);
  Real sum = Real(0.0f);
  for (int i = 0; i < C.occluders; ++i) {
    int first = i * kShanmugamOccluderSize;
    Vec3 way = way_to(first, position);
    Real distance2 = max(dot(way, way), Real(kMinDistance2));
    Real one_over = rsqrt(distance2);
    sum = sum + hidden_by_whole_sphere(first, dot(way, normal) * one_over, distance2 * one_over);
    if (C.set[first + kShanmugamLast] != 0.0f) {
      visibility = visibility * (1.0f - min(sum, Real(1.0f)));
      sum = Real(0.0f);
    }
  }
  return visibility;
}

FN Real bounded(Real coordinate) { return clamp(coordinate, Real(-kMaxCoordinate), Real(kMaxCoordinate)); }

FN Real far_visibility(Vec3 position, Vec3 normal) {
  Vec3 from = in_world(Vec3(bounded(position.x), bounded(position.y), bounded(position.z)));
  Vec3 axis = in_world(normal);
  if (C.far_form == kShanmugamPatch) return visibility_past_patches(from, axis);
  return visibility_past_spheres(from, axis);
}
