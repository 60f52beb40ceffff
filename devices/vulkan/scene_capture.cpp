#include "devices/vulkan/scene_capture.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <string_view>
#include <utility>

#include "core/check.h"
#include "core/light_rig.h"
#include "core/lists.h"
#include "devices/shared/capture_info.h"
#include "devices/vulkan/capture.h"
#include "rays/camera_rays.h"
#include "rays/hit_light.h"
#include "rays/shadow_lights.h"

namespace umbrage {
namespace {

void copy_to(const glm::vec3& v, float* to) {
  for (int c = 0; c < 3; ++c) to[c] = v[c];
}

/// Computes the projection of triangles. A point on a ray is origin + x origin_x + y origin_y + t (direction + x
/// direction_x + y direction_y). The projection yields x and y, in perspective multiplied by t, and t.
void set_projection(const TracedScene& unit, const CameraRays& rays, const PictureInfo& info, CaptureConstants& c) {
  constexpr float kNearest = 1e-6f;  // near clipping depth, relative to the farthest depth
  const bool parallel = info.camera.projection == Projection::kOrthographic;
  const glm::dmat3 rows = glm::transpose(
      glm::inverse(glm::dmat3(glm::dvec3(parallel ? rays.origin_x : rays.direction_x),
                              glm::dvec3(parallel ? rays.origin_y : rays.direction_y), glm::dvec3(rays.direction))));
  const glm::dvec3 away = parallel ? glm::dvec3(0.0) : rows[2];
  copy_to(glm::vec3(rows[0] * (2.0 / info.width) - away), c.clip_x);
  copy_to(glm::vec3(rows[1] * (2.0 / info.height) - away), c.clip_y);
  copy_to(glm::vec3(rows[2]), c.clip_w);
  c.orthographic = parallel ? 1 : 0;
  double farthest = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3& low = unit.scene->bounds_min;
    const glm::vec3& high = unit.scene->bounds_max;
    const glm::vec3 p(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z);
    farthest = std::max(farthest, glm::dot(rows[2], glm::dvec3(unit.unit_of(p) - rays.origin)));
  }
  c.nearest = kNearest * float(farthest);
}

void set_hit_light(const HitLighting& lighting, CaptureConstants& c) {
  static_assert(kCaptureHitLights == kMaxRigLights);
  for (const TracedLight& light : lighting.lights) {
    CaptureHitLight& out = c.hit_lights[c.hit_light_count++];
    out.point = light.point ? 1 : 0;
    out.from_camera = light.from_camera ? 1 : 0;
    out.casts_shadow = light.casts_shadow ? 1 : 0;
    copy_to(light.where, out.where);
    copy_to(light.color, out.color);
    out.reach_squared = light.reach_squared;
    out.min_squared = light.min_squared;
  }
  c.max_emission = lighting.max_emission;
  copy_to(lighting.ambient, c.ambient);
  c.even_ambient = lighting.even_ambient ? 1 : 0;
  for (int k = 0; k < 48; ++k)
    c.ambient_shape[k] = lighting.ambient_shape.by_color[std::size_t(k / 16)][k / 4 % 4][k % 4];
}

/// Returns the unit space of a scene: only the members that camera_rays uses.
TracedScene unit_space(const DeviceScene& scene) {
  TracedScene unit;
  unit.scene = scene.scene;
  unit.center = scene.center;
  unit.scale = scene.scale;
  return unit;
}

/// Returns the constants that any rays from the pixels of a picture need. Does not read the host's scene.
CaptureConstants pixel_constants(const DeviceScene& scene, const CameraRays& rays, const PictureInfo& info,
                                 int stride) {
  CaptureConstants c{};
  c.width = info.width;
  c.height = info.height;
  c.stride = stride;
  c.root = scene.root;
  c.min_opacity = c.opaque = kOpaque;
  const glm::mat3 to_view(info.camera.view_from_world);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) c.to_view[3 * row + column] = to_view[column][row];
  c.unit_scale = scene.scale;
  copy_to(rays.eye, c.eye);
  copy_to(rays.origin, c.origin);
  copy_to(rays.origin_x, c.origin_x);
  copy_to(rays.origin_y, c.origin_y);
  copy_to(rays.direction, c.direction);
  copy_to(rays.direction_x, c.direction_x);
  copy_to(rays.direction_y, c.direction_y);
  return c;
}

