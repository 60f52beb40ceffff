// Parameters and kernel constants of `lighting`. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_LIGHTING_H
#define UMBRAGE_EFFECTS_LIGHTING_H
const int kLightingMaxLights = 16;
// Those of core/reflection_map.h.
const int kLightingReflectionLevels = 5, kLightingReflectionTexels = 3008, kLightingBrdfSide = 12;
const int kLightingShape = 9;  // number of factors per colour channel by which ambient light depends on the normal

// Each field has one row in the parameter table of lighting.cpp.
struct LightingParams {
  float ambient, diffuse, specular;  // factors
  float emission;                    // factor
  float gloss;                       // peak of the highlight of surfaces without a higher one, 0 to 1
  float shadow;                      // strength of shadows, 0 to 1
  int material;                      // 0 the scene's, 1 white clay, 2 the scene's with albedo as display values
  int open;                          // 0 or 1: also write `open_light`
  int rig;                           // 0 the scene's lights, 1 a head light, 2 a key light
};

struct LightingConstants {
  int light_count;
  int clay, display;  // 0 or 1
  float ambient_r, ambient_g, ambient_b;
  int shaped;  // 0 or 1: ambient light depends on the normal
  // Per colour channel: factors of x, y, z, xy, yz, zx, xx, yy, zz of the normal.
  float shape_r[kLightingShape], shape_g[kLightingShape], shape_b[kLightingShape];
  float diffuse, specular, emission, gloss, shadow;
  // Lights in view space, the key light first. kind 0: directional, (x, y, z) points towards the light; kind 1: point
  // light at (x, y, z).
  int kind[kLightingMaxLights];
  float x[kLightingMaxLights], y[kLightingMaxLights], z[kLightingMaxLights];
  float r[kLightingMaxLights], g[kLightingMaxLights], b[kLightingMaxLights];
  // Point lights: squared distance at which the light has the colour (r, g, b); 0: no falloff.
  float reach_squared[kLightingMaxLights];
  // Angular radius: of directional lights its sine; of point lights the radius of the sphere, scene units.
  float size[kLightingMaxLights];
  int rough;         // 0 or 1: surfaces may have a roughness; 0: none of the members below but map_ao is used
  int map_ao;        // 0 or 1: materials may have occlusion maps
  float reflection;  // factor of reflections
  float to_map[9];   // rows: from view space to that of the map
  int level_first[kLightingReflectionLevels], level_side[kLightingReflectionLevels];
  int reflections[kLightingReflectionTexels];  // the bits of a ReflectionMap
  float brdf_scale[kLightingBrdfSide * kLightingBrdfSide], brdf_bias[kLightingBrdfSide * kLightingBrdfSide];
};

#endif
