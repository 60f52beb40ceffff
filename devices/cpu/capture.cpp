#include "devices/cpu/capture.h"

#include <embree3/rtcore.h>
#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "devices/cpu/mip_texture.h"

namespace umbrage {

struct TracedScene {
  const Scene* scene = nullptr;
  RTCDevice device = nullptr;
  RTCScene rtc = nullptr;
  std::vector<MipTexture> textures;
  // Embree sees the scene moved to the origin and scaled to about unit size, since single floats serve neither a
  // micrometre nor a light year: products of four edges would leave their range. A power of two keeps every bit. A
  // ray's parameter stays depth.
  glm::vec3 center{0.0f};
  float scale = 1.0f;

  glm::vec3 unit_of(glm::vec3 world) const { return (world - center) * scale; }
};

void FreeTracedScene::operator()(TracedScene* traced) const {
  if (traced->rtc) rtcReleaseScene(traced->rtc);
  if (traced->device) rtcReleaseDevice(traced->device);
  delete traced;
}

namespace {

constexpr int kPacket = 16;  // rays at a time: a block of 4 x 4 pixels
constexpr int kBlock = 4;
constexpr float kEmbreeInfinity = 1e18f;  // its FLT_LARGE is 1.844e18
constexpr int kTileBlocks = 8;            // blocks per side of a tile that one task draws: 32 pixels
// A shadow ray starts this share of the hit's distance from the scene's origin and from the eye away from the surface;
// float positions are exact to 6e-8 of their size.
constexpr float kShadowOffset = 4e-6f;

glm::vec2 uv_at(const Mesh& mesh, unsigned triangle, float u, float v) {
  const std::uint32_t* i = mesh.indices.data() + std::size_t(triangle) * 3;
  return mesh.uvs[i[0]] * (1.0f - u - v) + mesh.uvs[i[1]] * u + mesh.uvs[i[2]] * v;
}

bool is_masked(const TracedScene& traced, const Mesh& mesh) {
  const Material& material = traced.scene->materials[mesh.material];
  return material.alpha_mask && material.texture != kNoTexture && !mesh.uvs.empty();
}

/// Lets rays through where a texture's alpha is cut away.
void cut_away(const RTCFilterFunctionNArguments* args) {
  const auto& traced = *static_cast<const TracedScene*>(args->geometryUserPtr);
  for (unsigned k = 0; k < args->N; ++k) {
    if (args->valid[k] == 0) continue;
    const Mesh& mesh = traced.scene->meshes[RTCHitN_geomID(args->hit, args->N, k)];
    const Material& material = traced.scene->materials[mesh.material];
    const glm::vec2 uv = uv_at(mesh, RTCHitN_primID(args->hit, args->N, k), RTCHitN_u(args->hit, args->N, k),
                               RTCHitN_v(args->hit, args->N, k));
    if (sample_alpha(traced.textures[material.texture], uv) < material.alpha_cutoff) args->valid[k] = 0;
  }
}

/// The ray through the point (x, y) of the picture, in pixels, starts at origin + x origin_x + y origin_y and has the
/// direction direction + x direction_x + y direction_y. A direction's component along the view axis is 1, so that a
/// ray's parameter is depth.
struct Rays {
  glm::mat3 world_from_view;
  glm::vec3 eye;
  glm::vec3 origin, origin_x{0.0f}, origin_y{0.0f};
  glm::vec3 direction, direction_x{0.0f}, direction_y{0.0f};

