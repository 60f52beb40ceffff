#include "devices/cpu/capture.h"

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

#include "rays/camera_rays.h"
#include "rays/traced_scene.h"

namespace umbrage {
namespace {

constexpr int kBlock = 4;       // a packet of rays is a block of 4 x 4 pixels
constexpr int kTileBlocks = 8;  // blocks per side of a tile that one task draws: 32 pixels
// The next surface along a ray is looked for this share of the hit's distance from the scene's origin and from the eye
// behind the last one: two triangles that share an edge are one surface, and a sheet of paper has two sides.
constexpr float kLayerStep = 1e-5f;

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
void store(const Block& block, int x0, int y0, int layer, Image& image) {
  const float* values = block.depth;
  for (std::size_t p = 0; p < kPlaneNames.size(); ++p) {
    Plane& plane = image.planes[std::size_t(layer) * kPlaneNames.size() + p];
    for (int j = 0; j < kBlock && y0 + j < image.height; ++j)
      std::memcpy(plane.row(y0 + j) + x0, values + j * kBlock, kBlock * sizeof(float));
    values += kPacket;
  }
}

/// Fills a block from the hits of its primary rays; `valid` names the pixels that the picture has.
void shade_block(const TracedScene& traced, const CameraRays& rays, const PictureInfo& info, bool trace_shadow, int x0,
                 int y0, const RTCRayHit16& rh, const std::array<int, kPacket>& valid, Block& out) {
  clear(out);
  const glm::mat3 view(info.camera.view_from_world);
  alignas(64) RTCRay16 to_light;
  alignas(64) std::array<int, kPacket> wants_shadow{};
  bool any_shadow = false;
  const Light* key = trace_shadow && !info.lights.empty() && info.lights[0].casts_shadow ? &info.lights[0] : nullptr;
  for (int k = 0; k < kPacket; ++k) {
    if (!valid[k] || rh.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) continue;
    const Surface surface = surface_at(traced, rh.hit.geomID[k], rh.hit.primID[k], rh.hit.u[k], rh.hit.v[k],
                                       {rh.ray.org_x[k], rh.ray.org_y[k], rh.ray.org_z[k]},
                                       {rh.ray.dir_x[k], rh.ray.dir_y[k], rh.ray.dir_z[k]},
                                       {rh.hit.Ng_x[k], rh.hit.Ng_y[k], rh.hit.Ng_z[k]}, rh.ray.tfar[k]);
    const glm::vec3 n = view * surface.normal;
    const glm::vec3 albedo =
        pixel_albedo(traced, rays, surface, float(x0 + k % kBlock) + 0.5f, float(y0 + k / kBlock) + 0.5f);
    out.depth[k] = rh.ray.tfar[k];
    out.nx[k] = n.x;
    out.ny[k] = n.y;
    out.nz[k] = n.z;
    out.ar[k] = albedo.r;
    out.ag[k] = albedo.g;
    out.ab[k] = albedo.b;
    out.specular[k] = surface.material->specular_strength;
    out.shininess[k] = surface.material->specular_exponent;
    out.object[k] = float(surface.mesh->object);
    out.material[k] = float(surface.mesh->material);
    if (!key) continue;

    // The key light is in view space; shadow rays run along world axes.
    glm::vec3 light =
        rays.world_from_view * (key->kind == LightKind::kPoint ? key->position * traced.scale : key->direction);
    float far_end = std::numeric_limits<float>::infinity();
    if (key->kind == LightKind::kPoint) {
      light = light + rays.eye - surface.position;
      far_end = 1.0f;
    }
    if (key->kind == LightKind::kHead) continue;  // it shines from the eye: what is seen is lit
    if (!(glm::dot(surface.geometric, light) > 0.0f)) {
      out.shadow[k] = 0.0f;
      continue;
    }
    set_ray(to_light, k, start_above(surface, rays.eye), light, far_end);
    wants_shadow[k] = -1;
    any_shadow = true;
  }
  if (!any_shadow) return;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcOccluded16(wants_shadow.data(), traced.rtc, &context, &to_light);
  for (int k = 0; k < kPacket; ++k)
    if (wants_shadow[k] && to_light.tfar[k] < 0.0f) out.shadow[k] = 0.0f;
}

/// Draws the 4 x 4 pixels from (x0, y0) on, all layers.
void draw_block(const TracedScene& traced, const CameraRays& rays, const PictureInfo& info,
                const CaptureSettings& settings, int x0, int y0, Image& image) {
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
  Block block;
  for (int layer = 0; layer < settings.layers; ++layer) {
    if (layer > 0) {
      bool any = false;
      for (int k = 0; k < kPacket; ++k) {
        valid[k] = valid[k] && rh.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID ? -1 : 0;
        if (!valid[k]) continue;
        any = true;
        const glm::vec3 direction(rh.ray.dir_x[k], rh.ray.dir_y[k], rh.ray.dir_z[k]);
        const glm::vec3 origin(rh.ray.org_x[k], rh.ray.org_y[k], rh.ray.org_z[k]);
        const float depth = rh.ray.tfar[k];
        const glm::vec3 hit = origin + direction * depth;
        const float step = kLayerStep * (glm::length(hit) + glm::distance(hit, rays.eye)) / glm::length(direction);
        set_length(rh.ray, k, std::numeric_limits<float>::infinity());
        rh.ray.tnear[k] = depth + step;
        rh.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
      }
      if (!any) {
        clear(block);
        store(block, x0, y0, layer, image);
        continue;
      }
    }
    rtcIntersect16(valid.data(), traced.rtc, &context, &rh);
    shade_block(traced, rays, info, settings.shadow, x0, y0, rh, valid, block);
    store(block, x0, y0, layer, image);
  }
}

}  // namespace

PictureInfo picture_info(const Scene& scene, const Camera& camera, const CaptureSettings& settings) {
  PictureInfo info = with_guard({.width = settings.width, .height = settings.height, .camera = camera}, settings.guard);
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
  image.planes.reserve(std::size_t(settings.layers) * kPlaneNames.size());
  for (int layer = 0; layer < settings.layers; ++layer)
    for (const char* name : kPlaneNames) image.add(layer_plane(layer, name));
  const CameraRays rays = camera_rays(traced, info);
  if (!within_reach(rays, info)) {
    // From there nothing is seen.
    Block background;
    clear(background);
    for (int y = 0; y < info.height; y += kBlock)
      for (int x = 0; x < info.width; x += kBlock)
        for (int layer = 0; layer < settings.layers; ++layer) store(background, x, y, layer, image);
    return image;
  }
  const int columns = (info.width + kBlock - 1) / kBlock, rows = (info.height + kBlock - 1) / kBlock;
  tbb::parallel_for(tbb::blocked_range2d<int>(0, rows, kTileBlocks, 0, columns, kTileBlocks), [&](const auto& range) {
    for (int r = range.rows().begin(); r < range.rows().end(); ++r)
      for (int c = range.cols().begin(); c < range.cols().end(); ++c)
        draw_block(traced, rays, info, settings, c * kBlock, r * kBlock, image);
  });
  return image;
}

}  // namespace umbrage