/// Returns the constants of a layer of the picture. `back`: also capture the back sides of its surfaces.
CaptureConstants capture_constants(const DeviceScene& scene, const PictureInfo& info, const CaptureSettings& settings,
                                   int stride, bool back) {
  static_assert(kCaptureLights == kMaxShadows);
  const TracedScene unit = unit_space(scene);
  const CameraRays rays = camera_rays(unit, info);
  CaptureConstants c = pixel_constants(scene, rays, info, stride);
  c.nothing_visible = scene.empty || !rays_within_limit(rays, info) ? 1 : 0;
  c.back = back ? 1 : 0;
  c.sample_index = settings.sample;
  c.blended = settings.blended ? 1 : 0;
  if (settings.blended) c.min_opacity = kMinOpacity;
  c.min_shadow_opacity = kMinShadowOpacity;
  c.glass_reflectance = kGlassReflectance;
  set_projection(unit, rays, info, c);
  for (const ShadowLight& light : shadow_lights(unit, rays, info, settings)) {
    const int k = c.light_count++;
    c.light_index[k] = light.index;
    c.light_point[k] = light.point ? 1 : 0;
    c.light_rays[k] = light.rays;
    c.light_size[k] = light.size;
    copy_to(light.where, c.light_where + 3 * k);
    copy_to(light.right, c.light_right + 3 * k);
    copy_to(light.up, c.light_up + 3 * k);
  }
  return c;
}

/// Returns the constants for ray number `ray` of each pixel of a picture of the scene. Does not read the host's scene.
CaptureConstants ray_constants(const DeviceScene& scene, const PictureInfo& info, const RaySettings& settings, int ray,
                               int stride) {
  static_assert(int(Falloff::kNone) == kNoFalloff && int(Falloff::kLinear) == kLinearFalloff &&
                int(Falloff::kSmooth) == kSmoothFalloff);
  const TracedScene unit = unit_space(scene);
  CaptureConstants c = pixel_constants(scene, camera_rays(unit, info), info, stride);
  c.ray = ray;
  c.last_ray = settings.max_rays - 1;
  c.ray_length = settings.radius * scene.scale;
  c.falloff = int(settings.falloff);
  if (settings.light > 0.0f) set_hit_light(hit_lighting(unit, info, settings.ambient_bounce, c.ray_length), c);
  c.light = settings.light;
  c.directional = settings.directional;
  std::copy(settings.sky.begin(), settings.sky.end(), c.sky);
  c.seed = int(settings.seed);
  return c;
}

/// Returns whether the triangles of this layer can be rasterised, which replaces primary rays.
bool can_draw(const DeviceScene& scene, const CaptureConstants& c, const Gpu& gpu) {
  if (scene.empty || c.nothing_visible || std::max(c.width, c.height) > gpu.max_drawn_side) return false;
  // Triangles cannot be drawn either if everything is behind the camera or all rays lie in one plane.
  const auto finite = [](const float(&row)[3]) {
    return std::all_of(row, row + 3, [](float v) { return std::isfinite(v); });
  };
  return c.nearest > 0.0f && std::isfinite(c.nearest) && finite(c.clip_x) && finite(c.clip_y) && finite(c.clip_w);
}