  glm::vec3 origin_at(float x, float y) const { return origin + origin_x * x + origin_y * y; }
  glm::vec3 direction_at(float x, float y) const { return direction + direction_x * x + direction_y * y; }
};

Rays rays_of(const TracedScene& traced, const PictureInfo& info) {
  const Camera& camera = info.camera;
  Rays rays;
  rays.world_from_view = glm::transpose(glm::mat3(camera.view_from_world));
  rays.eye = traced.unit_of(camera.eye());
  const glm::mat3 axes = rays.world_from_view * traced.scale;
  const glm::vec3 right = axes[0] * ((camera.right - camera.left) / float(info.width));
  const glm::vec3 down = axes[1] * (-(camera.top - camera.bottom) / float(info.height));
  const glm::vec3 corner = axes[0] * camera.left + axes[1] * camera.top;
  const glm::vec3 forward = -axes[2];
  rays.origin = rays.eye;
  rays.direction = forward;
  if (camera.projection == Projection::kOrthographic) {
    rays.origin += corner;
    rays.origin_x = right;
    rays.origin_y = down;
  } else {
    rays.direction += corner;
    rays.direction_x = right;
    rays.direction_y = down;
  }
  return rays;
}

/// Whether every ray of the picture lies where Embree's numbers end later than ours: it ends the program otherwise.
bool within_reach(const Rays& rays, const PictureInfo& info) {
  for (const float x : {0.0f, float(info.width)})
    for (const float y : {0.0f, float(info.height)}) {
      const glm::vec3 reach = glm::max(glm::abs(rays.origin_at(x, y)), glm::abs(rays.direction_at(x, y)));
      if (!(std::max({reach.x, reach.y, reach.z}) < kEmbreeInfinity)) return false;
    }
  return true;
}

/// The planes that are drawn, in this order.
constexpr std::array kPlaneNames = {"depth",    "normal.x", "normal.y",  "normal.z", "albedo.r",  "albedo.g",
                                    "albedo.b", "specular", "shininess", "shadow",   "object_id", "material_id"};

/// A block of pixels on its way to the planes: stored row by row at the end, since single floats scattered over a dozen
/// planes cost more than shading.
struct alignas(64) Block {
  float depth[kPacket], nx[kPacket], ny[kPacket], nz[kPacket], ar[kPacket], ag[kPacket], ab[kPacket];
  float specular[kPacket], shininess[kPacket], shadow[kPacket], object[kPacket], material[kPacket];
};
static_assert(sizeof(Block) == kPlaneNames.size() * kPacket * sizeof(float));

void clear(Block& block) {
  block = {};
  std::fill_n(block.depth, kPacket, std::numeric_limits<float>::infinity());
  std::fill_n(block.shadow, kPacket, 1.0f);
  std::fill_n(block.object, kPacket, -1.0f);
  std::fill_n(block.material, kPacket, -1.0f);
}

/// Rows are padded to kRowAlignment floats, so that a block may be stored over the picture's right side.
void store(const Block& block, int x0, int y0, Image& image) {
  const float* values = block.depth;
  for (Plane& plane : image.planes) {
    for (int j = 0; j < kBlock && y0 + j < image.height; ++j)
      std::memcpy(plane.row(y0 + j) + x0, values + j * kBlock, kBlock * sizeof(float));
    values += kPacket;
  }
}

/// Albedo of a hit: the material's, times its texture averaged over the pixel.
glm::vec3 albedo_at(const TracedScene& traced, const Rays& rays, const Mesh& mesh, const Material& material,
                    unsigned triangle, float u, float v, glm::vec3 hit, float px, float py) {
  if (material.texture == kNoTexture || mesh.uvs.empty()) return material.albedo;
  const std::uint32_t* i = mesh.indices.data() + std::size_t(triangle) * 3;
  const glm::vec3 p0 = mesh.positions[i[0]];
  const glm::vec3 e1 = (mesh.positions[i[1]] - p0) * traced.scale, e2 = (mesh.positions[i[2]] - p0) * traced.scale;
  const glm::vec3 ng = glm::cross(e1, e2);
  const float inverse = 1.0f / glm::dot(ng, ng);
  const glm::vec2 t0 = mesh.uvs[i[0]], t1 = mesh.uvs[i[1]] - t0, t2 = mesh.uvs[i[2]] - t0;
  // Where the neighbouring pixels' rays meet this triangle's plane, and how far texture coordinates moved.
  const auto change = [&](float x, float y) {
    const glm::vec3 origin = rays.origin_at(x, y), direction = rays.direction_at(x, y);
    const glm::vec3 moved = origin + direction * (glm::dot(ng, hit - origin) / glm::dot(ng, direction)) - hit;
    return t1 * (glm::dot(glm::cross(moved, e2), ng) * inverse) + t2 * (glm::dot(glm::cross(e1, moved), ng) * inverse);
  };
  const glm::vec4 texel = sample_filtered(traced.textures[material.texture], t0 + t1 * u + t2 * v,
                                          change(px + 1.0f, py), change(px, py + 1.0f));
  return material.albedo * glm::vec3(texel);
}

/// v at length 1, also where its square leaves the range of floats, as for the normal of a tiny triangle.
glm::vec3 unit(glm::vec3 v) {
  const glm::vec3 size = glm::abs(v);
  const float largest = std::max({size.x, size.y, size.z});
  return largest > 0.0f ? glm::normalize(v / largest) : glm::vec3(0.0f, 0.0f, 1.0f);
}

/// Ray k runs from its origin to the parameter `end` and meets everything.
void set_length(RTCRay16& rays, int k, float end) {
  rays.tnear[k] = 0.0f;
  rays.tfar[k] = end;
  rays.time[k] = 0.0f;
  rays.mask[k] = ~0u;
  rays.flags[k] = 0;
}

/// Draws the 4 x 4 pixels from (x0, y0) on.
void draw_block(const TracedScene& traced, const Rays& rays, const PictureInfo& info, bool trace_shadow, int x0, int y0,
                Image& image) {
  Block out;
  clear(out);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  alignas(64) RTCRayHit16 rh;
  alignas(64) std::array<int, kPacket> valid;
  // One component at a time, so that the compiler makes vectors of the loops.
  const auto fill = [&](float* out, float constant, float per_x, float per_y) {
    for (int k = 0; k < kPacket; ++k)
      out[k] = constant + per_x * (float(x0 + k % kBlock) + 0.5f) + per_y * (float(y0 + k / kBlock) + 0.5f);
  };
  fill(rh.ray.org_x, rays.origin.x, rays.origin_x.x, rays.origin_y.x);
  fill(rh.ray.org_y, rays.origin.y, rays.origin_x.y, rays.origin_y.y);
  fill(rh.ray.org_z, rays.origin.z, rays.origin_x.z, rays.origin_y.z);
  fill(rh.ray.dir_x, rays.direction.x, rays.direction_x.x, rays.direction_y.x);
  fill(rh.ray.dir_y, rays.direction.y, rays.direction_x.y, rays.direction_y.y);
  fill(rh.ray.dir_z, rays.direction.z, rays.direction_x.z, rays.direction_y.z);
  for (int k = 0; k < kPacket; ++k) {
    valid[k] = x0 + k % kBlock < info.width && y0 + k / kBlock < info.height ? -1 : 0;
    set_length(rh.ray, k, std::numeric_limits<float>::infinity());
    rh.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
  }
  rtcIntersect16(valid.data(), traced.rtc, &context, &rh);

  const glm::mat3 view(info.camera.view_from_world);
  alignas(64) RTCRay16 to_light;
  alignas(64) std::array<int, kPacket> wants_shadow{};
  bool any_shadow = false;
  const Light* key = trace_shadow && !info.lights.empty() && info.lights[0].casts_shadow ? &info.lights[0] : nullptr;
  for (int k = 0; k < kPacket; ++k) {
    if (!valid[k]) continue;
    const int x = x0 + k % kBlock, y = y0 + k / kBlock;
    const unsigned geometry = rh.hit.geomID[k];
    if (geometry == RTC_INVALID_GEOMETRY_ID) continue;
    const Mesh& mesh = traced.scene->meshes[geometry];
    const Material& material = traced.scene->materials[mesh.material];
    const unsigned triangle = rh.hit.primID[k];
    const float u = rh.hit.u[k], v = rh.hit.v[k], depth = rh.ray.tfar[k];
    const std::uint32_t* i = mesh.indices.data() + std::size_t(triangle) * 3;
    const glm::vec3 direction(rh.ray.dir_x[k], rh.ray.dir_y[k], rh.ray.dir_z[k]);
    const glm::vec3 hit = glm::vec3(rh.ray.org_x[k], rh.ray.org_y[k], rh.ray.org_z[k]) + direction * depth;
    glm::vec3 geometric(rh.hit.Ng_x[k], rh.hit.Ng_y[k], rh.hit.Ng_z[k]);
    glm::vec3 normal = mesh.normals[i[0]] * (1.0f - u - v) + mesh.normals[i[1]] * u + mesh.normals[i[2]] * v;
    // Facing the camera: the side that is seen counts, whatever the winding says; and interpolation may not turn a
    // normal past the horizon.
    if (glm::dot(geometric, direction) > 0.0f) geometric = -geometric;
    if (glm::dot(normal, geometric) < 0.0f) normal = -normal;
    const float length = glm::length(normal);
    normal = length > 1e-12f ? normal / length : unit(geometric);
    const float away = glm::dot(normal, direction);
    if (away > 0.0f) {
      constexpr float kPastHorizon = 1.001f;
      normal = glm::normalize(normal - direction * (away / glm::dot(direction, direction) * kPastHorizon));
    }
    const glm::vec3 n = view * normal;
    const glm::vec3 albedo =
        albedo_at(traced, rays, mesh, material, triangle, u, v, hit, float(x) + 0.5f, float(y) + 0.5f);
    out.depth[k] = depth;
    out.nx[k] = n.x;
    out.ny[k] = n.y;
    out.nz[k] = n.z;
    out.ar[k] = albedo.r;
    out.ag[k] = albedo.g;
    out.ab[k] = albedo.b;
    out.specular[k] = material.specular_strength;
    out.shininess[k] = material.specular_exponent;
    out.object[k] = float(mesh.object);
    out.material[k] = float(mesh.material);
    if (!key) continue;

    // The key light is in view space; shadow rays run along world axes.
    glm::vec3 light =
        rays.world_from_view * (key->kind == LightKind::kPoint ? key->position * traced.scale : key->direction);
    float far_end = std::numeric_limits<float>::infinity();
    if (key->kind == LightKind::kPoint) {
      light = light + rays.eye - hit;
      far_end = 1.0f;
    }
    if (key->kind == LightKind::kHead) continue;  // it shines from the eye: what is seen is lit
    const float facing = glm::dot(geometric, light);
    if (!(facing > 0.0f)) {
      out.shadow[k] = 0.0f;
      continue;
    }
    const glm::vec3 extent = glm::abs(hit) + glm::abs(hit - rays.eye);
    const float offset = kShadowOffset * std::max({extent.x, extent.y, extent.z});
    const glm::vec3 start = hit + unit(geometric) * offset;
    to_light.org_x[k] = start.x;
    to_light.org_y[k] = start.y;
    to_light.org_z[k] = start.z;
    to_light.dir_x[k] = light.x;
    to_light.dir_y[k] = light.y;
    to_light.dir_z[k] = light.z;
    set_length(to_light, k, far_end);
    wants_shadow[k] = -1;
    any_shadow = true;
  }
  if (any_shadow) {
    rtcOccluded16(wants_shadow.data(), traced.rtc, &context, &to_light);
    for (int k = 0; k < kPacket; ++k)
      if (wants_shadow[k] && to_light.tfar[k] < 0.0f) out.shadow[k] = 0.0f;
  }
  store(out, x0, y0, image);
}

}  // namespace

Result<TracedScenePtr> trace_ready(const Scene& scene) {
  TracedScenePtr traced(new TracedScene);
  traced->scene = &scene;
  traced->device = rtcNewDevice(nullptr);
  if (!traced->device)
    return device_error("Embree cannot start on this machine (error {})", int(rtcGetDeviceError(nullptr)));
  traced->rtc = rtcNewScene(traced->device);
  rtcSetSceneFlags(traced->rtc, RTC_SCENE_FLAG_ROBUST);
  traced->center = scene.center();
  if (const float radius = scene.radius(); radius > 0.0f) traced->scale = std::exp2(-std::round(std::log2(radius)));
  for (const Texture& texture : scene.textures) traced->textures.push_back(make_mips(texture));
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    const RTCGeometry geometry = rtcNewGeometry(traced->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    // Embree's own buffers: it reads 16 bytes per vertex, past the end of a shared array of 12.
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3),
                                             mesh.positions.size());
    void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            3 * sizeof(std::uint32_t), mesh.indices.size() / 3);
    if (!vertices || !indices) {
      rtcReleaseGeometry(geometry);
      return device_error("{}: not enough memory for {} triangles", scene.name, scene.triangle_count());
    }
    std::transform(mesh.positions.begin(), mesh.positions.end(), static_cast<glm::vec3*>(vertices),
                   [&](glm::vec3 p) { return traced->unit_of(p); });
    std::memcpy(indices, mesh.indices.data(), mesh.indices.size() * sizeof(std::uint32_t));
    rtcSetGeometryUserData(geometry, traced.get());
    if (is_masked(*traced, mesh)) {
      rtcSetGeometryIntersectFilterFunction(geometry, cut_away);
      rtcSetGeometryOccludedFilterFunction(geometry, cut_away);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(traced->rtc, geometry, unsigned(m));
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(traced->rtc);
  if (const RTCError error = rtcGetDeviceError(traced->device); error != RTC_ERROR_NONE)
    return device_error("{}: Embree cannot build its hierarchy of {} triangles (error {})", scene.name,
                        scene.triangle_count(), int(error));
  return traced;
}

