#include "devices/vulkan/vulkan_device.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <map>
#include <span>

#include "core/check.h"
#include "core/guarded.h"
#include "devices/shared/capture_info.h"
#include "devices/shared/host_steps.h"
#include "devices/shared/neutral.h"
#include "devices/shared/passes.h"
#include "devices/shared/soften_passes.h"
#include "devices/vulkan/commands.h"
#include "devices/vulkan/device_scene.h"
#include "devices/vulkan/gpu_capture.h"
#include "devices/vulkan/memory.h"
#include "devices/vulkan/pipeline_file.h"
#include "devices/vulkan/pipelines.h"
#include "devices/vulkan/raster.h"
#include "rays/traced_scene.h"

namespace umbrage {
namespace {

constexpr int kGroup = 8;                                      // pixels of a workgroup, across and down: kernel/glsl.h
constexpr int kDrawnAtOnce = 1024;                             // triangles, at least, of a submission
constexpr VkDeviceSize kMostStaged = VkDeviceSize(256) << 20;  // bytes copied to or from the host at once

/// What a frame stores. A plane that a pass asked for and nobody made has one value everywhere; all such names of one
/// value share a plane.
struct Planes {
  int stride = 0;  // floats from one row to the next
  VkDeviceSize bytes = 0;
  std::vector<std::string> names;  // made, in that order
  std::map<std::string, DevicePlanePtr, std::less<>> made;
  std::vector<std::string> neutral;  // asked for, in that order; `made` may have got one since
  std::map<float, DevicePlanePtr> constants;

  bool is_neutral(std::string_view name) const {
    return !made.contains(name) && std::find(neutral.begin(), neutral.end(), name) != neutral.end();
  }
  const DevicePlane* find(std::string_view name) const {
    if (const auto found = made.find(name); found != made.end()) return found->second.get();
    return is_neutral(name) ? constants.at(*neutral_value(name)).get() : nullptr;
  }
};

Planes& planes_of(const Frame& frame) { return *static_cast<Planes*>(frame.storage.get()); }

std::shared_ptr<Planes> empty_planes(const PictureInfo& info) {
  auto planes = std::make_shared<Planes>();
  planes->stride = (info.width + kRowAlignment - 1) / kRowAlignment * kRowAlignment;
  planes->bytes = VkDeviceSize(planes->stride) * VkDeviceSize(info.height) * sizeof(float);
  return planes;
}

/// The radius of one light's penumbrae along a row and along a column, in pixels, by block of 4 x 4 pixels.
struct PenumbraRadii {
  int light = 0;
  DevicePlanePtr across, down;
};

/// A plane of the host on its way to a frame.
struct NamedPlane {
  std::string name;
  const Plane* plane;
};

class VulkanDevice final : public Device {
 public:
  /// `capture` is what draws scenes; null: this device itself.
  VulkanDevice(GpuPtr gpu, std::string name, std::string description, int threads, std::unique_ptr<Device> capture,
               const VulkanSettings& settings)
      : gpu_(std::move(gpu)),
        memory_(std::make_shared<Memory>(gpu_)),
        name_(std::move(name)),
        description_(std::move(description)),
        threads_(threads),
        capture_(std::move(capture)),
        tuned_(settings.tuned),
        longest_ms_(settings.longest_ms),
        first_groups_(settings.first_groups),
        draws_(settings.capture != VulkanCapture::kRays) {}

  ~VulkanDevice() override {
    memory_->wait = memory_->spare = [] { return Result<void>(); };
    gpu_->vk.DeviceWaitIdle(gpu_->device);
  }

  Result<void> start(const std::filesystem::path& pipelines) {
    auto commands = Commands::make(gpu_, memory_);
    if (!commands) return commands.error();
    commands_ = std::move(*commands);
    memory_->wait = [this] { return commands_->finish(); };
    memory_->spare = [this]() -> Result<void> {
      if (!scene_.scene) return {};  // nothing was drawn
      const RasterTargetPtr spared = std::exchange(target_, nullptr);
      return commands_->finish();
    };
    auto made = Pipelines::make(gpu_, commands_->uniform_buffer(), pipelines);
    if (!made) return made.error();
    pipelines_ = std::move(*made);
    return {};
  }

  std::string_view name() const override { return name_; }
  std::string description() const override { return description_; }
  int threads() const override { return threads_; }

  VulkanMemory memory() const { return {memory_->device_bytes(), memory_->host_bytes()}; }

  Result<void> prepare(const Scene& scene) override {
    if (capture_) return capture_->prepare(scene);
    scene_ = {};
    ++scenes_;
    traced_.reset();
    auto ready = upload_scene(scene, *memory_, *commands_, *gpu_);
    if (!ready) return ready.error();
    scene_ = std::move(*ready);
    return {};
  }

