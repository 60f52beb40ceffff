#include "devices/vulkan/vulkan_device.h"

#include <algorithm>
#include <optional>
#include <span>

#include "core/check.h"
#include "core/guarded.h"
#include "core/lists.h"
#include "devices/shared/dispatches.h"
#include "devices/shared/planes.h"
#include "devices/vulkan/dispatch.h"
#include "devices/vulkan/frame_planes.h"
#include "devices/vulkan/memory.h"
#include "devices/vulkan/pipelines.h"
#include "devices/vulkan/scene_capture.h"

namespace umbrage {
namespace {

class VulkanDevice final : public Device {
 public:
  /// `capture` is the device that captures scenes; null: this device itself.
  VulkanDevice(GpuPtr gpu, DeviceInfo info, std::unique_ptr<Device> capture, const VulkanSettings& settings)
      : Device(std::move(info)),
        gpu_(std::move(gpu)),
        memory_(std::make_shared<Memory>(gpu_)),
        capture_(std::move(capture)),
        settings_(settings) {}

  ~VulkanDevice() override {
    memory_->wait = memory_->release_memory = [] { return Result<void>(); };
    gpu_->vk.DeviceWaitIdle(gpu_->device);
  }

  Result<void> start(const std::filesystem::path& pipelines) {
    auto commands = Commands::make(gpu_, memory_);
    if (!commands) return commands.error();
    commands_ = std::move(*commands);
    memory_->wait = [this] { return commands_->finish(); };
    memory_->release_memory = [this] { return scene_ ? scene_->release_memory() : Result<void>(); };
    auto created = Pipelines::make(gpu_, commands_->uniform_buffer(), pipelines);
    if (!created) return created.error();
    pipelines_ = std::move(*created);
    store_.emplace(*gpu_, *memory_, *commands_);
    dispatcher_.emplace(*gpu_, *commands_, *pipelines_, settings_.max_submission_ms, settings_.first_groups);
    const CaptureParts parts{gpu_, memory_.get(), commands_.get(), pipelines_.get(), &*store_, &*dispatcher_};
    scene_.emplace(parts, threads(), settings_.capture != VulkanCapture::kRays);
    return {};
  }

  VulkanMemory memory() const { return {memory_->device_bytes(), memory_->host_bytes()}; }

  Result<void> prepare(const Scene& scene, const ProgressMonitor& monitor) override {
    if (!capture_) return scene_->prepare(scene, monitor);
    host_scene_ = &scene;
    scene_->release_scene();
    return capture_->prepare(scene, monitor);
  }

  void release_scene() override {
    if (capture_) capture_->release_scene();
  }

  Result<Frame> capture(const Camera& camera, const CaptureSettings& settings,
                        const ProgressMonitor& monitor) override {
    if (!capture_ && is_ended(monitor)) return interrupted();
    if (!capture_) return scene_->capture(camera, settings, monitor);
    CaptureSettings all = settings;
    all.mask = nullptr;  // dispatches run on all pixels
    auto captured = capture_->capture(camera, all, monitor);
    if (!captured) return captured;
    const auto planes = capture_->download_with_guard(*captured, capture_->plane_names(*captured));
    if (!planes) return planes.error();
    Frame frame{captured->info, empty_planes(captured->info)};
    if (auto status = add(*planes, frame); !status) return status.error();
    if (!settings.ray_offsets) return frame;
    // Rays will be traced in the scene on this device.
    const ProgressMonitor preparation_monitor = monitor ? [&](double) { return monitor(1.0); } : ProgressMonitor();
    if (!scene_->scene())
      if (auto ready = scene_->prepare(*host_scene_, preparation_monitor); !ready) return ready.error();
    planes_of(frame).scene = scene_->scene();
    return frame;
  }