/// Returns the index of a captured plane in the table of addresses.
int capture_slot(std::string_view plane) {
  constexpr std::pair<std::string_view, int> kSlots[] = {
      {"depth", kDepthSlot},
      {"normal.x", kNormalSlot},
      {"normal.y", kNormalSlot + 1},
      {"normal.z", kNormalSlot + 2},
      {"albedo.r", kAlbedoSlot},
      {"albedo.g", kAlbedoSlot + 1},
      {"albedo.b", kAlbedoSlot + 2},
      {"specular", kSpecularSlot},
      {"shininess", kShininessSlot},
      {"emission.r", kEmissionSlot},
      {"emission.g", kEmissionSlot + 1},
      {"emission.b", kEmissionSlot + 2},
      {"metallic", kMetallicSlot},
      {"roughness", kRoughnessSlot},
      {"material_ao", kMaterialAoSlot},
      {"object_id", kObjectSlot},
      {"material_id", kMaterialSlot},
      {"opacity", kOpacitySlot},
      {"transmittance.r", kTransmittanceSlot},
      {"transmittance.g", kTransmittanceSlot + 1},
      {"transmittance.b", kTransmittanceSlot + 2},
      {"ray_offset.x", kRayOffsetSlot},
      {"ray_offset.y", kRayOffsetSlot + 1},
      {"ray_offset.z", kRayOffsetSlot + 2},
  };
  for (const auto& [name, slot] : kSlots)
    if (plane == name) return slot;
  for (int light = 0; light < kMaxShadows; ++light)
    if (plane == shadow_plane(light)) return kShadowSlot + light;
  fail_check(fmt::format("plane '{}' cannot be captured", plane));
}

}  // namespace

Result<void> SceneCapture::prepare(const Scene& scene, const ProgressMonitor& monitor) {
  scene_.reset();
  traced_.reset();
  auto ready = upload_scene(scene, *memory_, *commands_, *gpu_, monitor);
  if (!ready) return ready.error();
  ready->number = ++scene_count_;
  scene_ = std::make_shared<const DeviceScene>(std::move(*ready));
  occluders_ = {};
  return {};
}

Result<void> SceneCapture::release_memory() {
  if (!scene_) return {};  // no scene was prepared
  const RasterTargetPtr released = std::exchange(target_, nullptr);
  return commands_->finish();
}

Result<Frame> SceneCapture::capture(const Camera& camera, const CaptureSettings& settings,
                                    const ProgressMonitor& monitor) {
  if (!scene_) fail_check("capture before prepare");
  if (auto status = check_capture(settings); !status) return status.error();
  Frame frame;
  frame.info = picture_info(*scene_->scene, camera, settings);
  frame.info.occluders = occluders_of(*scene_->scene, settings.occluders, occluders_);
  if (settings.extra_views > 0 && !traced_) {  // their cameras are found by tracing rays
    const ProgressMonitor preparation_monitor = monitor ? [&](double) { return monitor(0.0); } : ProgressMonitor();
    auto traced = build_traced_scene(*scene_->scene, threads_, preparation_monitor);
    if (!traced) return traced.error();
    traced_ = std::move(*traced);
  }
  const TracedScene none;
  add_layers(traced_ ? *traced_ : none, settings, frame.info);
  auto planes = empty_planes(frame.info);
  planes->scene = scene_;
  frame.storage = planes;
  const int all = 1 + int(frame.info.more_layers.size());
  const std::vector<std::string> names = captured_planes(*scene_->scene, frame.info, settings);
  for (int layer = 0; layer < all; ++layer)
    for (const std::string& name : names)
      if (const auto made = store_->writable(*planes, layer_plane(layer, name)); !made) return made.error();
  std::vector<PenumbraPlanes> radii;
  for (const int light : softened_lights(frame.info, settings)) {
    const auto across = memory_->plane(planes->bytes), down = memory_->plane(planes->bytes);
    if (!across) return across.error();
    if (!down) return down.error();
    radii.push_back({light, *across, *down});
  }
  const auto kind_of = [&](int layer) {
    return layer == 0 ? LayerKind::kBehind : frame.info.more_layers[std::size_t(layer) - 1].kind;
  };
  for (int layer = 0; layer < all; ++layer) {
    if (kind_of(layer) == LayerKind::kBack) continue;  // captured with its front sides
    int back = -1;
    for (int k = 1; k < all; ++k)
      if (kind_of(k) == LayerKind::kBack && frame.info.more_layers[std::size_t(k) - 1].of == layer) back = k;
    const auto softened = std::span(radii).first(layer == 0 ? radii.size() : 0);
    if (auto status = draw_layer(frame, names, settings, layer, back, softened); !status) return status.error();
  }
  if (auto status = soften(frame, radii); !status) return status.error();
  return frame;
}

