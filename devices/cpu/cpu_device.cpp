#include "devices/cpu/cpu_device.h"

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <list>
#include <map>
#include <tuple>

#include "core/check.h"
#include "core/guarded.h"
#include "core/progress.h"
#include "devices/cpu/capture.h"
#include "devices/cpu/cpu_planes.h"
#include "devices/cpu/soften.h"
#include "devices/cpu/trace_rays.h"
#include "devices/shared/dispatches.h"
#include "devices/shared/planes.h"
#include "kernel/isa.h"
#include "kernel/kernel_frame.h"
#include "rays/embree.h"
#include "scene/occluders.h"

namespace umbrage {
namespace {

template <int step>
void copy_every(const float* from, float* to, int count) {
  for (int x = 0; x < count; ++x) to[x] = from[std::ptrdiff_t(x) * step];
}

/// Returns the number of threads to use: `requested`, but at most as many as the process may use; 0: all of these.
int thread_count(int requested) {
  const int max = tbb::info::default_concurrency();
  return requested > 0 ? std::min(requested, max) : max;
}

/// Runs a kernel on the blocks of a tile that have a pixel of the mask.
void run_masked(CpuKernel kernel, const KernelFrame& frame, const PixelMask& mask, const Tile& tile) {
  for (int y0 = tile.y0; y0 < tile.y1;) {
    const int y1 = std::min(y0 / kMaskHeight * kMaskHeight + kMaskHeight, tile.y1);
    for (int x0 = tile.x0; x0 < tile.x1;) {
      int x1 = x0;
      while (x1 < tile.x1 && mask.any(x1, std::min(x1 + kMaskWidth, tile.x1), y0, y1)) x1 += kMaskWidth;
      if (x1 > x0) kernel(frame, {x0, y0, std::min(x1, tile.x1), y1});
      x0 = x1 + kMaskWidth;
    }
    y0 = y1;
  }
}

DeviceInfo info_of(const CpuSettings& settings) {
  const int threads = thread_count(settings.threads);
  return {.name = "cpu",
          .description = fmt::format("cpu: kernels {}, rays {}, {} threads", settings.scalar ? "scalar" : isa_in_use(),
                                     isa_of_embree(), threads),
          .threads = threads,
          .draws_strips = true};
}

class CpuDevice final : public Device {
 public:
  explicit CpuDevice(const CpuSettings& settings)
      : Device(info_of(settings)), settings_(settings), arena_(thread_count(settings.threads)) {}

  Result<void> prepare(const Scene& scene, const ProgressMonitor& monitor) override {
    traced_.reset();
    auto traced = arena_.execute([&] { return build_traced_scene(scene, monitor); });
    if (!traced) return traced.error();
    traced_ = std::move(*traced);
    scene_ = &scene;
    occluders_ = {};
    return {};
  }

  void release_scene() override {
    traced_.reset();
    scene_ = nullptr;
  }

  Result<Frame> capture(const Camera& camera, const CaptureSettings& settings,
                        const ProgressMonitor& monitor) override {
    if (!traced_) fail_check("capture before prepare");
    if (auto status = check_capture(settings); !status) return status.error();
    Frame frame;
    frame.info = picture_info(*scene_, camera, settings);
    frame.info.occluders = arena_.execute([&] { return occluders_of(*scene_, settings.occluders, occluders_); });
    add_layers(*traced_, settings, frame.info);
    auto planes =
        arena_.execute([&] { return capture_planes(*traced_, frame.info, settings, monitor, settings_.scalar); });
    if (!planes) return planes.error();
    auto stored = std::make_shared<CpuPlanes>(CpuPlanes{std::move(*planes)});
    stored->traced = traced_;
    stored->mask = settings.mask;
    if (settings.strip) {
      begin_strip(*settings.strip, frame.info.height, *stored);
      for (const int light : softened_lights(frame.info, settings))
        stored->strip_rows[shadow_plane(light)].valid = shrunk(stored->rows, kSoftenMargin, frame.info.height);
    }
    frame.storage = std::move(stored);
    return frame;
  }