PictureInfo picture_info(const Scene& scene, const Camera& camera, int width, int height) {
  PictureInfo info;
  info.width = width;
  info.height = height;
  info.camera = camera;
  info.ambient = scene.ambient;
  info.scene_radius = scene.radius();
  float nearest = std::numeric_limits<float>::infinity(), farthest = 0.0f;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 p(corner & 1 ? scene.bounds_max.x : scene.bounds_min.x,
                      corner & 2 ? scene.bounds_max.y : scene.bounds_min.y,
                      corner & 4 ? scene.bounds_max.z : scene.bounds_min.z);
    const float depth = -(camera.view_from_world * glm::vec4(p, 1.0f)).z;
    nearest = std::min(nearest, depth);
    farthest = std::max(farthest, depth);
  }
  constexpr float kNearestShare = 1e-3f;  // of the farthest depth, for a camera inside the scene
  info.depth_max = farthest > 0.0f ? farthest : 1.0f;
  info.depth_min = std::clamp(nearest, kNearestShare * info.depth_max, info.depth_max);
  const glm::mat3 rotation(camera.view_from_world);
  for (Light light : scene.lights) {
    light.direction = rotation * light.direction;
    light.position = glm::vec3(camera.view_from_world * glm::vec4(light.position, 1.0f));
    info.lights.push_back(light);
  }
  return info;
}

Image capture_planes(const TracedScene& traced, const PictureInfo& info, const CaptureSettings& settings) {
  Image image(info.width, info.height);
  for (const char* name : kPlaneNames) image.add(name);
  const Rays rays = rays_of(traced, info);
  if (!within_reach(rays, info)) {
    // From there nothing is seen.
    Block background;
    clear(background);
    for (int y = 0; y < info.height; y += kBlock)
      for (int x = 0; x < info.width; x += kBlock) store(background, x, y, image);
    return image;
  }
  const int columns = (info.width + kBlock - 1) / kBlock, rows = (info.height + kBlock - 1) / kBlock;
  tbb::parallel_for(tbb::blocked_range2d<int>(0, rows, kTileBlocks, 0, columns, kTileBlocks), [&](const auto& range) {
    for (int r = range.rows().begin(); r < range.rows().end(); ++r)
      for (int c = range.cols().begin(); c < range.cols().end(); ++c)
        draw_block(traced, rays, info, settings.shadow, c * kBlock, r * kBlock, image);
  });
  return image;
}

}  // namespace umbrage