  Result<Frame> capture(const Camera& camera, const CaptureSettings& settings,
                        const ProgressMonitor& monitor) override {
    if (!capture_ && is_ended(monitor)) return interrupted();
    if (!capture_) return capture_here(camera, settings);
    auto drawn = capture_->capture(camera, settings, monitor);
    if (!drawn) return drawn;
    Frame whole = *drawn;
    whole.info.guard = 0;  // all of it
    const auto planes = capture_->download(whole, {});
    if (!planes) return planes.error();
    Frame frame{drawn->info, empty_planes(drawn->info)};
    if (auto done = add(*planes, frame); !done) return done.error();
    return frame;
  }

  Result<Frame> upload(const GBuffer& gbuffer) override {
    Frame frame{gbuffer.info, empty_planes(gbuffer.info)};
    std::vector<NamedPlane> planes;
    for (std::size_t layer = 0; layer < gbuffer.layers.size(); ++layer)
      for (std::size_t p = 0; p < gbuffer.layers[layer].planes.size(); ++p)
        planes.push_back({layer_plane(int(layer), gbuffer.layers[layer].names[p]), &gbuffer.layers[layer].planes[p]});
    if (auto done = copy_to(planes, frame.info, planes_of(frame)); !done) return done.error();
    return frame;
  }

  Result<void> add(const Image& image, Frame& frame) override {
    std::vector<NamedPlane> planes;
    for (std::size_t p = 0; p < image.planes.size(); ++p) planes.push_back({image.names[p], &image.planes[p]});
    return copy_to(planes, frame.info, planes_of(frame));
  }

  Result<Progression> run(const Effect& effect, const ParameterBytes& params, Frame& frame, int layer, PixelSet pixels,
                          const ProgressMonitor& monitor) override {
    return run_passes(effect, params, frame, layer, pixels, [&](const PassRun& pass) -> Result<Progression> {
      if (is_ended(monitor)) return interrupted();
      const auto done = run_pass(pass, planes_of(frame));
      return done ? Result<Progression>(Progression()) : done.error();
    });
  }

  Result<Frame> reduced(const Frame& frame, int factor, const std::vector<std::string>& names) override {
    check_less(0, factor, "factor of a reduced frame");
    Frame small{reduced_info(frame.info, factor), nullptr};
    auto planes = empty_planes(small.info);
    small.storage = planes;
    for (const std::string& name : names)
      for (int layer = 0; layer < kMostLayers; ++layer) {
        const std::string of_layer = layer_plane(layer, name);
        const auto in = planes_of(frame).made.find(of_layer);
        if (in == planes_of(frame).made.end()) continue;
        const auto out = writable(*planes, of_layer);
        if (!out) return out.error();
        if (auto done = pick(frame, *in->second, factor, small, **out); !done) return done.error();
      }
    return small;
  }

  Result<void> place(const Frame& small, const std::vector<std::string>& names, Frame& full) override {
    const int factor = small.info.reduced / full.info.reduced;
    check_equal(small.info.width, reduced_side(full.info.width, factor), "width of a reduced frame");
    check_equal(small.info.height, reduced_side(full.info.height, factor), "height of a reduced frame");
    for (const std::string& name : names) {
      const DevicePlane* in = planes_of(small).find(name);
      if (!in) return usage_error("the picture has no plane '{}'", name);
      const auto out = writable(planes_of(full), reduced_plane(name));
      if (!out) return out.error();
      if (auto done = pick(small, *in, 1, full, **out); !done) return done;
    }
    return {};
  }

  Result<Frame> empty_frame(const PictureInfo& info) { return Frame{info, empty_planes(info)}; }

