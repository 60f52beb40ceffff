#include "devices/vulkan/scene_capture.h"

#include <bit>
#include <functional>
#include <string_view>
#include <utility>

#include "core/check.h"
#include "core/lists.h"
#include "devices/shared/capture_info.h"
#include "devices/shared/dispatches.h"
#include "devices/shared/soften_dispatches.h"
#include "devices/vulkan/gpu_capture.h"

namespace umbrage {

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
  if (auto fine = check_capture(settings); !fine) return fine.error();
  Frame frame;
  frame.info = picture_info(*scene_->scene, camera, settings);
  frame.info.occluders = occluders_of(*scene_->scene, settings.occluders, occluders_);
  if (settings.extra_views > 0 && !traced_) {  // their cameras are found by tracing rays
    const ProgressMonitor preparation_monitor = monitor ? [&](double) { return monitor(0.0); } : ProgressMonitor();
    auto traced = build_traced_scene(*scene_->scene, threads_, preparation_monitor);
    if (!traced) return traced.error();
    traced_ = std::move(*traced);
  }
  add_layers(traced_ ? *traced_ : TracedScene(), settings, frame.info);
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
    if (auto done = draw_layer(frame, names, settings, layer, back, softened); !done) return done.error();
  }
  if (auto done = soften(frame, radii); !done) return done.error();
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
    const auto drawn = draw_triangle_indices(info, layer, planes, std::as_bytes(std::span(&constants, 1)), table);
    if (!drawn) return drawn.error();
    indices = *drawn;
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
  if (auto done = dispatcher_->dispatch({.pipeline = *pipeline,
                                         .effect = "capture",
                                         .dispatch = layer_plane(layer, "seen"),
                                         .settings = (scene_->number * kMaxLayers + std::size_t(layer)) * 64 + size,
                                         .target = target_.get(),
                                         .triangles = scene_->triangles,
                                         .points = scene_->points},
                                        info, constants, table);
      !done)
    return done.error();
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
          if (auto done = run(soften_reach_dispatch(), blocks, {},
                              {{"penumbra", down ? penumbra.down : penumbra.across}, {"soften_reach", *reach}});
              !done)
            return done;
        if (auto done = run(soften_dispatch(), frame.info, {.dx = 1 - down, .dy = down, .second = second},
                            {{"soften_from", down ? *between : shadow},
                             {"soften_to", down ? shadow : *between},
                             {"soften_reach", *reach}});
            !done)
          return done;
      }
  }
  return {};
}

}  // namespace umbrage