  Result<Frame> upload(GBuffer gbuffer, const Strip* strip) override {
    if (strip) fail_check("a device that draws no strips");
    Frame frame{info_of(gbuffer), empty_planes(gbuffer.info)};
    std::vector<NamedPlane> planes;
    for (std::size_t layer = 0; layer < gbuffer.layers.size(); ++layer)
      for (std::size_t p = 0; p < gbuffer.layers[layer].planes.size(); ++p)
        planes.push_back({layer_plane(int(layer), gbuffer.layers[layer].names[p]), &gbuffer.layers[layer].planes[p]});
    if (auto status = store_->copy_to(planes, frame.info, planes_of(frame)); !status) return status.error();
    return frame;
  }

  Frame branch(const Frame& frame) override {
    auto planes = std::make_shared<DevicePlanes>(planes_of(frame));
    planes->of_parent.insert(planes->names.begin(), planes->names.end());
    planes->branches = planes_of(frame).branches.branch();
    return {frame.info, std::move(planes)};
  }

  Result<void> add(Image image, Frame& frame) override {
    planes_of(frame).branches.check_none();
    std::vector<NamedPlane> planes;
    for (std::size_t p = 0; p < image.planes.size(); ++p) planes.push_back({image.names[p], &image.planes[p]});
    return store_->copy_to(planes, frame.info, planes_of(frame));
  }

  Result<RunState> run(const Effect& effect, const ParameterBytes& params, Frame& frame, const EffectRun& settings,
                       const ProgressMonitor& monitor) override {
    planes_of(frame).branches.check_none();
    return run_dispatches(effect, params, frame, settings, [&](const DispatchRun& dispatch) -> Result<RunState> {
      if (is_ended(monitor)) return interrupted();
      const auto status = run_dispatch(dispatch, planes_of(frame));
      return status ? Result<RunState>(RunState()) : status.error();
    });
  }

  void release(Frame& frame, const std::vector<std::string>& names) override {
    DevicePlanes& planes = planes_of(frame);
    if (planes.branches.any()) return;  // they share the planes
    for (const std::string& name : names) {
      if (planes.stored.erase(name) == 0) continue;
      std::erase(planes.names, name);
      planes.of_parent.erase(name);
    }
  }

  Result<Frame> reduced(const Frame& frame, int factor, const std::vector<std::string>& names) override {
    check_less(0, factor, "factor of a reduced frame");
    Frame small{reduced_info(frame.info, factor), nullptr};
    auto planes = empty_planes(small.info);
    small.storage = planes;
    for (const std::string& name : names)
      for (int layer = 0; layer < kMaxLayers; ++layer) {
        const std::string layer_name = layer_plane(layer, name);
        const auto in = planes_of(frame).stored.find(layer_name);
        if (in == planes_of(frame).stored.end()) continue;
        const auto out = store_->writable(*planes, layer_name);
        if (!out) return out.error();
        if (auto status = pick(frame, *in->second, factor, small, **out); !status) return status.error();
      }
    return small;
  }

  Result<void> add_planes_of(const Frame& from, const std::vector<std::string>& names, Frame& frame) override {
    DevicePlanes& planes = planes_of(frame);
    planes.branches.check_none();
    const int factor = from.info.reduced / frame.info.reduced;
    check_equal(from.info.width, reduced_side(frame.info.width, factor), "width of a reduced frame");
    check_equal(from.info.height, reduced_side(frame.info.height, factor), "height of a reduced frame");
    for (const std::string& name : names) {
      const DevicePlane* in = planes_of(from).find(name);
      if (!in) return usage_error("the picture has no plane '{}'", name);
      const auto out = store_->writable(planes, factor > 1 ? reduced_plane(name) : other_plane(name));
      if (!out) return out.error();
      if (auto status = pick(from, *in, 1, frame, **out); !status) return status;
    }
    return {};
  }

  Result<Frame> empty_frame(const PictureInfo& info) { return Frame{info, empty_planes(info)}; }