  Result<Frame> upload(GBuffer gbuffer, const Strip* strip) override {
    bool views = false;
    for (Image& layer : gbuffer.layers)
      for (Plane& plane : layer.planes) {
        if (strip && plane.is_view()) plane = Plane(plane);
        views = views || plane.is_view();
      }
    const int height = gbuffer.info.height;
    Frame frame = frame_of(std::move(gbuffer), strip ? rows_with_margin(*strip, height) : Rows{0, height});
    if (strip) begin_strip(*strip, height, cpu_planes(frame));
    return views ? branch(frame) : frame;  // effects on a branch do not write to the views
  }

  Frame branch(const Frame& frame) override {
    if (cpu_planes(frame).strip) fail_check("a strip cannot have branches");
    auto planes = std::make_shared<CpuPlanes>(CpuPlanes{Image(frame.info.width, frame.info.height)});
    planes->parent = std::static_pointer_cast<const CpuPlanes>(frame.storage);
    planes->branches = planes->parent->branches.branch();
    planes->traced = planes->parent->traced;
    planes->mask = planes->parent->mask;
    return {frame.info, std::move(planes)};
  }

  Result<void> add(Image planes, Frame& frame) override {
    cpu_planes(frame).branches.check_none();
    for (std::size_t p = 0; p < planes.planes.size(); ++p) {
      check_equal(planes.planes[p].width, frame.info.width, planes.names[p]);
      CpuPlanes& all = cpu_planes(frame);
      check_equal(planes.planes[p].height, all.strip ? all.rows.count() : frame.info.height, planes.names[p]);
      if (all.strip) all.strip_rows[planes.names[p]] = {.valid = all.rows, .first = all.rows.begin};
      Plane& plane = planes.planes[p];
      all.image.add(planes.names[p]) = plane.is_view() ? Plane(plane) : std::move(plane);
      all.placed.erase(planes.names[p]);
      all.released.erase(planes.names[p]);
    }
    return {};
  }

  Result<RunState> run(const Effect& effect, const ParameterBytes& params, Frame& frame, const EffectRun& settings,
                       const ProgressMonitor& monitor) override {
    cpu_planes(frame).branches.check_none();
    return run_dispatches(effect, params, frame, settings, [&](const DispatchRun& dispatch) {
      auto state = run_dispatch(dispatch, cpu_planes(frame), monitor);
      if (state && state->finished) release_ended(dispatch, settings.last_used, cpu_planes(frame));
      return state;
    });
  }

  void release(Frame& frame, const std::vector<std::string>& names) override {
    release_planes(names, cpu_planes(frame));
  }

  Result<Frame> reduced(const Frame& frame, int factor, const std::vector<std::string>& names) override {
    check_less(0, factor, "factor of a reduced frame");
    Frame small;
    small.info = reduced_info(frame.info, factor);
    const CpuPlanes& from_planes = cpu_planes(frame);
    const Rows rows = from_planes.strip ? reduced_rows(from_planes.rows, factor) : Rows{0, small.info.height};
    auto planes = std::make_shared<CpuPlanes>(CpuPlanes{Image(small.info.width, rows.count())});
    if (from_planes.strip) {
      planes->strip = Strip{reduced_rows(from_planes.strip->rows, factor), 0, from_planes.strip->wholes};
      planes->rows = rows;
    }
    // Takes the first pixel of each block, not the mean: the mean depth of two surfaces lies on neither, and a
    // technique would find occluders in the air. Takes the first pixel, not the nearest, so that one camera fits all
    // pixels.
    for (const std::string& name : names)
      for (int layer = 0; layer < kMaxLayers; ++layer) {
        const std::string layer_name = layer_plane(layer, name);
        const Plane* in = find_stored(from_planes, layer_name);
        if (!in) continue;
        Plane& out = planes->image.add(layer_name);
        int first = 0;  // row of `in` that is row 0 of `out`
        if (const StripRows* strip_rows = find_strip_rows(from_planes, layer_name)) {
          planes->strip_rows[layer_name] = {reduced_rows(strip_rows->valid, factor), strip_rows->version, rows.begin};
          first = rows.begin * factor - strip_rows->first;
        }
        for_rows(arena_, out.height, [&](int y) {
          const float* from = in->row(first + y * factor);
          float* to = out.row(y);
          // A constant step lets the compiler vectorize.
          if (factor == 2)
            copy_every<2>(from, to, out.width);
          else if (factor == 4)
            copy_every<4>(from, to, out.width);
          else
            for (int x = 0; x < out.width; ++x) to[x] = from[std::ptrdiff_t(x) * factor];
        });
      }
    small.storage = std::move(planes);
    return small;
  }

