// Splits the finished picture of another renderer, `beauty`, into ambient light, which occlusion blocks, and the rest,
// `direct`, so that the effects for light apply to it. Where occlusion is 1 their sum is the picture.
//
// source planes     ambient = the plane `ambient`, at most beauty - emission
// source estimate   ambient = (beauty - emission) fraction / (1 + (Y / highlights)^2), Y its luminance
//
// Bright light is direct light more likely than dark light is. The estimate is a smooth function of luminance for which
// a brighter pixel never becomes darker than a darker one of the same occlusion.
INOUT_COLOR(ambient)
IN_COLOR(beauty)
IN_ALPHA(beauty)
IN_COLOR(emission)
OUT_COLOR(direct)
OUT_COLOR(sky)
OUT_REAL(coverage)

FN Vec3 not_below_0(Vec3 v) { return Vec3(max(v.x, Real(0.0f)), max(v.y, Real(0.0f)), max(v.z, Real(0.0f))); }

// Returns the part of the reflected light that is estimated to be ambient.
FN Vec3 estimated(Vec3 reflected) {
  Real luminance = dot(reflected, Vec3(Real(0.2126f), Real(0.7152f), Real(0.0722f)));  // Rec.709
  Real relative = min(luminance * Real(C.one_over_highlights), Real(1e15f));           // its square is finite
  return reflected * (Real(C.fraction) / mad(relative, relative, Real(1.0f)));
}

FN void relight_pixel(Int px, Int py) {
  Vec3 picture = finite_or_zero(near_beauty(0, 0));
  Vec3 reflected = not_below_0(picture - not_below_0(finite_or_zero(near_emission(0, 0))));
  Vec3 given = not_below_0(finite_or_zero(own_ambient()));
  given = Vec3(min(given.x, reflected.x), min(given.y, reflected.y), min(given.z, reflected.z));
  Vec3 ambient = given;
  if (C.source == kRelightEstimate) ambient = estimated(reflected);
  store_ambient(ambient);
  store_direct(picture - ambient);
  store_sky(picture);
  store_coverage(clamp(finite_or_zero(near_beauty_a(0, 0)), Real(0.0f), Real(1.0f)));
}