Result<void> SceneCapture::draw_layer(const Frame& frame, const std::vector<std::string>& names,
                                      const CaptureSettings& settings, int layer, int back,
                                      std::span<const PenumbraPlanes> radii) {
  const DevicePlanes& planes = planes_of(frame);
  const auto pipeline = pipelines_->capture();
  if (!pipeline) return pipeline.error();
  std::vector<VkDeviceAddress> table(kCaptureSlots);
  for (const std::string& name : names) {
    table[std::size_t(capture_slot(name))] = planes.find(layer_plane(layer, name))->address;
    if (back > 0) table[kBackSlots + std::size_t(capture_slot(name))] = planes.find(layer_plane(back, name))->address;
  }
  const bool has_own_camera = layer > 0 && frame.info.more_layers[std::size_t(layer) - 1].kind == LayerKind::kOther;
  if (layer > 0 && !has_own_camera) table[kPreviousDepthSlot] = planes.find(layer_plane(layer - 1, "depth"))->address;
  for (std::size_t k = 0; k < scene_->buffers.size(); ++k) table[kNodesSlot + k] = scene_->buffers[k]->address;
  for (const PenumbraPlanes& penumbra : radii) {
    table[kPenumbraSlot + 2 * std::size_t(penumbra.light)] = penumbra.across->address;
    table[kPenumbraSlot + 2 * std::size_t(penumbra.light) + 1] = penumbra.down->address;
  }
  const PictureInfo info = layer_info(frame.info, layer);
  const CaptureConstants constants = capture_constants(*scene_, info, settings, planes.stride, back > 0);
  // The time of the rays depends on the scene, the lights and the previous layers.
  const std::size_t kind =
      ((scene_->number * kMaxLayers + std::size_t(layer)) * 64 + std::size_t(settings.shadow_rays)) * 64 +
      std::size_t(settings.shadows);
  DevicePlanePtr indices;
  if (draws_ && can_draw(*scene_, constants, *gpu_)) {
    const auto plane = draw_triangle_indices(info, layer, planes, std::as_bytes(std::span(&constants, 1)), table);
    if (!plane) return plane.error();
    indices = *plane;
    if (indices) table[kTriangleIndexSlot] = indices->address;
  }
  return dispatcher_->dispatch({*pipeline, "capture", layer_plane(layer, "planes"), kind}, info,
                               std::as_bytes(std::span(&constants, 1)), table);
}

Result<DevicePlanePtr> SceneCapture::draw_triangle_indices(const PictureInfo& info, int layer,
                                                           const DevicePlanes& planes, Dispatcher::Constants constants,
                                                           Dispatcher::Table table) {
  const auto pipeline = pipelines_->peel(scene_->masks, scene_->points);
  if (!pipeline) return pipeline.error();
  auto indices = memory_->plane(planes.bytes);  // allocated first, since this may release target_
  if (!indices) return DevicePlanePtr();
  if (!target_ || target_->width != info.width || target_->height != info.height) {
    const auto drawing = pipelines_->drawing(true);
    if (!drawing) return drawing.error();
    target_.reset();  // no longer in use, or kept alive by the commands
    const auto made = make_raster_target(gpu_, *memory_, *drawing, info.width, info.height);
    if (!made) return DevicePlanePtr();  // a lost device reports its error with the next call
    target_ = *made;
  }
  // The time per triangle grows with the size of the picture.
  const std::size_t size = std::bit_width(std::uint64_t(info.width) * std::uint64_t(info.height));
  if (auto status = dispatcher_->dispatch({.pipeline = *pipeline,
                                           .effect = "capture",
                                           .dispatch = layer_plane(layer, "seen"),
                                           .settings = (scene_->number * kMaxLayers + std::size_t(layer)) * 64 + size,
                                           .target = target_.get(),
                                           .triangles = scene_->triangles,
                                           .points = scene_->points},
                                          info, constants, table);
      !status)
    return status.error();
  const auto buffer = commands_->buffer();
  if (!buffer) return buffer.error();
  copy_triangle_indices(*gpu_, *buffer, *target_, **indices, planes.stride);
  commands_->keep(target_);
  return indices;
}