  Result<void> read_image(const DeviceImage& image, const ImageMeaning& meaning, const std::vector<std::string>& names,
                          Frame& frame) {
    const auto format = texel_format(image.format);
    if (!format) return unknown_format(image);
    Planes& planes = planes_of(frame);
    std::vector<VkDeviceAddress> table = {0};
    for (const std::string& name : names) {
      const auto plane = writable(planes, name);
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
    turn_layout(*gpu_, *buffer, image, *format, image.layout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    const VkBufferImageCopy region = whole_image(frame.info, *format, (*texels)->offset);
    gpu_->vk.CmdCopyImageToBuffer(*buffer, image.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, (*texels)->buffer, 1,
                                  &region);
    turn_layout(*gpu_, *buffer, image, *format, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, image.layout_after);
    return convert(frame, *format, meaning, false, table);
  }

  Result<void> write_image(const Frame& frame, const std::vector<std::string>& names, const DeviceImage& image) {
    const auto format = texel_format(image.format);
    if (!format || format->depth) return unknown_format(image);
    const Planes& planes = planes_of(frame);
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
    if (auto done = convert(frame, *format, {}, true, table); !done) return done;
    const auto buffer = commands_->buffer();
    if (!buffer) return buffer.error();
    commands_->barrier();
    turn_layout(*gpu_, *buffer, image, *format, image.layout, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    const VkBufferImageCopy region = whole_image(frame.info, *format, (*texels)->offset);
    gpu_->vk.CmdCopyBufferToImage(*buffer, (*texels)->buffer, image.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                                  &region);
    turn_layout(*gpu_, *buffer, image, *format, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, image.layout_after);
    return {};
  }

  void drop() { commands_->drop(); }

  void wait_for(VkSemaphore before) { commands_->wait_for(before); }

  Result<void> hand_over(VkSemaphore signal) { return commands_->hand_over(signal); }

  Result<void> finish() override { return commands_->finish(); }

  std::vector<PassTime> take_pass_times() override { return commands_->take_pass_times(); }

  std::vector<std::string> plane_names(const Frame& frame) const override {
    const Planes& planes = planes_of(frame);
    std::vector<std::string> names = planes.names;
    for (const std::string& name : planes.neutral)
      if (!planes.made.contains(name)) names.push_back(name);
    return names;
  }

  Result<Image> download(const Frame& frame, const std::vector<std::string>& names) override {
    return copied(planes_of(frame), names.empty() ? plane_names(frame) : names, frame.info, frame.info.guard);
  }

 private:
  static bool is_ended(const ProgressMonitor& monitor) { return monitor && !monitor(0.0); }

  Result<void> convert(const Frame& frame, const TexelFormat& format, const ImageMeaning& meaning, bool to_image,
                       std::span<const VkDeviceAddress> table) {
    const auto pipeline = pipelines_->convert();
    if (!pipeline) return pipeline.error();
    ConvertConstants constants{};
    constants.width = frame.info.width;
    constants.height = frame.info.height;
    constants.stride = planes_of(frame).stride;
    constants.format = format.format;
    constants.srgb = format.srgb ? 1 : 0;
    constants.to_image = to_image ? 1 : 0;
    constants.role = meaning.role;
    constants.orthographic = meaning.orthographic ? 1 : 0;
    constants.near_depth = meaning.near_depth;
    constants.far_depth = meaning.far_depth;
    std::copy_n(meaning.turn, 9, constants.turn);
    return dispatch({*pipeline, "image", to_image ? "write" : "read"}, frame.info,
                    std::as_bytes(std::span(&constants, 1)), table);
  }

  /// How many planes are copied to or from the host at once.
  std::size_t staged_at_once(const Planes& planes) const {
    return std::max<std::size_t>(
        1, std::min(kMostStaged, gpu_->largest_allocation) / std::max(planes.bytes, VkDeviceSize(1)));
  }

  /// The frame's plane of that name, made where there is none.
  Result<DevicePlanePtr> writable(Planes& planes, const std::string& name) {
    if (const auto found = planes.made.find(name); found != planes.made.end()) return found->second;
    auto plane = memory_->plane(planes.bytes);
    if (!plane) return plane;
    planes.names.push_back(name);
    planes.made.emplace(name, *plane);
    return plane;
  }

  /// Copies planes of the host into a frame.
  Result<void> copy_to(const std::vector<NamedPlane>& from, const PictureInfo& info, Planes& planes) {
    const std::size_t row_bytes = std::size_t(info.width) * sizeof(float);
    const std::size_t at_once = staged_at_once(planes);
    for (std::size_t first = 0; first < from.size(); first += at_once) {
      const std::size_t end = std::min(first + at_once, from.size());
      if (first > 0)  // what is staged stays until it is copied
        if (auto done = commands_->finish(); !done) return done;
      for (std::size_t p = first; p < end; ++p)  // now: new memory may hand over what is noted down
        if (const auto out = writable(planes, from[p].name); !out) return out.error();
      const auto staged = memory_->host(planes.bytes * (end - first));
      if (!staged) return staged.error();
      if (const auto begun = commands_->buffer(); !begun) return begun.error();  // it may let go of what was kept
      commands_->keep(*staged);
      for (std::size_t p = first; p < end; ++p) {
        check_equal(from[p].plane->width, info.width, from[p].name);
        check_equal(from[p].plane->height, info.height, from[p].name);
        std::byte* to = (*staged)->mapped + planes.bytes * (p - first);
        if (from[p].plane->stride == planes.stride)
          std::memcpy(to, from[p].plane->data(), planes.bytes);
        else
          for (int y = 0; y < info.height; ++y)
            std::memcpy(to + std::size_t(y) * planes.stride * sizeof(float), from[p].plane->row(y), row_bytes);
        const DevicePlanePtr& out = planes.made.find(from[p].name)->second;
        const auto buffer = commands_->buffer();
        if (!buffer) return buffer.error();
        if (p == first) commands_->barrier();
        const VkBufferCopy region{planes.bytes * (p - first), out->offset, planes.bytes};
        gpu_->vk.CmdCopyBuffer(*buffer, (*staged)->buffer, out->buffer, 1, &region);
      }
    }
    return {};
  }

  /// Planes of the frame, without so many pixels on each side.
  Result<Image> copied(const Planes& planes, const std::vector<std::string>& wanted, const PictureInfo& info,
                       int margin) {
    Image out(info.width - 2 * margin, info.height - 2 * margin);
    const std::size_t at_once = staged_at_once(planes);
    for (std::size_t first = 0; first < wanted.size(); first += at_once)
      if (auto done = copy_from(planes, wanted, first, std::min(first + at_once, wanted.size()), margin, out); !done)
        return done.error();
    // Also where nothing had to be copied: errors of what came before show here.
    if (auto done = commands_->finish(); !done) return done.error();
    return out;
  }

  /// Copies the planes [first, end) of those wanted to the host, without so many pixels on each side.
  Result<void> copy_from(const Planes& planes, const std::vector<std::string>& wanted, std::size_t first,
                         std::size_t end, int margin, Image& out) {
    const auto staged = memory_->host(planes.bytes * (end - first));
    if (!staged) return staged.error();
    const auto buffer = commands_->buffer();
    if (!buffer) return buffer.error();
    commands_->keep(*staged);
    commands_->barrier();
    for (std::size_t p = first; p < end; ++p) {
      const DevicePlane* plane = planes.find(wanted[p]);
      if (!plane) return usage_error("the picture has no plane '{}'", wanted[p]);
      const VkBufferCopy region{plane->offset, planes.bytes * (p - first), planes.bytes};
      gpu_->vk.CmdCopyBuffer(*buffer, plane->buffer, (*staged)->buffer, 1, &region);
    }
    if (auto done = commands_->finish(); !done) return done;
    for (std::size_t p = first; p < end; ++p) {
      const auto* from = reinterpret_cast<const float*>((*staged)->mapped + planes.bytes * (p - first));
      Plane to(out.width, out.height);
      for (int y = 0; y < out.height; ++y)
        std::memcpy(to.row(y), from + std::size_t(y + margin) * planes.stride + margin,
                    std::size_t(out.width) * sizeof(float));
      out.names.push_back(wanted[p]);
      out.planes.push_back(std::move(to));
    }
    return {};
  }

  /// Notes down that the plane of one value everywhere is filled, unless it is there.
  Result<void> add_constant(Planes& planes, float value) {
    if (planes.constants.contains(value)) return {};
    const auto plane = memory_->plane(planes.bytes);
    if (!plane) return plane.error();
    const auto buffer = commands_->buffer();
    if (!buffer) return buffer.error();
    commands_->barrier();
    gpu_->vk.CmdFillBuffer(*buffer, (*plane)->buffer, (*plane)->offset, planes.bytes,
                           std::bit_cast<std::uint32_t>(value));
    planes.constants.emplace(value, *plane);
    return {};
  }

  /// A shader that is to run over all pixels, and whose time is taken under these names.
  struct Work {
    VkPipeline pipeline = VK_NULL_HANDLE;
    std::string_view effect, pass;
    std::size_t settings = 0;                         // see Commands::Kind
    int group_width = kGroup, group_height = kGroup;  // pixels that a workgroup computes
    const RasterTarget* target = nullptr;  // not null: the scene's triangles and points are drawn, some at once
    std::span<const VkDescriptorBufferInfo> bound = {};  // of a kernel of kernel/glsl.h: kBoundPlanes of them
  };
  using Constants = std::span<const std::byte>;
  using Table = std::span<const VkDeviceAddress>;

  Result<void> run_pass(const PassRun& run, Planes& planes) {
    const Pass& pass = run.pass;
    for (std::string_view input : pass.inputs) {
      const std::string name = run.plane(input);
      if (planes.find(name)) continue;
      const auto value = neutral_value(name);
      if (!value) return missing_plane(run, name);
      if (auto done = add_constant(planes, *value); !done) return done;
      planes.neutral.push_back(name);
    }
    if (pass.host) return run_host(run, planes);
    fault_point();
    for (std::string_view output : pass.outputs)
      if (run.is_there(output))
        if (auto made = writable(planes, run.plane(output)); !made) return made.error();
    if (tuned_ && run.pixels == PixelSet::kAll)
      for (const GpuWay& way : pass.gpu_ways)
        if (way.fits(run.constants.data())) return run_way(run, way, planes);
    return run_step(run, plain_step(pass), planes, {});
  }

  /// Does what is noted down, and runs a host step on what that made.
  Result<void> run_host(const PassRun& run, Planes& planes) {
    std::vector<std::string> names;
    for (const std::string_view input : run.pass.inputs) names.push_back(run.plane(input));
    const auto read = copied(planes, names, run.info, 0);
    if (!read) return read.error();
    std::vector<const Plane*> inputs;
    for (const Plane& plane : read->planes) inputs.push_back(&plane);
    const std::vector<Plane> outputs = run_host_step(run, inputs);
    std::vector<NamedPlane> made;
    for (std::size_t k = 0; k < outputs.size(); ++k)
      if (run.is_there(run.pass.outputs[k])) made.push_back({run.plane(run.pass.outputs[k]), &outputs[k]});
    return copy_to(made, run.info, planes);
  }

  /// Planes that the steps of a way alone know.
  using StepPlanes = std::map<std::string_view, DevicePlanePtr>;

  Result<void> run_way(const PassRun& run, const GpuWay& way, Planes& planes) {
    // The last step's outputs are all of them the pass's. Memory given back here serves what is noted down later.
    StepPlanes own;
    const auto& of_pass = run.pass.outputs;
    for (const GpuStep& step : way.steps) {
      for (std::string_view output : step.outputs) {
        if (std::find(of_pass.begin(), of_pass.end(), output) != of_pass.end() || own.contains(output)) continue;
        const auto made = memory_->plane(planes.bytes);
        if (!made) return made.error();
        own.emplace(output, *made);
      }
      if (auto done = run_step(run, step, planes, own); !done) return done;
    }
    return {};
  }

  Result<void> run_step(const PassRun& run, const GpuStep& step, const Planes& planes, const StepPlanes& own) {
    const std::vector<std::byte> block =
        block_of(frame_constants(run.info, planes.stride, run.round, run.pixels), run.constants);
    std::vector<const DevicePlane*> table;
    for (std::string_view name : plane_table(step)) {
      const auto found = own.find(name);
      table.push_back(found != own.end() ? found->second.get() : planes.find(run.plane(name)));
    }
    if (run.pixels == PixelSet::kMissing) {
      table.resize(kMostPlanes);
      table.back() = planes.find(run.plane("ao"));  // as kernel/glsl.h reads it
      if (!table.back()) return missing_plane(run, "ao");
    }
    return run_kernel(step, {.effect = run.effect.name, .pass = step.name, .settings = number_of(run.params)}, run.info,
                      block, planes.bytes, table);
  }

  /// Notes down a kernel on planes of so many bytes in the order of plane_table. Null: a layer that is not there, which
  /// nobody reads or stores to.
  Result<void> run_kernel(const GpuStep& step, Work work, const PictureInfo& info, Constants block, VkDeviceSize bytes,
                          std::span<const DevicePlane* const> planes) {
    const VkDeviceSize most = gpu_->properties.limits.maxStorageBufferRange;
    const auto pipeline = pipelines_->of(step, block, bytes <= most);
    if (!pipeline) return pipeline.error();
    std::vector<VkDeviceAddress> table;
    for (const DevicePlane* plane : planes) table.push_back(plane ? plane->address : 0);
    // Where there is no plane another one is bound, and of one that is too large its beginning: nobody reads them, but
    // a shader must have them.
    const auto any = std::find_if(planes.begin(), planes.end(), [](auto* plane) { return plane != nullptr; });
    if (any == planes.end()) fail_check(fmt::format("kernel {} has no planes", step.name));
    std::array<VkDescriptorBufferInfo, kBoundPlanes> bound;
    for (std::size_t k = 0; k < bound.size(); ++k) {
      const DevicePlane* plane = k < planes.size() && planes[k] ? planes[k] : *any;
      bound[k] = {plane->buffer, plane->offset, std::min(bytes, most)};
    }
    work.pipeline = *pipeline;
    work.group_width = step.group_width;
    work.group_height = step.group_height;
    work.bound = bound;
    return dispatch(work, info, block, table);
  }

  /// Notes down a shader over all pixels that reads constants and a table of addresses. What
  /// may take too long for one submission is done in bands; of what is new first a few rows in the middle, where
  /// there is likely to be more than background.
  Result<void> dispatch(const Work& work, const PictureInfo& info, Constants constants, Table table) {
    const int columns = work.target ? 1 : groups_of(info.width, work.group_width);
    const int rows =
        work.target ? groups_of(scene_.triangles, kDrawnAtOnce) : groups_of(info.height, work.group_height);
    if (!(longest_ms_ > 0.0) || !commands_->takes_times())
      return note_rows(work, columns, 0, rows, false, constants, table);
    const Commands::Kind kind{work.pipeline, work.settings};
    const int first_rows = std::max(first_groups_ / columns, 1);
    int begin = 0, end = 0;  // rows that are done
    if (!commands_->ms_of_group(kind)) {
      if (rows <= first_rows) return note_rows(work, columns, 0, rows, false, constants, table);
      begin = work.target ? 0 : (rows - first_rows) / 2;  // the first triangle of several in one place is seen
      end = begin + first_rows;
      if (auto done = note_rows(work, columns, begin, end, false, constants, table); !done) return done;
      if (auto done = commands_->finish(); !done) return done;
    }
    const bool further = end > begin;
    if (auto done = note_bands(work, columns, 0, begin, further, constants, table); !done) return done;
    return note_bands(work, columns, end, rows, further, constants, table);
  }

  /// Rows of workgroups whose time is known, handed over wherever they become too many.
  Result<void> note_bands(const Work& work, int columns, int row, int end, bool further, Constants constants,
                          Table table) {
    while (row < end) {
      const double ms_of_row =
          std::max(columns * commands_->ms_of_group({work.pipeline, work.settings}).value_or(0.0), 1e-9);
      const double left_ms = longest_ms_ - commands_->noted_ms();
      if (left_ms < ms_of_row && commands_->noted_ms() > 0.0) {
        if (auto done = commands_->finish(); !done) return done;
        continue;
      }
      const int band = int(std::clamp(left_ms / ms_of_row, 1.0, double(end - row)));
      if (auto done = note_rows(work, columns, row, row + band, further, constants, table); !done) return done;
      row += band;
      further = true;
    }
    return {};
  }

  Result<void> note_rows(const Work& work, int columns, int row, int end, bool further, Constants constants,
                         Table table) {
    const auto drawing = work.target ? pipelines_->drawing(row == 0) : VkRenderPass(VK_NULL_HANDLE);
    if (!drawing) return drawing.error();
    const auto uniforms = commands_->uniforms(kTableBytes + constants.size());
    if (!uniforms) return uniforms.error();
    VkDescriptorSet sets[] = {pipelines_->constants(), VK_NULL_HANDLE};
    if (!work.bound.empty()) {
      const auto bound = commands_->descriptor_set(pipelines_->bound_layout(), work.bound);
      if (!bound) return bound.error();
      sets[1] = *bound;
    }
    const auto buffer = commands_->buffer();
    if (!buffer) return buffer.error();
    // The table comes first: it is as large for all shaders, and so the constants lie as aligned as it does.
    std::memcpy(uniforms->bytes, table.data(), table.size_bytes());
    std::memcpy(uniforms->bytes + kTableBytes, constants.data(), constants.size());
    // Before the barrier: where something was drawn, lavapipe takes the time at the next one.
    commands_->begin_pass(work.effect, work.pass, {work.pipeline, work.settings}, double(columns) * (end - row),
                          further);
    commands_->barrier();
    const VkPipelineBindPoint point = work.target ? VK_PIPELINE_BIND_POINT_GRAPHICS : VK_PIPELINE_BIND_POINT_COMPUTE;
    gpu_->vk.CmdBindPipeline(*buffer, point, work.pipeline);
    const std::uint32_t offsets[] = {uniforms->offset + std::uint32_t(kTableBytes), uniforms->offset};
    gpu_->vk.CmdBindDescriptorSets(*buffer, point, pipelines_->pass_layout(), 0, sets[1] ? 2 : 1, sets, 2, offsets);
    if (work.target) {
      const int first = row * kDrawnAtOnce, last = std::min(end * kDrawnAtOnce, scene_.triangles);
      begin_drawing(*gpu_, *buffer, *work.target, *drawing, row == 0);
      const std::uint32_t corners = scene_.points ? 6 : 3;  // of each: see corner.vert
      gpu_->vk.CmdDraw(*buffer, std::uint32_t(last - first) * corners, 1, std::uint32_t(first) * corners, 0);
      end_drawing(*gpu_, *buffer);
    } else {
      gpu_->vk.CmdDispatchBase(*buffer, 0, std::uint32_t(row), 0, std::uint32_t(columns), std::uint32_t(end - row), 1);
    }
    commands_->end_pass();
    return {};
  }

  /// Draws the prepared scene with capture.comp.
  Result<Frame> capture_here(const Camera& camera, const CaptureSettings& settings) {
    if (!scene_.scene) fail_check("capture before prepare");
    if (auto fine = check_capture(settings); !fine) return fine.error();
    Frame frame;
    frame.info = picture_info(*scene_.scene, camera, settings);
    if (settings.extra_views > 0 && !traced_) {  // where they stand is found out by rays
      auto traced = trace_ready(*scene_.scene, threads_);
      if (!traced) return traced.error();
      traced_ = std::move(*traced);
    }
    add_layers(traced_ ? *traced_ : TracedScene(), settings, frame.info);
    auto planes = empty_planes(frame.info);
    frame.storage = planes;
    const int all = 1 + int(frame.info.more_layers.size());
    const std::vector<std::string> names = captured_planes(*scene_.scene, frame.info, settings.shadows);
    for (int layer = 0; layer < all; ++layer)
      for (const std::string& name : names)
        if (const auto made = writable(*planes, layer_plane(layer, name)); !made) return made.error();
    std::vector<PenumbraRadii> radii;
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
      if (kind_of(layer) == LayerKind::kBack) continue;  // drawn with its front
      int back = -1;
      for (int k = 1; k < all; ++k)
        if (kind_of(k) == LayerKind::kBack && frame.info.more_layers[std::size_t(k) - 1].of == layer) back = k;
      const auto measured = std::span(radii).first(layer == 0 ? radii.size() : 0);
      if (auto done = draw_layer(frame, names, settings, layer, back, measured); !done) return done.error();
    }
    if (auto done = soften(frame, radii); !done) return done.error();
    return frame;
  }

  Result<void> draw_layer(const Frame& frame, const std::vector<std::string>& names, const CaptureSettings& settings,
                          int layer, int back, std::span<const PenumbraRadii> radii) {
    const Planes& planes = planes_of(frame);
    const auto pipeline = pipelines_->capture();
    if (!pipeline) return pipeline.error();
    std::vector<VkDeviceAddress> table(kCaptureSlots);
    for (const std::string& name : names) {
      table[std::size_t(capture_slot(name))] = planes.find(layer_plane(layer, name))->address;
      if (back > 0) table[kBackSlots + std::size_t(capture_slot(name))] = planes.find(layer_plane(back, name))->address;
    }
    const bool other = layer > 0 && frame.info.more_layers[std::size_t(layer) - 1].kind == LayerKind::kOther;
    if (layer > 0 && !other) table[kBeforeSlot] = planes.find(layer_plane(layer - 1, "depth"))->address;
    for (std::size_t k = 0; k < scene_.buffers.size(); ++k) table[kNodesSlot + k] = scene_.buffers[k]->address;
    for (const PenumbraRadii& of : radii) {
      table[kPenumbraSlot + 2 * std::size_t(of.light)] = of.across->address;
      table[kPenumbraSlot + 2 * std::size_t(of.light) + 1] = of.down->address;
    }
    const PictureInfo info = layer_info(frame.info, layer);
    const CaptureConstants constants = capture_constants(scene_, info, settings, planes.stride, back > 0);
    // Rays take as long as scene, lights and the layers before make them.
    const std::size_t kind =
        ((scenes_ * kMostLayers + std::size_t(layer)) * 64 + std::size_t(settings.shadow_rays)) * 64 +
        std::size_t(settings.shadows);
    DevicePlanePtr seen;
    if (draws_ && can_draw(scene_, constants, *gpu_)) {
      const auto drawn = draw_seen(info, layer, planes, std::as_bytes(std::span(&constants, 1)), table);
      if (!drawn) return drawn.error();
      seen = *drawn;
      if (seen) table[kSeenSlot] = seen->address;
    }
    return dispatch({*pipeline, "capture", layer_plane(layer, "planes"), kind}, info,
                    std::as_bytes(std::span(&constants, 1)), table);
  }

  /// Which triangle each pixel of a layer sees, by drawing them all. Null where there is no memory to draw into: rays
  /// need none.
  Result<DevicePlanePtr> draw_seen(const PictureInfo& info, int layer, const Planes& planes, Constants constants,
                                   Table table) {
    const auto pipeline = pipelines_->peel(scene_.masks, scene_.points);
    if (!pipeline) return pipeline.error();
    auto seen = memory_->plane(planes.bytes);  // first: it may take the target's memory
    if (!seen) return DevicePlanePtr();
    if (!target_ || target_->width != info.width || target_->height != info.height) {
      const auto drawing = pipelines_->drawing(true);
      if (!drawing) return drawing.error();
      target_.reset();  // in use no longer, or kept by the commands
      const auto made = make_raster_target(gpu_, *memory_, *drawing, info.width, info.height);
      if (!made) return DevicePlanePtr();  // a device that is lost says so to what comes next
      target_ = *made;
    }
    // A triangle takes the longer the larger the picture is.
    const std::size_t size = std::bit_width(std::uint64_t(info.width) * std::uint64_t(info.height));
    if (auto done = dispatch({.pipeline = *pipeline,
                              .effect = "capture",
                              .pass = layer_plane(layer, "seen"),
                              .settings = (scenes_ * kMostLayers + std::size_t(layer)) * 64 + size,
                              .target = target_.get()},
                             info, constants, table);
        !done)
      return done.error();
    const auto buffer = commands_->buffer();
    if (!buffer) return buffer.error();
    copy_seen(*gpu_, *buffer, *target_, **seen, planes.stride);
    commands_->keep(target_);
    return seen;
  }

  /// Softens the shadows of lights that have a size: see devices/shared/soften_passes.h.
  Result<void> soften(const Frame& frame, std::span<const PenumbraRadii> radii) {
    if (radii.empty()) return {};
    const Planes& planes = planes_of(frame);
    const auto between = memory_->plane(planes.bytes);
    if (!between) return between.error();
    const auto reach = memory_->plane(planes.bytes);
    if (!reach) return reach.error();
    const auto run = [&](const Pass& pass, const PictureInfo& info, const SoftenConstants& constants,
                         const StepPlanes& own) -> Result<void> {
      const GpuStep step = plain_step(pass);
      const std::vector<std::byte> block =
          block_of(frame_constants(info, planes.stride, 0), std::as_bytes(std::span(&constants, 1)));
      std::vector<const DevicePlane*> table;
      for (std::string_view name : plane_table(step)) {
        const auto found = own.find(name);
        table.push_back(found != own.end() ? found->second.get() : planes.find(name));
      }
      return run_kernel(step, {.effect = "capture", .pass = pass.name}, info, block, planes.bytes, table);
    };
    PictureInfo blocks = frame.info;
    blocks.width = (blocks.width + kSoftenBlock - 1) / kSoftenBlock;
    blocks.height = (blocks.height + kSoftenBlock - 1) / kSoftenBlock;
    for (const PenumbraRadii& of : radii) {
      const DevicePlanePtr& shadow = planes.made.find(shadow_plane(of.light))->second;
      for (const int second : {0, 1})
        for (const int down : {0, 1}) {
          if (second)
            if (auto done = run(soften_reach_pass(), blocks, {},
                                {{"penumbra", down ? of.down : of.across}, {"soften_reach", *reach}});
                !done)
              return done;
          if (auto done = run(soften_pass(), frame.info, {.dx = 1 - down, .dy = down, .second = second},
                              {{"soften_from", down ? *between : shadow},
                               {"soften_to", down ? shadow : *between},
                               {"soften_reach", *reach}});
              !done)
            return done;
        }
    }
    return {};
  }

  /// Notes down pick.comp.
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

  /// What a kernel reads besides planes.
  static std::vector<std::byte> block_of(const FrameConstants& frame, std::span<const std::byte> constants) {
    const auto of_frame = std::as_bytes(std::span(&frame, 1));
    std::vector<std::byte> block(of_frame.begin(), of_frame.end());
    block.insert(block.end(), constants.begin(), constants.end());
    return block;
  }

  static int groups_of(int pixels, int group) { return (pixels + group - 1) / group; }

  static std::size_t number_of(std::span<const std::byte> bytes) {
    return std::hash<std::string_view>()({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }

  /// Of the table of planes, on each device a multiple of what constants must be aligned to.
  static constexpr std::size_t kTableBytes = kMostPlanes * sizeof(VkDeviceAddress);

  GpuPtr gpu_;
  std::shared_ptr<Memory> memory_;
  std::unique_ptr<Commands> commands_;
  std::unique_ptr<Pipelines> pipelines_;
  std::string name_, description_;
  int threads_ = 1;
  std::unique_ptr<Device> capture_;
  bool tuned_ = true;
  double longest_ms_ = 0.0;
  int first_groups_ = 1;
  bool draws_ = true;       // triangles, where it can
  RasterTargetPtr target_;  // of the last picture's size
  DeviceScene scene_;
  std::size_t scenes_ = 0;  // prepared so far
  TracedScenePtr traced_;   // only where somebody wanted further cameras
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
  const Error no_gpu = device_error("there is no GPU here: use --device cpu, or --device vulkan for one in software");
  if (settings.real && !may_have_gpu()) return no_gpu;
  auto instance = make_instance(settings.get, settings.on_message);
  if (!instance) return instance.error();
  const auto gpus = physical_gpus(**instance);
  if (!gpus) return gpus.error();
  int index = settings.index;
  if (index >= int(gpus->size()))
    return device_error("there is no device 'vulkan:{}': there {} (see umbrage list devices)", index,
                        gpus->size() == 1 ? std::string("is vulkan:0 alone")
                                          : fmt::format("are vulkan:0 to vulkan:{}", gpus->size() - 1));
  if (index < 0) {
    const auto best = std::max_element(gpus->begin(), gpus->end(), [](const PhysicalGpu& a, const PhysicalGpu& b) {
      const auto worth = [](const PhysicalGpu& gpu) { return 2 * int(gpu.lacks.empty()) + int(!gpu.software); };
      return worth(a) < worth(b);
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
  const bool here = settings.capture == VulkanCapture::kRays || settings.capture == VulkanCapture::kRaster ||
                    (settings.capture == VulkanCapture::kAuto && !chosen.software);
  const int threads = capture->threads();
  std::string description = fmt::format("vulkan:{}: {}", index, summary_of(chosen));
  if (!here) description += fmt::format("; scenes are captured by {}", capture->description());
  auto device = std::make_unique<VulkanDevice>(*gpu, fmt::format("vulkan:{}", index), std::move(description), threads,
                                               here ? nullptr : std::move(capture), settings);
  if (auto started = device->start(pipelines); !started) return started.error();
  return std::unique_ptr<Device>(std::move(device));
}

Result<std::unique_ptr<Device>> make_vulkan_device_on(const ForeignGpu& foreign) {
  auto gpu = adopt_gpu(foreign);
  if (!gpu) return gpu.error();
  const std::filesystem::path file = pipeline_file(cache_name(**gpu));
  auto device = std::make_unique<VulkanDevice>(*gpu, "vulkan", "vulkan: a device opened elsewhere", 1, nullptr,
                                               VulkanSettings{.longest_ms = 0.0});
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

void wait_for(Device& device, VkSemaphore before) { dynamic_cast<VulkanDevice&>(device).wait_for(before); }

Result<void> hand_over(Device& device, VkSemaphore signal) {
  return dynamic_cast<VulkanDevice&>(device).hand_over(signal);
}

void drop(Device& device) { dynamic_cast<VulkanDevice&>(device).drop(); }

VulkanMemory vulkan_memory(const Device& device) {
  const auto* vulkan = dynamic_cast<const VulkanDevice*>(&device);
  return vulkan ? vulkan->memory() : VulkanMemory();
}

}  // namespace umbrage
