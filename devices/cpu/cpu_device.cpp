#include "devices/cpu/cpu_device.h"

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <map>

#include "core/check.h"
#include "devices/cpu/capture.h"
#include "devices/cpu/watch.h"
#include "devices/shared/neutral.h"
#include "devices/shared/passes.h"
#include "machine/cpu_target.h"
#include "machine/kernel_frame.h"

namespace umbrage {
namespace {

/// What a frame stores. A plane that a pass asked for and nobody made has one value everywhere; all such names of one
/// value share a plane, since filling a plane for each costs more than the passes that read them.
struct Planes {
  Image image;
  std::vector<std::string> neutral;  ///< names that have been asked for, in that order; `image` may have got one since
  std::map<float, Plane> constants;
  std::map<std::string, std::pair<int, int>> placed;  ///< by name, size of the reduced picture that lies there
  std::shared_ptr<Planes> last_reduced;               ///< what was made of this last at reduced resolution
};

Planes& planes_of(const Frame& frame) { return *static_cast<Planes*>(frame.storage.get()); }

/// The plane of that name, made or neutral, or null.
const Plane* find_plane(const Planes& planes, std::string_view name) {
  if (const Plane* made = planes.image.find(name)) return made;
  const bool neutral = std::find(planes.neutral.begin(), planes.neutral.end(), name) != planes.neutral.end();
  return neutral ? &planes.constants.at(*neutral_value(name)) : nullptr;
}

template <int step>
void take_every(const float* from, float* to, int count) {
  for (int x = 0; x < count; ++x) to[x] = from[std::ptrdiff_t(x) * step];
}

/// As many as asked for, but no more than the machine has.
int thread_count(int wish) {
  const int most = tbb::info::default_concurrency();
  return wish > 0 ? std::min(wish, most) : most;
}

class CpuDevice final : public Device {
 public:
  explicit CpuDevice(const CpuSettings& settings) : settings_(settings), arena_(thread_count(settings.threads)) {}

  std::string_view name() const override { return "cpu"; }

  std::string description() const override {
    return fmt::format("cpu: {} lanes, {} threads", settings_.scalar ? "scalar" : simd_target_name(), threads());
  }

  int threads() const override { return arena_.max_concurrency(); }

  Result<void> prepare(const Scene& scene) override {
    auto traced = arena_.execute([&] { return trace_ready(scene); });
    if (!traced) return traced.error();
    traced_ = std::move(*traced);
    scene_ = &scene;
    return {};
  }

  Result<Frame> capture(const Camera& camera, const CaptureSettings& settings) override {
    if (!traced_) fail_check("capture before prepare");
    if (auto fine = check_capture(settings); !fine) return fine.error();
    Frame frame;
    frame.info = picture_info(*scene_, camera, settings);
    add_layers(*traced_, settings, frame.info);
    auto planes =
        arena_.execute([&] { return capture_planes(*traced_, frame.info, settings, go_on, settings_.scalar); });
    if (!planes) return planes.error();
    frame.storage = std::make_shared<Planes>(Planes{std::move(*planes)});
    return frame;
  }

  Result<Frame> upload(const GBuffer& gbuffer) override {
    Frame frame;
    frame.info = gbuffer.info;
    auto planes = std::make_shared<Planes>(Planes{Image(gbuffer.info.width, gbuffer.info.height)});
    for (std::size_t layer = 0; layer < gbuffer.layers.size(); ++layer)
      for (std::size_t p = 0; p < gbuffer.layers[layer].planes.size(); ++p) {
        const std::string& name = gbuffer.layers[layer].names[p];
        check_equal(gbuffer.layers[layer].planes[p].width, gbuffer.info.width, name);
        check_equal(gbuffer.layers[layer].planes[p].height, gbuffer.info.height, name);
        planes->image.add(layer_plane(int(layer), name)) = gbuffer.layers[layer].planes[p];
      }
    frame.storage = std::move(planes);
    return frame;
  }

