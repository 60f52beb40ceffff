// The public interface for a caller's own Vulkan device.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/guarded.h"
#include "core/registry.h"
#include "devices/vulkan/gpu.h"
#include "devices/vulkan/vulkan_device.h"
#include "effects/effects.h"
#include "renderer/isa_setting.h"
#include "renderer/lens.h"
#include "renderer/recipe.h"
#include "umbrage/vulkan.h"

namespace umbrage {

inline namespace v0 {
struct VulkanShading::State {
  std::unique_ptr<Device> device;
};
}  // namespace v0

namespace {

const std::vector<std::string> kDepth = {"depth"};
const std::vector<std::string> kNormal = {"normal.x", "normal.y", "normal.z"};
const std::vector<std::string> kAlbedo = {"albedo.r", "albedo.g", "albedo.b"};
const std::vector<std::string> kLit = {"lit.r", "lit.g", "lit.b"};

Outcome outcome_of(Result<void> done) {
  Outcome outcome;
  if (!done) {
    outcome.code = int(done.error().kind);
    outcome.message = std::move(done.error().message);
  }
  return outcome;
}

DeviceImage device_image(const VulkanImage& image) {
  return {image.image, image.format, image.layout, image.layout_after};
}

int depth_role(DepthKind kind) {
  switch (kind) {
    case DepthKind::kView:
      return kViewDepthRole;
    case DepthKind::kRay:
      return kRayDepthRole;
    case DepthKind::kWindow:
      return kWindowDepthRole;
    case DepthKind::kReversed:
      break;
  }
  return kReversedDepthRole;
}

PictureInfo info_of(const VulkanGBuffer& gbuffer) {
  PictureInfo info;
  set_lens(gbuffer, info);
  info.scene_radius = gbuffer.scene_radius;
  // Without a look at the depths: what the planes say, as far as the scene reaches.
  const bool planes = has_planes(gbuffer.depth_kind);
  constexpr float kNearest = 1e-3f;
  info.depth_min = planes ? gbuffer.near_plane : kNearest * gbuffer.scene_radius;
  info.depth_max =
      planes && std::isfinite(gbuffer.far_plane) ? gbuffer.far_plane : info.depth_min + 2.0f * gbuffer.scene_radius;
  return info;
}

Result<void> check(const VulkanGBuffer& g) {
  if (!g.depth.image) return usage_error("a G-buffer needs an image of depth");
  if (auto fine = check_lens(g); !fine) return fine;
  if (!(g.scene_radius > 0.0f)) return usage_error("scene_radius cannot be {}: it is above 0", g.scene_radius);
  return {};
}

Result<void> shade_images(Device& device, const VulkanGBuffer& g, const VulkanShadeRequest& request) {
  if (auto fine = check(g); !fine) return fine;
  std::vector<const Effect*> wanted;
  for (const std::string& name : request.effects) {
    const auto effect = require_named("effect", effects(), name);
    if (!effect) return effect.error();
    wanted.push_back(*effect);
  }
  const auto initial = effect_settings(request.settings);
  if (!initial) return initial.error();
  const EffectSettings& settings = *initial;

  wait_for(device, request.wait);
  auto frame = empty_frame(device, info_of(g));
  if (!frame) return frame.error();
  const ImageMeaning depth{.role = depth_role(g.depth_kind),
                           .orthographic = g.orthographic,
                           .near_depth = g.near_plane,
                           .far_depth = g.far_plane,
                           .left = g.left,
                           .right = g.right,
                           .bottom = g.bottom,
                           .top = g.top};
  if (auto read = read_image(device, device_image(g.depth), depth, kDepth, *frame); !read) return read;
  if (g.normal.image) {
    ImageMeaning turned{.role = kNormalRole};
    std::copy_n(g.view_from_normal, 9, turned.turn);
    if (auto read = read_image(device, device_image(g.normal), turned, kNormal, *frame); !read) return read;
  } else {
    const Effect& normals = *find_effect("normals");
    if (auto done = device.run(normals, params_of(settings, normals.name), *frame); !done) return done.error();
  }
  if (g.albedo.image)
    if (auto read = read_image(device, device_image(g.albedo), {}, kAlbedo, *frame); !read) return read;
  if (g.light.image)
    if (auto read = read_image(device, device_image(g.light), {}, kLit, *frame); !read) return read;
  for (const Effect* effect : wanted)
    if (auto done = device.run(*effect, params_of(settings, effect->name), *frame); !done) return done.error();
  for (const auto& output : request.outputs) {
    if (output.planes.empty() || output.planes.size() > 4)
      return usage_error("an output takes one to four planes, not {}", output.planes.size());
    if (auto written = write_image(device, *frame, output.planes, device_image(output.image)); !written) return written;
  }
  return hand_over(device, request.signal);
}

}  // namespace

inline namespace v0 {

VulkanShading::VulkanShading() = default;
VulkanShading::~VulkanShading() = default;
VulkanShading::VulkanShading(VulkanShading&&) noexcept = default;
VulkanShading& VulkanShading::operator=(VulkanShading&&) noexcept = default;

Outcome VulkanShading::open(const VulkanContext& context) {
  return outcome_of(guarded([] { return std::string("a Vulkan device"); },
                            [&]() -> Result<void> {
                              if (!context.get_instance_proc_addr || !context.instance || !context.physical_device ||
                                  !context.device || !context.queue)
                                return usage_error("a VulkanContext needs all of its handles");
                              if (auto valid = check_isa_setting(); !valid) return valid;
                              auto device = make_vulkan_device_on({context.get_instance_proc_addr, context.instance,
                                                                   context.physical_device, context.device,
                                                                   context.queue, context.queue_family});
                              if (!device) return device.error();
                              state_ = std::make_unique<State>(State{std::move(*device)});
                              return {};
                            }));
}

Outcome VulkanShading::shade(const VulkanGBuffer& gbuffer, const VulkanShadeRequest& request) {
  auto done = guarded([&] { return fmt::format("a G-buffer of {} x {} pixels", gbuffer.width, gbuffer.height); },
                      [&]() -> Result<void> {
                        if (!state_) return usage_error("VulkanShading::open comes before shade");
                        return shade_images(*state_->device, gbuffer, request);
                      });
  if (!done && state_) drop(*state_->device);
  return outcome_of(std::move(done));
}

Outcome VulkanShading::finish() {
  if (!state_) return {};
  return outcome_of(guarded([] { return std::string("a picture"); }, [&] { return state_->device->finish(); }));
}

uint64_t VulkanShading::device_bytes() const { return state_ ? vulkan_memory(*state_->device).device_bytes : 0; }

}  // namespace v0
}  // namespace umbrage
