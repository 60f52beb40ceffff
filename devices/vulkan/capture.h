// Constants of capture.comp, trace_rays.comp, corner.vert and peel.frag, shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_DEVICES_VULKAN_CAPTURE_H
#define UMBRAGE_DEVICES_VULKAN_CAPTURE_H

// Indices in the table of addresses: the planes of a layer, the same planes of its back sides, the depth of the
// previous layer, and the buffers of the scene. Address 0: absent, or not requested.
const int kDepthSlot = 0, kNormalSlot = 1, kAlbedoSlot = 4, kSpecularSlot = 7, kShininessSlot = 8, kShadowSlot = 9;
const int kEmissionSlot = 17, kObjectSlot = 20, kMaterialSlot = 21;
const int kMetallicSlot = 22, kRoughnessSlot = 23, kMaterialAoSlot = 24, kOpacitySlot = 25, kTransmittanceSlot = 26;
const int kRayOffsetSlot = 29;
const int kBackSlots = 32;
const int kPreviousDepthSlot = 64;
const int kNodesSlot = 65, kTrianglesSlot = 66, kNormalsSlot = 67, kUvsSlot = 68, kMeshesSlot = 69;
const int kTexturesSlot = 70, kLevelsSlot = 71, kTexelsSlot = 72, kPointsSlot = 73, kColorsSlot = 74;
// Two planes per light: the penumbra radius along rows and along columns, with one value per block of 4 x 4 pixels.
const int kPenumbraSlot = 75;
// Index + 1 of the triangle that is visible in each pixel; 0: none. Address 0: rays find the triangle.
const int kTriangleIndexSlot = 91;
// Planes of trace_rays.comp: the rays, and the outputs of their dispatch.
const int kRaySlot = 92, kOpenSlot = 95, kConfidenceSlot = 96, kBentSlot = 97, kIndirectSlot = 100;
const int kCaptureSlots = 103;

const int kCaptureLights = 8;
// Number of sets of 16 sample points on a light's disc. In their buffer, a set on the border of the disc follows, then
// the linear values of the 256 sRGB bytes.
const int kCaptureDiscPoints = 256;
const int kHierarchyDepth = 64;

// A light for the surfaces that rays hit: TracedLight without a size.
struct CaptureHitLight {
  int point, from_camera, casts_shadow;  // 0 or 1
  float where[3], color[3];
  float reach_squared, min_squared;
};
const int kCaptureHitLights = 16;

struct CaptureConstants {
  int width, height, stride;
  int root;             // root of the hierarchy; see Hierarchy::nodes
  int nothing_visible;  // 1: nothing is visible; trace no rays
  int back;             // 1: also capture the back sides
  int sample_index;     // sample index of an accumulation
  int blended;          // 1: capture blended surfaces
  // Primary and shadow rays pass through blended surfaces with less opacity; one with `opaque` is opaque:
  // scene/scene.h.
  float min_opacity, min_shadow_opacity, opaque, glass_reflectance;
  int light_count;
  float to_view[9];  // rows
  float unit_scale;  // units of unit space per scene unit: rays/traced_scene.h
  float eye[3];      // this and all members below are in unit space: rays/camera_rays.h
  float origin[3], origin_x[3], origin_y[3];
  float direction[3], direction_x[3], direction_y[3];
  // Projection of triangles: these rows times a point, relative to the origin, in homogeneous coordinates. The row of w
  // gives the parameter of the ray through the point, also for an orthographic camera, whose w is 1.
  float clip_x[3], clip_y[3], clip_w[3];
  int orthographic;
  float nearest;  // ray parameter that maps to depth 1; a larger t maps to nearest / t, a smaller one to 1
  // Lights: rays/shadow_lights.h.
  int light_index[kCaptureLights], light_point[kCaptureLights], light_rays[kCaptureLights];
  float light_size[kCaptureLights];
  float light_where[3 * kCaptureLights], light_right[3 * kCaptureLights], light_up[3 * kCaptureLights];
  // Of trace_rays.comp:
  int ray, last_ray;  // index of the ray of each pixel, and that of the last one
  float ray_length;   // unit space
  int falloff;        // a Falloff of core/effect.h: kNoFalloff and so on
  // The light of the surfaces that its rays hit: HitLighting.
  float light;  // factor
  // As in RaySettings.
  float directional;
  float sky[27];
  int seed;
  int hit_light_count;
  CaptureHitLight hit_lights[kCaptureHitLights];
  float ambient[3];
  int even_ambient;
  float max_emission;       // radiance
  float ambient_shape[48];  // three matrices by columns
};

// Values of CaptureConstants::falloff.
const int kNoFalloff = 0, kLinearFalloff = 1, kSmoothFalloff = 2;

// A mesh with its material.
struct CaptureMesh {
  float albedo[3], specular, shininess, emission[3];
  float metallic, roughness, occlusion_strength, normal_scale;
  int texture_index, emission_texture, surface_texture, normal_texture;  // < 0: none
  int masked;  // kMasked: cut out where the texture's alpha is below the cutoff; kBlended: see Material::blended
  float cutoff, opacity, tint[3];
  int glass;
  int colored, color_shift;  // colored 1: the colour of a vertex is at its index + color_shift
  float object_id, material_id;
};

// Values of CaptureMesh::masked.
const int kMasked = 1, kBlended = 2;

// Kinds of primitives in the hierarchy.
const int kTriangle = 0, kDisc = 1, kSphere = 2;

struct CaptureTexture {
  int first_level, levels;
  int linear;  // 1: the colour channels hold linear values
};

struct CaptureLevel {
  int first_texel, width, height;
  int nearest;  // 1: texels have sharp edges
  int clamped;  // 1: as in Texture
};

#endif