  Result<void> add_planes_of(const Frame& from, const std::vector<std::string>& names, Frame& frame) override {
    if (from.info.reduced > frame.info.reduced) return place(from, names, frame);
    cpu_planes(frame).branches.check_none();
    for (const std::string& name : names)
      if (!find_plane(cpu_planes(from), name)) return usage_error("the picture has no plane '{}'", name);
    cpu_planes(frame).first = std::static_pointer_cast<const CpuPlanes>(from.storage);
    return {};
  }

  std::vector<std::string> plane_names(const Frame& frame) const override { return names_of(cpu_planes(frame)); }

 private:
  Result<Image> read(const Frame& frame, const std::vector<std::string>& names, bool views) override {
    if (cpu_planes(frame).strip) return download_strip(frame, names);
    const bool as_views = views && frame.info.guard == 0;
    Image out(frame.info.inner_width(), frame.info.inner_height());
    for (const std::string& name : names) {
      const Plane* plane = find_plane(cpu_planes(frame), name);
      if (!plane) return usage_error("the picture has no plane '{}'", name);
      out.names.push_back(name);
      out.planes.push_back(as_views ? Plane::view(*plane) : cropped(*plane, frame.info.guard));
    }
    return out;
  }

  /// Copies planes of a reduced frame: see add_planes_of.
  Result<void> place(const Frame& small, const std::vector<std::string>& names, Frame& full) {
    const int factor = small.info.reduced / full.info.reduced;
    check_equal(small.info.width, reduced_side(full.info.width, factor), "width of a reduced frame");
    check_equal(small.info.height, reduced_side(full.info.height, factor), "height of a reduced frame");
    CpuPlanes& whole = cpu_planes(full);
    whole.branches.check_none();
    for (const std::string& name : names) {
      const Plane* in = find_plane(cpu_planes(small), name);
      if (!in) return usage_error("the picture has no plane '{}'", name);
      Plane& out = writable(whole, reduced_plane(name));
      if (const StripRows* strip_rows = find_strip_rows(cpu_planes(small), name); strip_rows && whole.strip) {
        // Dispatches read the plane at the full-resolution rows that it covers.
        const Rows valid{strip_rows->valid.begin * factor,
                         strip_rows->valid.end < small.info.height ? strip_rows->valid.end * factor : full.info.height};
        whole.strip_rows[reduced_plane(name)] = {valid, ++whole.dispatches, strip_rows->first};
      }
      // The remainder is 0 already if a picture of this size was placed there before.
      std::pair<int, int>& placed = cpu_planes(full).placed[reduced_plane(name)];
      const bool fresh = placed != std::pair(in->width, in->height);
      placed = {in->width, in->height};
      for_rows(arena_, fresh ? out.height : in->height, [&](int y) {
        const int copied = y < in->height ? in->width : 0;
        std::copy_n(in->row(copied > 0 ? y : 0), copied, out.row(y));
        if (fresh) std::fill_n(out.row(y) + copied, out.width - copied, 0.0f);
      });
    }
    return {};
  }

