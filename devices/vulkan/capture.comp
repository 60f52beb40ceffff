// Captures one depth layer of a scene, as devices/cpu/capture.cpp and rays/ do on the CPU, without hardware ray
// tracing. The visible triangle of a pixel is found by a ray, or read from the triangle indices that peel.frag has
// drawn. A workgroup is four blocks of 4 x 4 pixels; each block decides how many rays a soft shadow needs.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "devices/shared/soften.h"
#include "devices/vulkan/surface.glsl"
#include "devices/vulkan/trace.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer OutPlane { float at[]; };

shared int block_pixels[4], block_lit[4];
// Squared radius of the narrowest penumbra, as the bits of a float: non-negative floats are ordered like their bits.
shared uint block_across[4], block_down[4];

const float kNoRoughness = -1.0f;  // as in scene/scene.h

vec3 light_vector(float v[3 * kCaptureLights], int k) { return vec3(v[3 * k], v[3 * k + 1], v[3 * k + 2]); }

// ---- materials ----

// Returns the difference in texture coordinates between the surface point and the point at which the ray of a
// neighbouring pixel meets the surface's plane.
vec2 uv_change(Surface s, vec2 pixel, vec3 across, vec3 gradient_u, vec3 gradient_v) {
  vec3 origin = origin_at(pixel), direction = direction_at(pixel);
  float t = dot(across, s.position - origin) / dot(across, direction);
  vec3 moved = origin + direction * t - s.position;
  return vec2(dot(moved, gradient_u), dot(moved, gradient_v));
}

// The texture coordinates of a pixel, as in rays/pixel_material.cpp.
struct PixelUv {
  vec2 uv, right, down;
  vec3 across, tangent;
  float determinant;
};

PixelUv pixel_uv(Surface s, vec2 pixel) {
  vec3 e1 = s.triangle.p1 - s.triangle.p0, e2 = s.triangle.p2 - s.triangle.p0, across = cross(e1, e2);
  vec2 t0 = uv_at(s.triangle.corner.x), t1 = uv_at(s.triangle.corner.y) - t0, t2 = uv_at(s.triangle.corner.z) - t0;
  float inverse = 1.0f / dot(across, across);
  vec3 gradient1 = cross(e2, across) * inverse, gradient2 = cross(across, e1) * inverse;
  vec3 gradient_u = gradient1 * t1.x + gradient2 * t2.x, gradient_v = gradient1 * t1.y + gradient2 * t2.y;
  return PixelUv(t0 + t1 * s.u + t2 * s.v, uv_change(s, pixel + vec2(1.0f, 0.0f), across, gradient_u, gradient_v),
                 uv_change(s, pixel + vec2(0.0f, 1.0f), across, gradient_u, gradient_v), across, e1 * t2.y - e2 * t1.y,
                 t1.x * t2.y - t1.y * t2.x);
}

// Returns a texture averaged over the pixel.
vec3 pixel_texel(PixelUv at, int index) { return sample_filtered(index, at.uv, at.right, at.down).rgb; }

// Returns the surface's normal, turned by a texel of its normal map, as in rays/pixel_material.cpp.
vec3 mapped_normal(Surface s, PixelUv at, vec3 normal_texel, float scale, vec3 ray) {
  vec3 stored = normal_at(s.triangle.corner.x) * (1.0f - s.u - s.v) + normal_at(s.triangle.corner.y) * s.u +
                normal_at(s.triangle.corner.z) * s.v;
  float side = dot(stored, s.normal) < 0.0f ? -1.0f : 1.0f;
  vec3 tangent = at.tangent * (at.determinant < 0.0f ? -1.0f : 1.0f);
  tangent -= s.normal * dot(s.normal, tangent);
  float size = length(tangent);
  if (!(size > 0.0f) || at.determinant == 0.0f) return s.normal;
  tangent /= size;
  float handed = (dot(at.across, stored) < 0.0f) != (at.determinant < 0.0f) ? -1.0f : 1.0f;
  vec3 bitangent = cross(s.normal, tangent) * (side * handed);
  vec2 slope = (normal_texel.xy * 2.0f - 1.0f) * (scale * side);
  vec3 mapped = tangent * slope.x + bitangent * slope.y + s.normal * (normal_texel.z * 2.0f - 1.0f);
  size = length(mapped);
  if (!(size > 1e-6f)) return s.normal;
  mapped /= size;
  float away = dot(mapped, ray);
  return away > 0.0f ? normalize(mapped - ray * (away / dot(ray, ray) * 1.001f)) : mapped;
}

