// The C interface for a caller's own Vulkan device.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/guarded.h"
#include "core/registry.h"
#include "devices/vulkan/gpu.h"
#include "devices/vulkan/vulkan_device.h"
#include "effects/normals/normals.h"
#include "library/device.h"
#include "library/lens.h"
#include "renderer/devices.h"
#include "renderer/recipe.h"
#include "umbrage/vulkan.h"

namespace umbrage {

class VulkanShadingObject final : public Object {
 public:
  explicit VulkanShadingObject(std::unique_ptr<Device> opened) : device(std::move(opened)) {}
  std::string memory_purpose(const char*) const override { return "a G-buffer of " + size; }

  std::unique_ptr<Device> device;
  std::string size = "no pixels";  ///< of the G-buffer of the current call

 protected:
  Object* reporting_device() override { return nullptr; }
};

namespace {

const std::vector<std::string> kDepth = {"depth"};
const std::vector<std::string> kNormal = {"normal.x", "normal.y", "normal.z"};
const std::vector<std::string> kAlbedo = {"albedo.r", "albedo.g", "albedo.b"};
const std::vector<std::string> kLit = {"lit.r", "lit.g", "lit.b"};

DeviceImage device_image(const UmbVulkanImage& image) {
  return {image.image, image.format, image.layout, image.layout_after};
}

int depth_role(DepthMeaning kind) {
  switch (kind) {
    case DepthMeaning::kPlanar:
      return kViewDepthRole;
    case DepthMeaning::kDistance:
      return kRayDepthRole;
    case DepthMeaning::kWindow:
      return kWindowDepthRole;
    default:
      break;
  }
  return kReversedDepthRole;
}

Lens lens_of(const UmbVulkanGBuffer& g) {
  return {.width = g.width,
          .height = g.height,
          .depth_kind = DepthMeaning(g.depth_kind),
          .near_plane = g.near_plane,
          .far_plane = g.far_plane != 0.0f ? g.far_plane : std::numeric_limits<float>::infinity(),
          .orthographic = g.orthographic != 0,
          .left = g.left,
          .right = g.right,
          .bottom = g.bottom,
          .top = g.top,
          .scene_radius = g.scene_radius};
}

PictureInfo info_of(const Lens& lens) {
  PictureInfo info;
  set_lens(lens, info);
  info.scene_radius = lens.scene_radius;
  // Depth is not read here. The depth range is that of the near and far planes; without them, or if the far plane is at
  // infinity, it follows from the scene's radius.
  const bool planes = has_depth_planes(lens.depth_kind);
  constexpr float kNearest = 1e-3f;
  info.depth_min = planes ? lens.near_plane : kNearest * lens.scene_radius;
  info.depth_max = planes && std::isfinite(lens.far_plane) ? lens.far_plane : info.depth_min + 2.0f * lens.scene_radius;
  return info;
}

Result<void> check(const UmbVulkanGBuffer& g, const Lens& lens) {
  if (!g.depth.image) return usage_error("a G-buffer needs a depth image");
  if (g.depth_kind < UMB_DEPTH_PLANAR || g.depth_kind > UMB_DEPTH_REVERSED)
    return field_error("depth_kind", g.depth_kind, "`{}` cannot be '{}': see UmbDepthKind");
  if (auto status = check_lens(lens); !status) return status;
  if (!(lens.scene_radius > 0.0f))
    return field_error("scene_radius", lens.scene_radius, "`{}` cannot be '{}': it takes a finite number above 0");
  return {};
}

std::vector<std::string> texts_of(const char* const* texts, int count) {
  std::vector<std::string> all;
  for (int k = 0; texts && k < count; ++k) all.push_back(text_of(texts[k]));
  return all;
}

bool is_set(const float (&m)[9]) {
  return std::any_of(std::begin(m), std::end(m), [](float v) { return v != 0.0f; });
}

/// Returns an error if the work cannot be recorded into a command buffer.
Result<void> check_recordable(const std::vector<const Effect*>& work, const EffectSettings& settings,
                              const PictureInfo& info) {
  for (const Effect* effect : work)
    for (const auto& [dispatch, round] :
         dispatches_in_order(*effect, params_of(settings, effect->name), info, PixelSet::kAll)) {
      if (dispatch->rays) return usage_error("{} traces rays through a model: it cannot be recorded", effect->name);
      if (dispatch->host)
        return usage_error("{} also runs on the host: it cannot be recorded into a command buffer, only submitted",
                           effect->name);
    }
  return {};
}

/// Submits the work; or, if `commands` is not null, records it there.
Result<void> shade_images(Device& device, const UmbVulkanGBuffer& g, const UmbVulkanWork& request,
                          VkCommandBuffer commands, int slot) {
  const Lens lens = lens_of(g);
  if (auto status = check(g, lens); !status) return status;
  if ((!request.effects && request.effect_count > 0) || (!request.settings && request.setting_count > 0) ||
      (!request.outputs && request.output_count > 0))
    return usage_error("the effects, settings or outputs are NULL, and their count is not 0");
  std::vector<const Effect*> effects_to_run;
  for (const std::string& name : texts_of(request.effects, request.effect_count)) {
    const auto effect = require_named("effect", effects(), name);
    if (!effect) return effect.error();
    effects_to_run.push_back(*effect);
  }
  const auto initial = effect_settings(texts_of(request.settings, request.setting_count));
  if (!initial) return initial.error();
  const EffectSettings& settings = *initial;

  if (commands) {
    if (request.wait || request.signal)
      return usage_error("a recording takes no semaphores: they belong to the submission of its command buffer");
    if (auto status = check_recordable(effects_to_run, settings, info_of(lens)); !status) return status;
    if (auto begun = commands_of(device).begin_recording(commands, slot); !begun) return begun;
  }
  commands_of(device).wait_for(request.wait);
  auto frame = empty_frame(device, info_of(lens));
  if (!frame) return frame.error();
  const ImageMeaning depth{.role = depth_role(lens.depth_kind),
                           .orthographic = lens.orthographic,
                           .near_depth = lens.near_plane,
                           .far_depth = lens.far_plane,
                           .left = lens.left,
                           .right = lens.right,
                           .bottom = lens.bottom,
                           .top = lens.top};
  if (auto read = read_image(device, device_image(g.depth), depth, kDepth, *frame); !read) return read;
  if (g.normal.image) {
    ImageMeaning normal{.role = kNormalRole};
    constexpr float kIdentity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    std::copy_n(is_set(g.view_from_normal) ? g.view_from_normal : kIdentity, 9, normal.rotation);
    if (auto read = read_image(device, device_image(g.normal), normal, kNormal, *frame); !read) return read;
  } else {
    const Effect& normals = effect_with<NormalsParams>();
    if (auto status = device.run(normals, params_of(settings, normals.name), *frame); !status) return status.error();
  }
  if (g.albedo.image)
    if (auto read = read_image(device, device_image(g.albedo), {}, kAlbedo, *frame); !read) return read;
  if (g.light.image)
    if (auto read = read_image(device, device_image(g.light), {}, kLit, *frame); !read) return read;
  for (const Effect* effect : effects_to_run)
    if (auto status = device.run(*effect, params_of(settings, effect->name), *frame); !status) return status.error();
  for (int k = 0; k < request.output_count; ++k) {
    const UmbVulkanOutput& output = request.outputs[k];
    const auto planes = texts_of(output.planes, output.plane_count);
    if (planes.empty() || planes.size() > 4)
      return usage_error("an output takes one to four planes, not {}", planes.size());
    if (auto written = write_image(device, *frame, planes, device_image(output.image)); !written) return written;
  }
  return commands ? Result<void>() : commands_of(device).submit_without_waiting(request.signal);
}

Result<void> check_slot(int slot) {
  if (slot >= 0 && slot < UMB_VULKAN_SLOTS) return {};
  return usage_error("a slot is a number from 0 to {}, not {}", UMB_VULKAN_SLOTS - 1, slot);
}
static_assert(UMB_VULKAN_SLOTS == kRecordingSlots);

/// Ends a recording, and discards the work that a failed call has recorded on a device, even if an exception is thrown.
struct EndCall {
  Device& device;
  bool done = false;
  ~EndCall() {
    commands_of(device).end_recording();
    if (!done) commands_of(device).drop();
  }
};

UmbError shade(UmbVulkanShading shading, const char* function, const UmbVulkanGBuffer* gbuffer,
               const UmbVulkanWork* work, VkCommandBuffer commands, int slot) {
  return call_on<VulkanShadingObject>(shading, function, Use::kChanges,
                                      [&](VulkanShadingObject& object) -> Result<void> {
                                        if (!gbuffer || !work)
                                          return usage_error("{}: gbuffer and work cannot be NULL", function);
                                        if (auto status = check_slot(slot); !status) return status;
                                        object.size = fmt::format("{} x {} pixels", gbuffer->width, gbuffer->height);
                                        EndCall end{*object.device};
                                        auto status = shade_images(*object.device, *gbuffer, *work, commands, slot);
                                        end.done = bool(status);
                                        return status;
                                      });
}

Result<std::shared_ptr<Object>> new_shading(const UmbVulkanContext* context) {
  if (!context || !context->get_instance_proc_addr || !context->instance || !context->physical_device ||
      !context->device || !context->queue)
    return usage_error("a Vulkan context needs all of its handles");
  if (auto valid = check_isa_setting(); !valid) return valid.error();
  auto device = make_vulkan_device_on({context->get_instance_proc_addr, context->instance, context->physical_device,
                                       context->device, context->queue, context->queue_family});
  if (!device) return device.error();
  return std::shared_ptr<Object>(std::make_shared<VulkanShadingObject>(std::move(*device)));
}

}  // namespace
}  // namespace umbrage