  /// Returns a plane with this value everywhere, which frames that live at the same time share.
  std::shared_ptr<const Plane> constant_plane(int width, int height, float value) {
    std::erase_if(constants_, [](const auto& entry) { return entry.second.expired(); });
    std::weak_ptr<const Plane>& entry = constants_[{width, height, value}];
    auto plane = entry.lock();
    if (!plane) entry = plane = std::make_shared<const Plane>(width, height, value);
    return plane;
  }

  /// Returns a frame with the planes of a G-buffer, which have these rows.
  static Frame frame_of(GBuffer gbuffer, const Rows& rows) {
    Frame frame;
    frame.info = info_of(gbuffer);
    auto planes = std::make_shared<CpuPlanes>(CpuPlanes{Image(gbuffer.info.width, rows.count())});
    for (std::size_t layer = 0; layer < gbuffer.layers.size(); ++layer)
      for (std::size_t p = 0; p < gbuffer.layers[layer].planes.size(); ++p) {
        const std::string& name = gbuffer.layers[layer].names[p];
        Plane& plane = gbuffer.layers[layer].planes[p];
        check_equal(plane.width, gbuffer.info.width, name);
        check_equal(plane.height, rows.count(), name);
        planes->image.names.push_back(layer_plane(int(layer), name));
        planes->image.planes.push_back(std::move(plane));
      }
    frame.storage = std::move(planes);
    return frame;
  }

  /// Runs a host step, once for a whole picture. Its outputs are valid for all strips of the picture.
  Result<RunState> run_host(const DispatchRun& run, CpuPlanes& planes, const ProgressMonitor& monitor) {
    const PictureInfo& info = run.info;
    std::list<Plane> whole_neutral;  // neutral planes of the whole picture; `planes` has only those of the strip
    std::vector<const Plane*> inputs;
    for (const std::string_view input : run.dispatch.inputs) {
      const std::string name = run.plane(input);
      const StripRows* strip_rows = find_strip_rows(planes, name);
      if (strip_rows)
        inputs.push_back(find_whole(planes, info, name, strip_rows->version));
      else if (planes.strip)
        inputs.push_back(&whole_neutral.emplace_back(info.width, info.height, *neutral_value(name)));
      else
        inputs.push_back(find_plane(planes, name));
    }
    Watch watch(monitor, 1);
    if (watch.ended()) return interrupted();
    std::vector<Plane> outputs;
    arena_.execute([&] { outputs = run_host_step(run, inputs); });
    for (std::size_t k = 0; k < outputs.size(); ++k) {
      if (!run.has_layer_of(run.dispatch.outputs[k])) continue;
      const std::string name = run.plane(run.dispatch.outputs[k]);
      if (planes.strip) {
        planes.strip->wholes->planes[{info.reduced, name, planes.dispatches}] = {std::move(outputs[k]), true};
        planes.strip_rows[name] = {planes.rows, planes.dispatches, 0, false};
      } else {
        writable(planes, name) = std::move(outputs[k]);
      }
    }
    watch.done(1);
    return watch.ended() ? Result<RunState>(interrupted()) : RunState();
  }