// The material at a pixel, as in rays/pixel_material.h.
struct PixelMaterial {
  vec3 albedo, emission, normal;
  float metallic, roughness, occlusion, specular;
};

PixelMaterial pixel_material(Surface s, CaptureMesh mesh, vec2 pixel, vec3 ray) {
  PixelMaterial m = PixelMaterial(to_vec3(mesh.albedo), to_vec3(mesh.emission), s.normal, mesh.metallic, mesh.roughness,
                                  1.0f, mesh.specular);
  m.albedo *= mesh_color(s, mesh);
  if (max(max(mesh.texture_index, mesh.emission_texture), max(mesh.surface_texture, mesh.normal_texture)) < 0) return m;
  PixelUv at = pixel_uv(s, pixel);
  if (mesh.texture_index >= 0) m.albedo *= pixel_texel(at, mesh.texture_index);
  if (mesh.emission_texture >= 0) m.emission *= pixel_texel(at, mesh.emission_texture);
  if (mesh.surface_texture >= 0) {
    vec3 factors = pixel_texel(at, mesh.surface_texture);
    m.occlusion = 1.0f + mesh.occlusion_strength * (factors.r - 1.0f);
    if (m.roughness >= 0.0f) m.roughness *= factors.g;
    m.metallic *= factors.b;
  }
  if (mesh.normal_texture >= 0)
    m.normal = mapped_normal(s, at, pixel_texel(at, mesh.normal_texture), mesh.normal_scale, ray);
  return m;
}

// ---- shadows ----

vec2 disc_point(int set, int k) {
  Floats from = Floats(table[kPointsSlot]);
  return vec2(from.at[2 * (16 * set + k)], from.at[2 * (16 * set + k) + 1]);
}

// Limits the penumbra radii of a block, like narrow() in rays/shadow_lights.h.
void narrow(int block, vec2 radius_squared) {
  atomicMin(block_across[block], floatBitsToUint(radius_squared.x));
  atomicMin(block_down[block], floatBitsToUint(radius_squared.y));
}

float penumbra_pixels(Surface s, float depth, vec3 origin_step, vec3 direction, vec3 direction_step, vec3 toward,
                      float radius) {
  vec3 moved = origin_step + depth * direction_step;
  moved -= direction * (dot(s.normal, moved) / dot(s.normal, direction));
  float along = dot(moved, toward);
  float across = dot(moved, moved) - along * along / dot(toward, toward);
  return across > 0.0f ? radius * radius / across : 0.0f;
}

// The surface point from which a shadow ray starts.
struct Receiver {
  Surface s;
  vec3 start;  // origin of the ray
  float depth;
  vec3 direction;  // of the camera's ray
  int block;
  bool softened;  // record penumbra radii, since the shadows of this layer will be softened
  bool rough;     // the material has a roughness
};

// Returns whether a ray to a point on the light's disc is unblocked.
bool reaches_light(Receiver r, int light, bool soft, vec2 disc_place) {
  bool point = C.light_point[light] != 0;
  vec3 where = light_vector(C.light_where, light);
  vec3 toward_center = point ? where - r.s.position : where, toward = toward_center;
  // Only surfaces with a roughness reflect a light whose centre is below their horizon.
  bool reflects = dot(r.s.normal, toward) > 0.0f || (soft && r.rough);
  if (soft) {
    vec3 right = light_vector(C.light_right, light), up = light_vector(C.light_up, light);
    if (point) disc_axes(toward, right, up);
    where += C.light_size[light] * (disc_place.x * right + disc_place.y * up);
    toward = point ? where - r.s.position : where;
  }
  if (!reflects || !(dot(r.s.normal, toward) > 0.0f)) {
    if (r.softened) narrow(r.block, vec2(0.0f));
    return false;
  }
  Ray ray = point ? Ray(r.start, where - r.start, 0.0f, 1.0f) : Ray(r.start, toward, 0.0f, kInfinity);
  Hit hit = trace(ray, !(soft && r.softened), C.min_shadow_opacity);
  if (hit.triangle < 0) return true;
  if (soft && r.softened) {
    float radius = C.light_size[light] * (point ? hit.t / max(1.0f - hit.t, 1e-6f) : hit.t);
    float across =
        penumbra_pixels(r.s, r.depth, to_vec3(C.origin_x), r.direction, to_vec3(C.direction_x), toward_center, radius);
    float down =
        penumbra_pixels(r.s, r.depth, to_vec3(C.origin_y), r.direction, to_vec3(C.direction_y), toward_center, radius);
    narrow(r.block, vec2(across, down));
  }
  return false;
}