  Result<void> add(const Image& planes, Frame& frame) override {
    for (std::size_t p = 0; p < planes.planes.size(); ++p) {
      check_equal(planes.planes[p].width, frame.info.width, planes.names[p]);
      check_equal(planes.planes[p].height, frame.info.height, planes.names[p]);
      planes_of(frame).image.add(planes.names[p]) = planes.planes[p];
      planes_of(frame).placed.erase(planes.names[p]);
    }
    return {};
  }

  Result<void> run(const Effect& effect, const ParameterBytes& params, Frame& frame, int layer,
                   PixelSet pixels) override {
    return run_passes(effect, params, frame, layer, pixels,
                      [&](const PassRun& pass) { return run_pass(pass, planes_of(frame)); });
  }

  Result<Frame> reduced(const Frame& frame, int factor, const std::vector<std::string>& names) override {
    check_less(0, factor, "factor of a reduced frame");
    Frame small;
    small.info = reduced_info(frame.info, factor);
    // Planes of a reduced frame that nobody has any more are written anew: fresh memory costs as much as the technique.
    std::shared_ptr<Planes>& last = planes_of(frame).last_reduced;
    const bool again = last && last.use_count() == 1 && last->image.width == small.info.width &&
                       last->image.height == small.info.height;
    if (!again) last = std::make_shared<Planes>(Planes{Image(small.info.width, small.info.height)});
    std::shared_ptr<Planes> planes = last;
    // The first pixel of each block, not their mean: a mean of two surfaces' depths lies on neither of them, and there
    // a technique would find occluders in the air. The first and not the nearest, so that one camera fits all of them.
    for (const std::string& name : names)
      for (int layer = 0; layer < kMostLayers; ++layer) {
        const std::string of_layer = layer_plane(layer, name);
        const Plane* in = planes_of(frame).image.find(of_layer);
        if (!in) continue;
        Plane& out = planes->image.add(of_layer);
        for_rows(out.height, [&](int y) {
          const float* from = in->row(y * factor);
          float* to = out.row(y);
          // A step that the compiler knows makes vectors.
          if (factor == 2)
            take_every<2>(from, to, out.width);
          else if (factor == 4)
            take_every<4>(from, to, out.width);
          else
            for (int x = 0; x < out.width; ++x) to[x] = from[std::ptrdiff_t(x) * factor];
        });
      }
    small.storage = std::move(planes);
    return small;
  }

  Result<void> place(const Frame& small, const std::vector<std::string>& names, Frame& full) override {
    const int factor = small.info.reduced / full.info.reduced;
    check_equal(small.info.width, reduced_side(full.info.width, factor), "width of a reduced frame");
    check_equal(small.info.height, reduced_side(full.info.height, factor), "height of a reduced frame");
    for (const std::string& name : names) {
      const Plane* in = find_plane(planes_of(small), name);
      if (!in) return usage_error("the picture has no plane '{}'", name);
      Plane& out = planes_of(full).image.add(reduced_plane(name));
      // The rest is 0 already where a picture of this size lay there before.
      std::pair<int, int>& placed = planes_of(full).placed[reduced_plane(name)];
      const bool fresh = placed != std::pair(in->width, in->height);
      placed = {in->width, in->height};
      for_rows(fresh ? out.height : in->height, [&](int y) {
        const int copied = y < in->height ? in->width : 0;
        std::copy_n(in->row(copied > 0 ? y : 0), copied, out.row(y));
        if (fresh) std::fill_n(out.row(y) + copied, out.width - copied, 0.0f);
      });
    }
    return {};
  }

  Result<Image> download(const Frame& frame, const std::vector<std::string>& names) override {
    const Planes& planes = planes_of(frame);
    std::vector<std::string> wanted = names;
    if (names.empty()) {
      wanted = planes.image.names;
      for (const std::string& name : planes.neutral)
        if (!planes.image.find(name)) wanted.push_back(name);
    }
    Image out(frame.info.inner_width(), frame.info.inner_height());
    for (const std::string& name : wanted) {
      const Plane* plane = find_plane(planes, name);
      if (!plane) return usage_error("the picture has no plane '{}'", name);
      out.names.push_back(name);
      out.planes.push_back(cropped(*plane, frame.info.guard));
    }
    return out;
  }