  Result<RunState> run_dispatch(const DispatchRun& run, CpuPlanes& planes, const ProgressMonitor& monitor) {
    const Dispatch& dispatch = run.dispatch;
    const PictureInfo& info = run.info;
    if (dispatch.rays && !planes.traced) return missing_scene(run);
    for (std::string_view input : dispatch.inputs) {
      const std::string name = run.plane(input);
      if (planes.released.contains(name))
        fail_check(fmt::format("{} reads the released plane {}", run.effect.name, name));
      if (find_plane(planes, name) || find_strip_rows(planes, name)) continue;
      const auto value = neutral_value(name);
      if (!value) return missing_plane(run, name);
      if (!planes.constants.count(*value))
        planes.constants.emplace(*value, constant_plane(info.width, planes.image.height, *value));
      planes.neutral.push_back(name);
    }
    std::vector<KernelPlane> kernel_planes;
    StripRun strip{.rows = {0, info.height}};
    if (planes.strip) {
      strip = prepare_strip(run, planes, arena_);
      if (strip.done || !strip.state.finished) return strip.state;
    }
    if (dispatch.host) return run_host(run, planes, monitor);
    for (std::string_view output : dispatch.outputs)
      if (run.has_layer_of(output)) writable(planes, run.plane(output));
    if (strip.rows.count() <= 0) return RunState();
    // The kernel writes only to its outputs, which no other frame shares.
    for (std::string_view name : dispatch.inputs)
      kernel_planes.push_back({name, row_zero_of(run, planes, strip, run.plane(name))});
    for (std::string_view name : dispatch.outputs)
      kernel_planes.push_back(
          {name, run.has_layer_of(name) ? row_zero_of(run, planes, strip, run.plane(name)) : nullptr});
    const int stride = planes.image.plane(run.plane(dispatch.outputs[0])).stride;
    const bool all = run.pixels != PixelSet::kMissing;
    const Plane* ao = all ? nullptr : find_stored(planes, run.plane("ao"));
    if (!all && !ao) return missing_plane(run, "ao");
    KernelFrame kernel_frame{frame_constants(info, stride, run.round, run.pixels), run.constants.data(), kernel_planes,
                             ao ? row_zero_of(run, planes, strip, run.plane("ao")) : nullptr};
    if (planes.strip && strip.unbounded.empty()) {
      kernel_frame.first_row = planes.rows.begin;
      kernel_frame.last_row = planes.rows.end - 1;
    }
    const bool tuned = settings_.tuned && dispatch.tuned && all;
    const CpuKernel kernel = settings_.scalar ? dispatch.kernel.scalar : tuned ? dispatch.tuned : dispatch.kernel.lanes;

    if (dispatch.rays) {
      Watch watch(monitor, ray_steps(strip.rows));
      const RayTask task{*planes.traced,   info, dispatch.rays(run.params, info), kernel, kernel_frame, strip.rows,
                         planes.mask.get()};
      arena_.execute([&] { trace_rays(task, watch); });
      return watch.ended() ? Result<RunState>(interrupted()) : RunState();
    }
    // Kernels pack the missing pixels of a tile, which are few, into lanes: a small tile leaves lanes unused, and in a
    // large one the packed pixels are too distant to share cache lines.
    constexpr int kMissingTile = 128;
    const int tile_width = std::min(all ? dispatch.tile.width : kMissingTile, stride);
    const int tile_height = all ? dispatch.tile.height : kMissingTile;
    const int columns = (info.width + tile_width - 1) / tile_width;
    const int rows = (strip.rows.count() + tile_height - 1) / tile_height;
    Watch watch(monitor, long(rows) * columns);
    arena_.execute([&] {
      tbb::parallel_for(
          tbb::blocked_range<int>(0, rows * columns, 1),
          [&](const tbb::blocked_range<int>& range) {
            for (int t = range.begin(); t < range.end() && !watch.ended(); ++t) {
              const int x0 = t % columns * tile_width, y0 = strip.rows.begin + t / columns * tile_height;
              const Tile tile{x0, y0, std::min(x0 + tile_width, info.width),
                              std::min(y0 + tile_height, strip.rows.end)};
              fault_point();
              if (planes.mask)
                run_masked(kernel, kernel_frame, *planes.mask, tile);
              else
                kernel(kernel_frame, tile);
              watch.done(1);
            }
          },
          tbb::simple_partitioner());
    });
    return watch.ended() ? Result<RunState>(interrupted()) : RunState();
  }

  CpuSettings settings_;
  tbb::task_arena arena_;
  std::map<std::tuple<int, int, float>, std::weak_ptr<const Plane>> constants_;
  const Scene* scene_ = nullptr;
  MadeOccluders occluders_;
  std::shared_ptr<const TracedScene> traced_;
};

}  // namespace

std::unique_ptr<Device> make_cpu_device(const CpuSettings& settings) {
  CpuSettings bounded = settings;
  bounded.scalar = settings.scalar || isa_in_use() == "scalar";
  return std::make_unique<CpuDevice>(bounded);
}

}  // namespace umbrage