// Returns the unblocked fraction of a light. All pixels of the workgroup must call it together.
float shadow_of(Receiver r, bool is_hit, int light, int k) {
  int rays = C.light_rays[light], block = r.block;
  int first_ray = C.sample_index * rays;
  bool keeps_first = rays == 2;  // the first of two rays takes the place of the ray to the border
  float lit = 0.0f;
  bool partly_lit = rays > 0;
  if (rays != 1) {
    int ray = keeps_first ? first_ray % kCaptureDiscPoints : kCaptureDiscPoints;
    if (is_hit && reaches_light(r, light, rays > 0, disc_point(ray, k))) lit = 1.0f;
    barrier();
    if (k == 0) block_pixels[block] = block_lit[block] = 0;
    barrier();
    if (is_hit) atomicAdd(block_pixels[block], 1);
    if (lit > 0.0f) atomicAdd(block_lit[block], 1);
    barrier();
    partly_lit = partly_lit && block_lit[block] != 0 && block_lit[block] != block_pixels[block];
  }
  if (!partly_lit || !is_hit) return lit;
  if (!keeps_first) lit = 0.0f;
  for (int ray = keeps_first ? 1 : 0; ray < rays; ++ray)
    if (reaches_light(r, light, true, disc_point((ray + first_ray) % kCaptureDiscPoints, k))) lit += 1.0f;
  return lit / float(rays);
}

// ---- planes ----

void store(int slot, int index, float v) {
  uvec2 address = table[slot];
  if ((address.x | address.y) != 0u) OutPlane(address).at[index] = v;
}

void store3(int slot, int index, vec3 v) {
  store(slot, index, v.x);
  store(slot + 1, index, v.y);
  store(slot + 2, index, v.z);
}

void store_surface(int first, int index, bool is_hit, Surface s, float depth, PixelMaterial m, CaptureMesh mesh) {
  store(first + kDepthSlot, index, is_hit ? depth : kInfinity);
  mat3 to_view = view_rotation();
  vec3 ray_offset = is_hit ? to_view * s.geometric * (ray_origin_height(s, to_vec3(C.eye)) / C.unit_scale) : vec3(0.0f);
  store3(first + kRayOffsetSlot, index, ray_offset);
  store3(first + kNormalSlot, index, is_hit ? to_view * m.normal : vec3(0.0f));
  store3(first + kAlbedoSlot, index, is_hit ? m.albedo : vec3(0.0f));
  store(first + kSpecularSlot, index, is_hit ? m.specular : 0.0f);
  store(first + kShininessSlot, index, is_hit ? mesh.shininess : 0.0f);
  store3(first + kEmissionSlot, index, is_hit ? m.emission : vec3(0.0f));
  store(first + kMetallicSlot, index, is_hit ? m.metallic : 0.0f);
  store(first + kRoughnessSlot, index, is_hit ? m.roughness : kNoRoughness);
  store(first + kMaterialAoSlot, index, is_hit ? m.occlusion : 1.0f);
  store(first + kObjectSlot, index, is_hit ? mesh.object_id : -1.0f);
  store(first + kMaterialSlot, index, is_hit ? mesh.material_id : -1.0f);
  for (int light = 0; light < kCaptureLights; ++light) store(first + kShadowSlot + light, index, 1.0f);
}

// Returns the opacity of a surface as seen along a ray.
float seen_opacity(Surface s, CaptureMesh mesh, vec3 direction) {
  if (mesh.masked != kBlended) return 1.0f;
  float opacity = mesh.opacity * alpha_at(mesh, s.triangle, s.u, s.v);
  if (mesh.glass == 0) return opacity;
  float slant = 1.0f - min(abs(dot(s.normal, normalize(direction))), 1.0f);
  float reflectance = C.glass_reflectance + (1.0f - C.glass_reflectance) * slant * slant * slant * slant * slant;
  return opacity + (1.0f - opacity) * reflectance;
}