  Result<void> read_image(const DeviceImage& image, const ImageMeaning& meaning, const std::vector<std::string>& names,
                          Frame& frame) {
    const auto format = texel_format(image.format);
    if (!format) return unknown_format(image);
    DevicePlanes& planes = planes_of(frame);
    planes.branches.check_none();
    std::vector<VkDeviceAddress> table = {0};
    for (const std::string& name : names) {
      const auto plane = store_->writable(planes, name);
      if (!plane) return plane.error();
      table.push_back((*plane)->address);
    }
    const auto texels = memory_->plane(VkDeviceSize(frame.info.width) * frame.info.height * format->bytes);
    if (!texels) return texels.error();
    table[0] = (*texels)->address;
    table.resize(5);
    const auto buffer = commands_->buffer();
    if (!buffer) return buffer.error();
    commands_->barrier();
    change_layout(*gpu_, *buffer, image, *format, image.layout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    const VkBufferImageCopy region = whole_image(frame.info, *format, (*texels)->offset);
    gpu_->vk.CmdCopyImageToBuffer(*buffer, image.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, (*texels)->buffer, 1,
                                  &region);
    change_layout(*gpu_, *buffer, image, *format, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, image.layout_after);
    return convert(frame, *format, meaning, false, table);
  }

  Result<void> write_image(const Frame& frame, const std::vector<std::string>& names, const DeviceImage& image) {
    const auto format = texel_format(image.format);
    if (!format || format->depth) return unknown_format(image);
    const DevicePlanes& planes = planes_of(frame);
    std::vector<VkDeviceAddress> table = {0};
    for (const std::string& name : names) {
      const DevicePlane* plane = planes.find(name);
      if (!plane) return usage_error("the picture has no plane '{}'", name);
      table.push_back(plane->address);
    }
    const auto texels = memory_->plane(VkDeviceSize(frame.info.width) * frame.info.height * format->bytes);
    if (!texels) return texels.error();
    table[0] = (*texels)->address;
    table.resize(5);
    if (auto status = convert(frame, *format, {}, true, table); !status) return status;
    const auto buffer = commands_->buffer();
    if (!buffer) return buffer.error();
    commands_->barrier();
    change_layout(*gpu_, *buffer, image, *format, image.layout, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    const VkBufferImageCopy region = whole_image(frame.info, *format, (*texels)->offset);
    gpu_->vk.CmdCopyBufferToImage(*buffer, (*texels)->buffer, image.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                                  &region);
    change_layout(*gpu_, *buffer, image, *format, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, image.layout_after);
    return {};
  }

  Commands& commands() { return *commands_; }

  Result<std::vector<DispatchTime>> finish() override {
    if (auto status = commands_->finish(); !status) return status.error();
    return commands_->take_dispatch_times();
  }

  std::vector<std::string> plane_names(const Frame& frame) const override {
    const DevicePlanes& planes = planes_of(frame);
    std::vector<std::string> names = planes.names;
    for (const std::string& name : planes.neutral)
      if (!planes.stored.contains(name)) names.push_back(name);
    return names;
  }

 private:
  Result<Image> read(const Frame& frame, const std::vector<std::string>& names, bool /*views*/) override {
    return store_->copied(planes_of(frame), names, frame.info, frame.info.guard);
  }

  static bool is_ended(const ProgressMonitor& monitor) { return monitor && !monitor(0.0); }

  Result<void> convert(const Frame& frame, const TexelFormat& format, const ImageMeaning& meaning, bool to_image,
                       std::span<const VkDeviceAddress> table) {
    const auto pipeline = pipelines_->convert();
    if (!pipeline) return pipeline.error();
    const ConvertConstants constants =
        convert_constants(frame.info, planes_of(frame).stride, format, meaning, to_image);
    // The image is copied to or from a buffer, which is converted to or from planes of 1 to 4 channels.
    const VkDeviceSize texels = VkDeviceSize(frame.info.width) * frame.info.height * format.bytes;
    const VkDeviceSize planes =
        planes_of(frame).bytes *
        VkDeviceSize(std::count_if(table.begin() + 1, table.end(), [](auto address) { return address != 0; }));
    commands_->count(to_image ? planes + texels : 2 * texels, to_image ? 2 * texels : planes + texels);
    return dispatcher_->dispatch({*pipeline, "image", to_image ? "write" : "read"}, frame.info,
                                 std::as_bytes(std::span(&constants, 1)), table);
  }

  Result<void> run_dispatch(const DispatchRun& run, DevicePlanes& planes) {
    const Dispatch& dispatch = run.dispatch;
    if (dispatch.rays && !planes.scene) return missing_scene(run);
    for (std::string_view input : dispatch.inputs) {
      const std::string name = run.plane(input);
      if (planes.find(name)) continue;
      const auto value = neutral_value(name);
      if (!value) return missing_plane(run, name);
      if (auto status = store_->add_constant(planes, *value); !status) return status;
      planes.neutral.push_back(name);
    }
    if (dispatch.host) return run_host(run, planes);
    fault_point();
    for (std::string_view output : dispatch.outputs)
      if (run.has_layer_of(output))
        if (auto made = store_->writable(planes, run.plane(output)); !made) return made.error();
    if (dispatch.rays) return run_rays(run, planes);
    if (settings_.tuned && run.pixels == PixelSet::kAll)
      for (const GpuVariant& variant : dispatch.gpu_variants)
        if (variant.fits(run.constants.data())) return run_variant(run, variant, planes);
    return run_step(run, plain_step(dispatch), planes, {});
  }

  /// Finishes the recorded work, and runs a host step on its results.
  Result<void> run_host(const DispatchRun& run, DevicePlanes& planes) {
    std::vector<std::string> names;
    for (const std::string_view input : run.dispatch.inputs) names.push_back(run.plane(input));
    const auto read = store_->copied(planes, names, run.info, 0);
    if (!read) return read.error();
    std::vector<const Plane*> inputs;
    for (const Plane& plane : read->planes) inputs.push_back(&plane);
    const std::vector<Plane> outputs = run_host_step(run, inputs);
    std::vector<NamedPlane> results;
    for (std::size_t k = 0; k < outputs.size(); ++k)
      if (run.has_layer_of(run.dispatch.outputs[k]))
        results.push_back({run.plane(run.dispatch.outputs[k]), &outputs[k]});
    return store_->copy_to(results, run.info, planes);
  }

  Result<void> run_variant(const DispatchRun& run, const GpuVariant& variant, DevicePlanes& planes) {
    // All outputs of the last step are outputs of the dispatch. The temporary planes are released on return; only work
    // that is recorded later reuses their memory.
    StepPlanes temporary_planes;
    const auto& dispatch_outputs = run.dispatch.outputs;
    for (const GpuStep& step : variant.steps) {
      for (std::string_view output : step.outputs) {
        if (contains(dispatch_outputs, output) || temporary_planes.contains(output)) continue;
        const auto made = memory_->plane(planes.bytes);
        if (!made) return made.error();
        temporary_planes.emplace(output, *made);
      }
      if (auto status = run_step(run, step, planes, temporary_planes); !status) return status;
    }
    return {};
  }

  /// Runs a dispatch that traces rays: the kernel makes one ray of each pixel at a time, which a shader then traces.
  Result<void> run_rays(const DispatchRun& run, const DevicePlanes& planes) {
    GpuStep step = plain_step(run.dispatch);
    step.outputs = {"ray.x", "ray.y", "ray.z"};
    StepPlanes rays;
    for (std::string_view name : step.outputs) {
      const auto made = memory_->plane(planes.bytes);
      if (!made) return made.error();
      rays.emplace(name, *made);
    }
    const RaySettings settings = run.dispatch.rays(run.params, run.info);
    DispatchRun one = run;
    for (one.round = 0; one.round < settings.max_rays; ++one.round) {
      if (auto status = run_step(one, step, planes, rays); !status) return status;
      if (auto status = scene_->trace_rays(one, settings, planes, rays); !status) return status;
    }
    return {};
  }

  Result<void> run_step(const DispatchRun& run, const GpuStep& step, const DevicePlanes& planes,
                        const StepPlanes& temporary_planes) {
    const std::vector<std::byte> block =
        block_of(frame_constants(run.info, planes.stride, run.round, run.pixels), run.constants);
    std::vector<const DevicePlane*> table;
    for (std::string_view name : plane_table(step)) {
      const auto found = temporary_planes.find(name);
      table.push_back(found != temporary_planes.end() ? found->second.get() : planes.find(run.plane(name)));
    }
    commands_->count(step.inputs.size() * planes.bytes, step.outputs.size() * planes.bytes);
    if (run.pixels == PixelSet::kMissing) {
      table.resize(kMaxPlanes);
      table.back() = planes.find(run.plane("ao"));  // kernel/glsl.h reads it there
      if (!table.back()) return missing_plane(run, "ao");
    }
    return dispatcher_->run_kernel(step,
                                   {.effect = run.effect.name, .dispatch = step.name, .settings = hash_of(run.params)},
                                   run.info, block, planes.bytes, table);
  }

  /// Records pick.comp.
  Result<void> pick(const Frame& from, const DevicePlane& in, int factor, const Frame& to, const DevicePlane& out) {
    const auto pipeline = pipelines_->pick();
    if (!pipeline) return pipeline.error();
    const auto buffer = commands_->buffer();
    if (!buffer) return buffer.error();
    const PickConstants constants{
        in.address,     out.address,          from.info.width, from.info.height, planes_of(from).stride, to.info.width,
        to.info.height, planes_of(to).stride, factor};
    commands_->barrier();
    gpu_->vk.CmdBindPipeline(*buffer, VK_PIPELINE_BIND_POINT_COMPUTE, *pipeline);
    gpu_->vk.CmdPushConstants(*buffer, pipelines_->pick_layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0,
                              offsetof(PickConstants, factor) + sizeof(int), &constants);
    gpu_->vk.CmdDispatch(*buffer, std::uint32_t(groups_of(to.info.width, kGroup)),
                         std::uint32_t(groups_of(to.info.height, kGroup)), 1);
    return {};
  }

  static std::size_t hash_of(std::span<const std::byte> bytes) {
    return std::hash<std::string_view>()({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }

  GpuPtr gpu_;
  std::shared_ptr<Memory> memory_;
  std::unique_ptr<Commands> commands_;
  std::unique_ptr<Pipelines> pipelines_;
  std::unique_ptr<Device> capture_;
  const Scene* host_scene_ = nullptr;  // last scene that `capture_` prepared
  VulkanSettings settings_;
  std::optional<PlaneStore> store_;
  std::optional<Dispatcher> dispatcher_;
  std::optional<SceneCapture> scene_;
};

std::string summary_of(const PhysicalGpu& gpu) {
  std::string text =
      fmt::format("{}, driver {}, {:.1f} GiB", gpu.name, gpu.driver, double(gpu.memory_bytes) / (1 << 30));
  if (gpu.software) text += ", in software on the CPU";
  if (!gpu.lacks.empty()) text += fmt::format("; cannot be used: it lacks {}", gpu.lacks);
  return text;
}

std::string cache_name(const Gpu& gpu) {
  std::string name = "vulkan-";
  for (const std::uint8_t byte : gpu.properties.pipelineCacheUUID) name += fmt::format("{:02x}", byte);
  return fmt::format("{}-{:x}-{:x}.pipelines", name, gpu.properties.vendorID, gpu.properties.deviceID);
}

}  // namespace

Result<std::vector<VulkanGpu>> vulkan_gpus(const VulkanSettings& settings) {
  const auto instance = make_instance(settings.get, settings.on_message);
  if (!instance) return instance.error();
  const auto gpus = physical_gpus(**instance);
  if (!gpus) return gpus.error();
  std::vector<VulkanGpu> found;
  for (std::size_t k = 0; k < gpus->size(); ++k)
    found.push_back(
        {fmt::format("vulkan:{}", k), summary_of((*gpus)[k]), (*gpus)[k].software, (*gpus)[k].lacks.empty()});
  return found;
}

Result<std::unique_ptr<Device>> make_vulkan_device(const VulkanSettings& settings, std::unique_ptr<Device> capture) {
  const Error no_gpu = device_error("there is no GPU: use `device` cpu, or `device` vulkan for a software device");
  if (settings.real && !may_have_gpu()) return no_gpu;
  auto instance = make_instance(settings.get, settings.on_message);
  if (!instance) return instance.error();
  const auto gpus = physical_gpus(**instance);
  if (!gpus) return gpus.error();
  int index = settings.index;
  if (index >= int(gpus->size()))
    return device_error(
        "there is no device 'vulkan:{}': this machine has {} (see umbrage list devices)", index,
        gpus->size() == 1 ? std::string("only vulkan:0") : fmt::format("vulkan:0 to vulkan:{}", gpus->size() - 1));
  if (index < 0) {
    const auto best = std::max_element(gpus->begin(), gpus->end(), [](const PhysicalGpu& a, const PhysicalGpu& b) {
      const auto rank = [](const PhysicalGpu& gpu) { return 2 * int(gpu.lacks.empty()) + int(!gpu.software); };
      return rank(a) < rank(b);
    });
    index = int(best - gpus->begin());
  }
  const PhysicalGpu& chosen = (*gpus)[std::size_t(index)];
  if (settings.real && (chosen.software || !chosen.lacks.empty())) return no_gpu;
  if (!chosen.lacks.empty())
    return device_error(
        "the device 'vulkan:{}' ({}) cannot be used: it lacks {}; a newer driver may have it, or use "
        "`device` cpu",
        index, chosen.name, chosen.lacks);
  auto gpu = open_gpu(*instance, chosen);
  if (!gpu) return gpu.error();
  const std::string file = cache_name(**gpu);
  const std::filesystem::path pipelines = settings.pipeline_folder == "none" ? std::filesystem::path()
                                          : settings.pipeline_folder.empty()
                                              ? pipeline_file(file)
                                              : std::filesystem::path(settings.pipeline_folder) / file;
  const bool captures_itself = settings.capture == VulkanCapture::kRays || settings.capture == VulkanCapture::kRaster ||
                               (settings.capture == VulkanCapture::kAuto && !chosen.software);
  DeviceInfo info{.name = fmt::format("vulkan:{}", index),
                  .description = fmt::format("vulkan:{}: {}", index, summary_of(chosen)),
                  .threads = capture->threads()};
  if (captures_itself) {
    capture.reset();
  } else {
    info.description += fmt::format("; scenes are captured by {}", capture->description());
    info.pool = capture->pool();
  }
  auto device = std::make_unique<VulkanDevice>(*gpu, std::move(info), std::move(capture), settings);
  if (auto started = device->start(pipelines); !started) return started.error();
  return std::unique_ptr<Device>(std::move(device));
}

Result<std::unique_ptr<Device>> make_vulkan_device_on(const ForeignGpu& foreign) {
  auto gpu = adopt_gpu(foreign);
  if (!gpu) return gpu.error();
  const std::filesystem::path file = pipeline_file(cache_name(**gpu));
  auto device =
      std::make_unique<VulkanDevice>(*gpu, DeviceInfo{.name = "vulkan", .description = "vulkan: the caller's device"},
                                     nullptr, VulkanSettings{.max_submission_ms = 0.0});
  if (auto started = device->start(file); !started) return started.error();
  return std::unique_ptr<Device>(std::move(device));
}

Result<Frame> empty_frame(Device& device, const PictureInfo& info) {
  return dynamic_cast<VulkanDevice&>(device).empty_frame(info);
}

Result<void> read_image(Device& device, const DeviceImage& image, const ImageMeaning& meaning,
                        const std::vector<std::string>& planes, Frame& frame) {
  return dynamic_cast<VulkanDevice&>(device).read_image(image, meaning, planes, frame);
}

Result<void> write_image(Device& device, const Frame& frame, const std::vector<std::string>& planes,
                         const DeviceImage& image) {
  return dynamic_cast<VulkanDevice&>(device).write_image(frame, planes, image);
}

Commands& commands_of(Device& device) { return dynamic_cast<VulkanDevice&>(device).commands(); }

VulkanMemory vulkan_memory(const Device& device) {
  const auto* vulkan = dynamic_cast<const VulkanDevice*>(&device);
  return vulkan ? vulkan->memory() : VulkanMemory();
}

}  // namespace umbrage