using namespace umbrage;  // for the C functions below

UmbVulkanShading umbNewVulkanShading(const UmbVulkanContext* context) {
  return make_object<UmbVulkanShading>("umbNewVulkanShading", [&] { return new_shading(context); });
}

void umbRetainVulkanShading(UmbVulkanShading shading) { retain_object<VulkanShadingObject>(shading); }
void umbReleaseVulkanShading(UmbVulkanShading shading) { release_object<VulkanShadingObject>(shading); }

UmbError umbGetVulkanShadingError(UmbVulkanShading shading, const char** message) {
  return take_error<VulkanShadingObject>(shading, message);
}

UmbError umbShadeVulkanImages(UmbVulkanShading shading, const UmbVulkanGBuffer* gbuffer, const UmbVulkanWork* work) {
  return shade(shading, "umbShadeVulkanImages", gbuffer, work, VK_NULL_HANDLE, 0);
}

UmbError umbRecordVulkanImages(UmbVulkanShading shading, VkCommandBuffer commands, int32_t slot,
                               const UmbVulkanGBuffer* gbuffer, const UmbVulkanWork* work) {
  if (!commands)
    return call_on<VulkanShadingObject>(shading, "umbRecordVulkanImages", Use::kChanges,
                                        [](VulkanShadingObject&) -> Result<void> {
                                          return usage_error("umbRecordVulkanImages: commands cannot be NULL");
                                        });
  return shade(shading, "umbRecordVulkanImages", gbuffer, work, commands, slot);
}

UmbError umbGetVulkanCost(UmbVulkanShading shading, int32_t slot, UmbVulkanCost* cost) {
  return call_on<VulkanShadingObject>(shading, "umbGetVulkanCost", Use::kChanges,
                                      [&](VulkanShadingObject& object) -> Result<void> {
                                        if (!cost) return usage_error("umbGetVulkanCost: cost cannot be NULL");
                                        if (auto status = check_slot(slot); !status) return status;
                                        const RecordingCost of = commands_of(*object.device).cost(slot);
                                        *cost = {of.dispatches, of.bytes_read, of.bytes_written, of.ms};
                                        return {};
                                      });
}

UmbError umbFinishVulkanShading(UmbVulkanShading shading) {
  return call_on<VulkanShadingObject>(shading, "umbFinishVulkanShading", Use::kChanges,
                                      [](VulkanShadingObject& object) -> Result<void> {
                                        const auto finished = object.device->finish();
                                        return finished ? Result<void>() : finished.error();
                                      });
}

uint64_t umbGetVulkanShadingMemory(UmbVulkanShading shading) {
  const auto object = object_of<VulkanShadingObject>(shading);
  return object ? vulkan_memory(*object->device).device_bytes : 0;
}