 private:
  /// Calls work(y) for the rows of a plane, from all threads.
  template <class Work>
  void for_rows(int height, const Work& work) {
    constexpr int kRowsAtOnce = 32;  // fewer cost more to hand out than to copy
    arena_.execute([&] {
      tbb::parallel_for(tbb::blocked_range<int>(0, height, kRowsAtOnce), [&](const tbb::blocked_range<int>& rows) {
        for (int y = rows.begin(); y < rows.end(); ++y) work(y);
      });
    });
  }

  Result<void> run_pass(const PassRun& run, Planes& planes) {
    const Pass& pass = run.pass;
    const PictureInfo& info = run.info;
    for (std::string_view input : pass.inputs) {
      const std::string name = run.plane(input);
      if (find_plane(planes, name)) continue;
      const auto value = neutral_value(name);
      if (!value) return missing_plane(run, name);
      if (!planes.constants.count(*value)) planes.constants.emplace(*value, Plane(info.width, info.height, *value));
      planes.neutral.push_back(name);
    }
    for (std::string_view output : pass.outputs)
      if (run.is_there(output)) planes.image.add(run.plane(output));
    std::vector<KernelPlane> kernel_planes;
    // A kernel stores to its outputs alone, which are nobody else's.
    for (std::string_view name : pass.inputs)
      kernel_planes.push_back({name, const_cast<float*>(find_plane(planes, run.plane(name))->data())});
    for (std::string_view name : pass.outputs)
      kernel_planes.push_back({name, run.is_there(name) ? planes.image.plane(run.plane(name)).data() : nullptr});
    const int stride = planes.image.plane(run.plane(pass.outputs[0])).stride;
    const bool all = run.pixels == PixelSet::kAll;
    const Plane* ao = all ? nullptr : planes.image.find(run.plane("ao"));
    if (!all && !ao) return missing_plane(run, "ao");
    const KernelFrame kernel_frame{frame_constants(info, stride, run.round, run.pixels), run.constants.data(),
                                   kernel_planes, ao ? ao->data() : nullptr};
    const bool tuned = settings_.tuned && pass.tuned && all;
    const CpuKernel kernel = settings_.scalar ? pass.scalar : tuned ? pass.tuned : pass.lanes;

    // Missing pixels are few: each tile leaves lanes over, but pixels far from each other share no cache lines.
    constexpr int kMissingTile = 128;
    const int tile_width = std::min(all ? pass.tile_width : kMissingTile, stride);
    const int tile_height = all ? pass.tile_height : kMissingTile;
    const int columns = (info.width + tile_width - 1) / tile_width;
    const int rows = (info.height + tile_height - 1) / tile_height;
    Watch watch(go_on, long(rows) * columns);
    arena_.execute([&] {
      tbb::parallel_for(
          tbb::blocked_range<int>(0, rows * columns, 1),
          [&](const tbb::blocked_range<int>& range) {
            for (int t = range.begin(); t < range.end() && !watch.ended(); ++t) {
              const int x0 = t % columns * tile_width, y0 = t / columns * tile_height;
              kernel(kernel_frame,
                     {x0, y0, std::min(x0 + tile_width, info.width), std::min(y0 + tile_height, info.height)});
              watch.done(1);
            }
          },
          tbb::simple_partitioner());
    });
    return watch.result();
  }

  CpuSettings settings_;
  tbb::task_arena arena_;
  const Scene* scene_ = nullptr;
  TracedScenePtr traced_;
};

}  // namespace

std::unique_ptr<Device> make_cpu_device(const CpuSettings& settings) { return std::make_unique<CpuDevice>(settings); }

}  // namespace umbrage
