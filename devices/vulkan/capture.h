// What capture.comp, corner.vert and peel.frag read, shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_DEVICES_VULKAN_CAPTURE_H
#define UMBRAGE_DEVICES_VULKAN_CAPTURE_H

// Where things stand in the table of addresses: the planes of a layer, as many again of its other side, the depth of
// the layer before, and what a scene is made of. Address 0: it is not there, or nobody wants it.
const int kDepthSlot = 0, kNormalSlot = 1, kAlbedoSlot = 4, kSpecularSlot = 7, kShininessSlot = 8, kShadowSlot = 9;
const int kEmissionSlot = 17, kObjectSlot = 20, kMaterialSlot = 21;
const int kBackSlots = 22;
const int kBeforeSlot = 44;
const int kNodesSlot = 45, kTrianglesSlot = 46, kNormalsSlot = 47, kUvsSlot = 48, kMeshesSlot = 49;
const int kTexturesSlot = 50, kLevelsSlot = 51, kTexelsSlot = 52, kPointsSlot = 53, kColorsSlot = 54;
// By light: where blocks of 4 x 4 pixels note down the radius of penumbrae along a row, and then along a column.
const int kPenumbraSlot = 55;
// Which triangle each pixel sees: its number and one more, or 0. Address 0: that is for rays to find out.
const int kSeenSlot = 71;
const int kCaptureSlots = 72;

const int kCaptureLights = 8;
// Sets of 16 points; the set after the last one lies on the disc's rim. The 256 linear values of sRGB bytes follow.
const int kCaptureDiscPoints = 256;
const int kHierarchyDepth = 64;

struct CaptureConstants {
  int width, height, stride;
  int root;          // of the hierarchy: a node, or ~(8 first + count) for triangles
  int nothing;       // 1: nothing can be seen, whatever the rays
  int back;          // 1: the other sides are drawn too
  int sample_index;  // of pictures that are averaged
  int light_count;
  float to_view[9];  // rows
  float eye[3];      // what follows is in unit space: rays/camera_rays.h
  float origin[3], origin_x[3], origin_y[3];
  float direction[3], direction_x[3], direction_y[3];
  // Where a point is drawn: these rows times its place less the origin, in homogeneous coordinates. That of w is the
  // parameter of the ray through it, also where coordinates are parallel and w is 1.
  float clip_x[3], clip_y[3], clip_w[3];
  int orthographic;
  float nearest;  // depth that is drawn as 1, a farther one as the share of it that this is; nearer ones are all alike
  // Lights: rays/shadow_lights.h.
  int light_index[kCaptureLights], light_point[kCaptureLights], light_rays[kCaptureLights];
  float light_size[kCaptureLights];
  float light_where[3 * kCaptureLights], light_right[3 * kCaptureLights], light_up[3 * kCaptureLights];
};

// A mesh with its material.
struct CaptureMesh {
  float albedo[3], specular, shininess, emission[3];
  int texture_index, emission_texture;  // below 0: none
  int masked;                           // 1: cut away where the texture's alpha is below the cutoff
  float cutoff;
  int colored, color_shift;  // colored 1: the colour of a vertex stands at its number plus the shift
  float object_id, material_id;
};

// What stands where a triangle does in the hierarchy.
const int kTriangle = 0, kDisc = 1, kSphere = 2;

struct CaptureTexture {
  int first_level, levels;
};

struct CaptureLevel {
  int first_texel, width, height;
};

#endif