Result<void> SceneCapture::trace_rays(const DispatchRun& run, const RaySettings& settings, const DevicePlanes& planes,
                                      const StepPlanes& rays) {
  const auto pipeline = pipelines_->trace_rays();
  if (!pipeline) return pipeline.error();
  const DeviceScene& scene = *planes.scene;
  std::vector<VkDeviceAddress> table(kCaptureSlots);
  for (const std::string_view name : {"depth", "ray_offset.x", "ray_offset.y", "ray_offset.z"})
    table[std::size_t(capture_slot(name))] = planes.find(run.plane(name))->address;
  for (std::size_t k = 0; k < scene.buffers.size(); ++k) table[kNodesSlot + k] = scene.buffers[k]->address;
  constexpr std::pair<std::string_view, int> kRaySlots[] = {
      {"ray.x", kRaySlot}, {"ray.y", kRaySlot + 1}, {"ray.z", kRaySlot + 2}};
  for (const auto& [name, slot] : kRaySlots) table[std::size_t(slot)] = rays.at(name)->address;
  constexpr std::pair<std::string_view, int> kOutputSlots[] = {{"ao", kOpenSlot},
                                                               {"traced_confidence", kConfidenceSlot},
                                                               {"bent.x", kBentSlot},
                                                               {"bent.y", kBentSlot + 1},
                                                               {"bent.z", kBentSlot + 2},
                                                               {"indirect.r", kIndirectSlot},
                                                               {"indirect.g", kIndirectSlot + 1},
                                                               {"indirect.b", kIndirectSlot + 2}};
  const auto& outputs = run.dispatch.outputs;
  for (const auto& [name, slot] : kOutputSlots)
    if (contains(outputs, name)) table[std::size_t(slot)] = planes.find(run.plane(name))->address;
  const CaptureConstants constants = ray_constants(scene, run.info, settings, run.round, planes.stride);
  // The time depends on the scene, the lights, the length of the rays, and how many pixels have a ray of this index.
  const std::size_t kind =
      (scene.number * 1024 + std::size_t(run.round)) * 4096 + std::hash<float>()(settings.radius) % 4096;
  return dispatcher_->dispatch({*pipeline, run.effect.name, run.dispatch.name, kind}, run.info,
                               std::as_bytes(std::span(&constants, 1)), table);
}

Result<void> SceneCapture::soften(const Frame& frame, std::span<const PenumbraPlanes> radii) {
  if (radii.empty()) return {};
  const DevicePlanes& planes = planes_of(frame);
  const auto between = memory_->plane(planes.bytes);
  if (!between) return between.error();
  const auto reach = memory_->plane(planes.bytes);
  if (!reach) return reach.error();
  const auto run = [&](const Dispatch& dispatch, const PictureInfo& info, const SoftenConstants& constants,
                       const StepPlanes& own) -> Result<void> {
    const GpuStep step = plain_step(dispatch);
    const std::vector<std::byte> block =
        block_of(frame_constants(info, planes.stride, 0), std::as_bytes(std::span(&constants, 1)));
    std::vector<const DevicePlane*> table;
    for (std::string_view name : plane_table(step)) {
      const auto found = own.find(name);
      table.push_back(found != own.end() ? found->second.get() : planes.find(name));
    }
    return dispatcher_->run_kernel(step, {.effect = "capture", .dispatch = dispatch.name}, info, block, planes.bytes,
                                   table);
  };
  PictureInfo blocks = frame.info;
  blocks.width = (blocks.width + kSoftenBlock - 1) / kSoftenBlock;
  blocks.height = (blocks.height + kSoftenBlock - 1) / kSoftenBlock;
  for (const PenumbraPlanes& penumbra : radii) {
    const DevicePlanePtr& shadow = planes.stored.find(shadow_plane(penumbra.light))->second;
    for (const int second : {0, 1})
      for (const int down : {0, 1}) {
        if (second)
          if (auto status = run(soften_reach_dispatch(), blocks, {},
                                {{"penumbra", down ? penumbra.down : penumbra.across}, {"soften_reach", *reach}});
              !status)
            return status;
        if (auto status = run(soften_dispatch(), frame.info, {.dx = 1 - down, .dy = down, .second = second},
                              {{"soften_from", down ? *between : shadow},
                               {"soften_to", down ? shadow : *between},
                               {"soften_reach", *reach}});
            !status)
          return status;
      }
  }
  return {};
}

}  // namespace umbrage