// Follows a ray from its first hit to an opaque surface, and stores the opacity, the transmittance and the mean albedo
// of the blended surfaces up to there, like see_through in devices/cpu/capture.cpp.
void see_through(Ray ray, Hit hit, vec2 pixel, int index) {
  const int kMaxSurfaces = 16;
  float opacity = 0.0f;
  vec3 transmittance = vec3(1.0f), albedo = vec3(0.0f);
  for (int n = 0; n < kMaxSurfaces && hit.triangle >= 0; ++n) {
    Surface s = surface_at(ray, hit);
    CaptureMesh mesh = Meshes(table[kMeshesSlot]).at[s.triangle.mesh];
    float own = seen_opacity(s, mesh, ray.direction);
    if (mesh.masked != kBlended || own >= C.opaque) {
      if (n == 0 && mesh.masked == kBlended) {
        opacity = 1.0f;
        transmittance = vec3(0.0f);
      }
      break;
    }
    float added = (1.0f - opacity) * own;
    opacity += added;
    albedo += added / opacity * (pixel_material(s, mesh, pixel, ray.direction).albedo - albedo);
    transmittance *= (1.0f - own) * to_vec3(mesh.tint);
    vec3 at = ray.origin + ray.direction * hit.t;
    ray.nearest = hit.t + kLayerStep * (length(at) + distance(at, to_vec3(C.eye))) / length(ray.direction);
    hit = trace(ray, false, C.min_opacity);
  }
  for (int first = 0; first <= C.back * kBackSlots; first += kBackSlots) {
    store(first + kOpacitySlot, index, opacity);
    store3(first + kTransmittanceSlot, index, transmittance);
    if (opacity > 0.0f && opacity < 1.0f) store3(first + kAlbedoSlot, index, albedo);
  }
}

void main() {
  ivec2 here = ivec2(gl_GlobalInvocationID.xy), local = ivec2(gl_LocalInvocationID.xy);
  bool inside = here.x < C.width && here.y < C.height;
  int index = here.y * C.stride + here.x;
  int block = local.y / 4 * 2 + local.x / 4, k = local.y % 4 * 4 + local.x % 4;
  vec2 pixel = vec2(here) + 0.5f;

  Ray ray;
  Hit hit = Hit(kInfinity, 0.0f, 0.0f, -1);
  if (inside && C.nothing_visible == 0) {
    bool in_front = pixel_ray(here, ray);
    uvec2 indices = table[kTriangleIndexSlot];
    if ((indices.x | indices.y) != 0u) {
      int k = int(Uints(indices).at[index]) - 1;
      if (k >= 0) hit = hit_of_covered(ray, triangle_at(k), k);
    } else if (in_front) {
      hit = trace(ray, false, C.min_opacity);
    }
  }
  bool is_hit = hit.triangle >= 0;
  Surface s;
  CaptureMesh mesh;
  PixelMaterial material;
  if (is_hit) {
    s = surface_at(ray, hit);
    mesh = Meshes(table[kMeshesSlot]).at[s.triangle.mesh];
    material = pixel_material(s, mesh, pixel, ray.direction);
  }
  for (int side = 0; side <= C.back; ++side) {
    int first = side * kBackSlots;
    if (side == 1 && is_hit) {
      s.geometric = -s.geometric;
      s.normal = -s.normal;
      material.normal = -material.normal;
      material.specular = 0.0f;
      material.roughness = kNoRoughness;
    }
    if (inside) store_surface(first, index, is_hit, s, hit.t, material, mesh);
    if (inside && C.blended != 0 && side == C.back) see_through(ray, hit, pixel, index);
    vec3 start = is_hit ? ray_origin_to_light(s, to_vec3(C.eye)) : vec3(0.0f);
    for (int light = 0; light < C.light_count; ++light) {
      int radii = kPenumbraSlot + 2 * C.light_index[light];
      bool softened = (table[radii].x | table[radii].y) != 0u && side == 0;
      if (softened) {
        barrier();
        if (k == 0) block_across[block] = block_down[block] = floatBitsToUint(kInfinity);
        barrier();
      }
      Receiver receiver = Receiver(s, start, hit.t, ray.direction, block, softened, material.roughness >= 0.0f);
      float lit = shadow_of(receiver, is_hit, light, k);
      if (is_hit) store(first + kShadowSlot + C.light_index[light], index, lit);
      if (softened) {
        barrier();
        if (k == 0 && inside) {
          int at = here.y / kSoftenBlock * C.stride + here.x / kSoftenBlock;
          store(radii, at, sqrt(uintBitsToFloat(block_across[block])));
          store(radii + 1, at, sqrt(uintBitsToFloat(block_down[block])));
        }
      }
    }
  }
}
