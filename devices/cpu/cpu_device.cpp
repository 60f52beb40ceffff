#include "devices/cpu/cpu_device.h"

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <list>
#include <map>
#include <optional>

#include "core/check.h"
#include "core/guarded.h"
#include "devices/cpu/capture.h"
#include "devices/cpu/soften.h"
#include "devices/cpu/watch.h"
#include "devices/shared/host_steps.h"
#include "devices/shared/neutral.h"
#include "devices/shared/passes.h"
#include "kernel/isa.h"
#include "kernel/kernel_frame.h"
#include "rays/embree_device.h"

namespace umbrage {
namespace {

/// What a band holds of a plane.
struct Held {
  Rows valid;        ///< rows of the picture that are as they would be in the whole one
  int version = 0;   ///< see WholePlanes
  int first = 0;     ///< the row, of the plane, that is held first
  bool made = true;  ///< false: of the whole planes alone
};

/// What a frame stores. A plane that a pass asked for and nobody made has one value everywhere; all such names of one
/// value share a plane, since filling a plane for each costs more than the passes that read them.
struct Planes {
  Image image;                       ///< of a band, its rows alone
  std::vector<std::string> neutral;  ///< names that have been asked for, in that order; `image` may have got one since
  std::map<float, Plane> constants;
  std::map<std::string, std::pair<int, int>> placed;  ///< by name, size of the reduced picture that lies there
  std::shared_ptr<Planes> last_reduced;               ///< what was made of this last at reduced resolution
  // Of a band:
  std::optional<Band> band;
  Rows rows;                                      ///< those that are held
  std::map<std::string, Held, std::less<>> held;  ///< of every plane
  int passes = 0;                                 ///< that have run
};

Planes& planes_of(const Frame& frame) { return *static_cast<Planes*>(frame.storage.get()); }

/// The plane of that name, made or neutral, or null.
const Plane* find_plane(const Planes& planes, std::string_view name) {
  if (const Plane* made = planes.image.find(name)) return made;
  const bool neutral = std::find(planes.neutral.begin(), planes.neutral.end(), name) != planes.neutral.end();
  return neutral ? &planes.constants.at(*neutral_value(name)) : nullptr;
}

/// That version of a band's plane in the whole picture, or null.
const Plane* find_whole(const Planes& planes, const PictureInfo& info, std::string_view name, int version) {
  const auto& all = planes.band->wholes->planes;
  const auto found = all.find({info.reduced, std::string(name), version});
  return found != all.end() && found->second.complete ? &found->second.plane : nullptr;
}

/// What a band holds of the plane of that name, or null where nobody made it.
const Held* find_held(const Planes& planes, std::string_view name) {
  const auto found = planes.held.find(name);
  return found != planes.held.end() ? &found->second : nullptr;
}

/// `rows` less `margin` of them at either end, but where the picture ends.
Rows shrunk(const Rows& rows, int margin, int height) {
  return {rows.begin > 0 ? rows.begin + margin : 0, rows.end < height ? rows.end - margin : height};
}

Rows divided(const Rows& rows, int factor) {
  return {reduced_side(rows.begin, factor), reduced_side(rows.end, factor)};
}

/// The band waits for others. Where not even its own rows are valid, they are, too, with so much more margin.
Error unfinished(const Planes& planes, const Rows& valid, int reduced) {
  const int above = valid.begin - planes.band->rows.begin, below = planes.band->rows.end - valid.end;
  int& lacking = planes.band->wholes->lacking;
  lacking = std::max({lacking, above * reduced, below * reduced});
  return {ErrorKind::kUnfinished, "a band waits for others"};
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
    return fmt::format("cpu: kernels {}, rays {}, {} threads", settings_.scalar ? "scalar" : isa_in_use(),
                       isa_of_rays(), threads());
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
    auto stored = std::make_shared<Planes>(Planes{std::move(*planes)});
    if (settings.band) {
      stored->band = settings.band;
      stored->rows = held_rows(*settings.band, frame.info.height);
      for (const std::string& name : stored->image.names)
        stored->held[name] = {.valid = stored->rows, .first = stored->rows.begin};
      for (const int light : softened_lights(frame.info, settings))
        stored->held[shadow_plane(light)].valid = shrunk(stored->rows, kSoftenMargin, frame.info.height);
    }
    frame.storage = std::move(stored);
    return frame;
  }

  bool draws_bands() const override { return true; }

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
      Planes& all = planes_of(frame);
      check_equal(planes.planes[p].height, all.band ? all.rows.count() : frame.info.height, planes.names[p]);
      if (all.band) all.held[planes.names[p]] = {.valid = all.rows, .first = all.rows.begin};
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
    const Planes& from_planes = planes_of(frame);
    const Rows rows = from_planes.band ? divided(from_planes.rows, factor) : Rows{0, small.info.height};
    const bool again =
        last && last.use_count() == 1 && last->image.width == small.info.width && last->image.height == rows.count();
    if (!again) last = std::make_shared<Planes>(Planes{Image(small.info.width, rows.count())});
    std::shared_ptr<Planes> planes = last;
    if (from_planes.band) {
      planes->band = Band{divided(from_planes.band->rows, factor), 0, from_planes.band->wholes};
      planes->rows = rows;
      planes->held.clear();
      planes->passes = 0;
    }
    // The first pixel of each block, not their mean: a mean of two surfaces' depths lies on neither of them, and there
    // a technique would find occluders in the air. The first and not the nearest, so that one camera fits all of them.
    for (const std::string& name : names)
      for (int layer = 0; layer < kMostLayers; ++layer) {
        const std::string of_layer = layer_plane(layer, name);
        const Plane* in = planes_of(frame).image.find(of_layer);
        if (!in) continue;
        Plane& out = planes->image.add(of_layer);
        int first = 0;  // row of `in` that the first of `out` is
        if (const Held* held = find_held(from_planes, of_layer)) {
          planes->held[of_layer] = {divided(held->valid, factor), held->version, rows.begin};
          first = rows.begin * factor - held->first;
        }
        for_rows(out.height, [&](int y) {
          const float* from = in->row(first + y * factor);
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
    Planes& whole = planes_of(full);
    for (const std::string& name : names) {
      const Plane* in = find_plane(planes_of(small), name);
      if (!in) return usage_error("the picture has no plane '{}'", name);
      Plane& out = planes_of(full).image.add(reduced_plane(name));
      if (const Held* held = find_held(planes_of(small), name); held && whole.band) {
        // A pass reads it where the rows are that it stands for.
        const Rows valid{held->valid.begin * factor,
                         held->valid.end < small.info.height ? held->valid.end * factor : full.info.height};
        whole.held[reduced_plane(name)] = {valid, ++whole.passes, held->first};
      }
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

  std::vector<std::string> plane_names(const Frame& frame) const override {
    const Planes& planes = planes_of(frame);
    std::vector<std::string> names = planes.image.names;
    for (const std::string& name : planes.neutral)
      if (!planes.image.find(name)) names.push_back(name);
    return names;
  }

  Result<Image> download(const Frame& frame, const std::vector<std::string>& names) override {
    const Planes& planes = planes_of(frame);
    const std::vector<std::string> wanted = names.empty() ? plane_names(frame) : names;
    if (planes.band) return download_band(frame, wanted);
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
  /// Of a band, its rows that lie inside the guard band.
  Result<Image> download_band(const Frame& frame, const std::vector<std::string>& names) {
    const Planes& planes = planes_of(frame);
    const int guard = frame.info.guard;
    const Rows& own = planes.band->rows;
    const Rows rows{std::clamp(own.begin, guard, frame.info.height - guard),
                    std::clamp(own.end, guard, frame.info.height - guard)};
    Image out(frame.info.inner_width(), rows.count());
    for (const std::string& name : names) {
      const Plane* plane = find_plane(planes, name);
      const Held* held = find_held(planes, name);
      int first = planes.rows.begin;
      if (held && !held->made) {
        plane = find_whole(planes, frame.info, name, held->version);
        first = 0;
      } else if (held) {
        if (!held->valid.contains(own)) return unfinished(planes, held->valid, frame.info.reduced);
        first = held->first;
      }
      if (!plane) return usage_error("the picture has no plane '{}'", name);
      Plane& to = out.add(name);
      for (int y = 0; y < rows.count(); ++y)
        if (rows.begin + y - first < plane->height)
          std::copy_n(plane->row(rows.begin + y - first) + guard, out.width, to.row(y));
    }
    return out;
  }

  /// What a pass needs of the band that it runs on.
  struct BandRun {
    Rows rows;                     ///< for which the outputs can be made
    std::vector<std::string> far;  ///< planes that it reads anywhere
    bool done = false;             ///< all it would make is there as whole planes
  };

  /// Finds out on which rows of a band a pass can run. Where planes have to be whole that are not yet, the band's rows
  /// become part of them. Errors: kUnfinished.
  Result<BandRun> prepare_band(const PassRun& run, Planes& planes) {
    const PictureInfo& info = run.info;
    BandRun of{.rows = planes.rows};
    const int version = ++planes.passes;
    bool all = run.pixels == PixelSet::kAll;
    for (const std::string_view output : run.pass.outputs)
      all = all && (!run.is_there(output) || find_whole(planes, info, run.plane(output), version));
    if (all) {
      for (const std::string_view output : run.pass.outputs)
        if (run.is_there(output)) planes.held[run.plane(output)] = {planes.rows, version, 0, false};
      of.done = true;
      return of;
    }
    const int reach = run.pass.reach ? run.pass.reach(run.constants.data(), run.round) : 0;
    std::vector<std::string> wanted;
    const auto& far = run.pass.far_inputs;
    for (const std::string_view input : run.pass.inputs) {
      const std::string name = run.plane(input);
      const Held* held = find_held(planes, name);
      if (!held) continue;
      if (!run.pass.reach || std::find(far.begin(), far.end(), input) != far.end()) {
        of.far.push_back(name);
        if (!find_whole(planes, info, name, held->version)) wanted.push_back(name);
      } else if (held->made) {
        const Rows valid = shrunk(held->valid, reach, info.height);
        of.rows = {std::max(of.rows.begin, valid.begin), std::min(of.rows.end, valid.end)};
      }
    }
    // Of missing pixels the others keep what they have.
    if (run.pixels == PixelSet::kMissing)
      if (const Held* ao = find_held(planes, run.plane("ao")))
        of.rows = {std::max(of.rows.begin, ao->valid.begin), std::min(of.rows.end, ao->valid.end)};
    if (!wanted.empty()) {
      const Rows& own = planes.band->rows;
      for (const std::string& name : wanted) {
        const Held& held = *find_held(planes, name);
        if (!held.valid.contains(own)) return unfinished(planes, held.valid, info.reduced);
      }
      for (const std::string& name : wanted) {
        const Held& held = *find_held(planes, name);
        Plane& whole = planes.band->wholes->planes[{info.reduced, name, held.version}].plane;
        if (!whole.data()) whole = Plane(info.width, info.height);
        const Plane& from = planes.image.plane(name);
        for_rows(own.count(), [&](int y) {
          std::copy_n(from.row(own.begin + y - held.first), info.width, whole.row(own.begin + y));
        });
      }
      return unfinished(planes, own, info.reduced);
    }
    if (run.pass.host) return of;
    for (const std::string_view output : run.pass.outputs) {
      if (!run.is_there(output)) continue;
      const std::string name = run.plane(output);
      // A pass may write a part of what was there before.
      if (const Held* held = find_held(planes, name); held && !held->made) {
        const Plane& from = *find_whole(planes, info, name, held->version);
        Plane& to = planes.image.add(name);
        for_rows(to.height, [&](int y) { std::copy_n(from.row(planes.rows.begin + y), info.width, to.row(y)); });
      }
      planes.held[name] = {of.rows, version, planes.rows.begin};
    }
    return of;
  }

  /// Where row 0 of a plane would be: of a whole one, or of what a band holds of it.
  static float* row_zero_of(const PassRun& run, const Planes& planes, const BandRun& band, const std::string& name) {
    const Held* held = find_held(planes, name);
    const bool far = std::find(band.far.begin(), band.far.end(), name) != band.far.end();
    const bool whole = held && (far || !held->made);
    const Plane* plane = whole ? find_whole(planes, run.info, name, held->version) : find_plane(planes, name);
    return row_zero(const_cast<float*>(plane->data()), plane->stride,
                    whole  ? 0
                    : held ? held->first
                           : planes.rows.begin);
  }

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

  /// Runs a host step, once for a whole picture. What it makes is that of all of its bands.
  Result<void> run_host(const PassRun& run, Planes& planes) {
    const PictureInfo& info = run.info;
    std::list<Plane> whole_neutral;  // a band's own are as high as that
    std::vector<const Plane*> inputs;
    for (const std::string_view input : run.pass.inputs) {
      const std::string name = run.plane(input);
      const Held* held = find_held(planes, name);
      if (held)
        inputs.push_back(find_whole(planes, info, name, held->version));
      else if (planes.band)
        inputs.push_back(&whole_neutral.emplace_back(info.width, info.height, *neutral_value(name)));
      else
        inputs.push_back(find_plane(planes, name));
    }
    Watch watch(go_on, 1);
    if (watch.ended()) return watch.result();
    std::vector<Plane> outputs;
    arena_.execute([&] { outputs = run_host_step(run, inputs); });
    for (std::size_t k = 0; k < outputs.size(); ++k) {
      if (!run.is_there(run.pass.outputs[k])) continue;
      const std::string name = run.plane(run.pass.outputs[k]);
      if (planes.band) {
        planes.band->wholes->planes[{info.reduced, name, planes.passes}] = {std::move(outputs[k]), true};
        planes.held[name] = {planes.rows, planes.passes, 0, false};
      } else {
        planes.image.add(name) = std::move(outputs[k]);
      }
    }
    watch.done(1);
    return watch.result();
  }

  Result<void> run_pass(const PassRun& run, Planes& planes) {
    const Pass& pass = run.pass;
    const PictureInfo& info = run.info;
    for (std::string_view input : pass.inputs) {
      const std::string name = run.plane(input);
      if (find_plane(planes, name) || find_held(planes, name)) continue;
      const auto value = neutral_value(name);
      if (!value) return missing_plane(run, name);
      if (!planes.constants.count(*value))
        planes.constants.emplace(*value, Plane(info.width, planes.image.height, *value));
      planes.neutral.push_back(name);
    }
    // The inputs are looked up before the outputs, which may have the same names, are made.
    std::vector<KernelPlane> kernel_planes;
    BandRun band{.rows = {0, info.height}};
    if (planes.band) {
      auto ready = prepare_band(run, planes);
      if (!ready) return ready.error();
      band = std::move(*ready);
      if (band.done) return {};
    }
    if (pass.host) return run_host(run, planes);
    for (std::string_view output : pass.outputs)
      if (run.is_there(output)) planes.image.add(run.plane(output));
    if (band.rows.count() <= 0) return {};
    // A kernel stores to its outputs alone, which are nobody else's.
    for (std::string_view name : pass.inputs)
      kernel_planes.push_back({name, row_zero_of(run, planes, band, run.plane(name))});
    for (std::string_view name : pass.outputs)
      kernel_planes.push_back({name, run.is_there(name) ? row_zero_of(run, planes, band, run.plane(name)) : nullptr});
    const int stride = planes.image.plane(run.plane(pass.outputs[0])).stride;
    const bool all = run.pixels == PixelSet::kAll;
    const Plane* ao = all ? nullptr : planes.image.find(run.plane("ao"));
    if (!all && !ao) return missing_plane(run, "ao");
    KernelFrame kernel_frame{frame_constants(info, stride, run.round, run.pixels), run.constants.data(), kernel_planes,
                             ao ? row_zero_of(run, planes, band, run.plane("ao")) : nullptr};
    if (planes.band && band.far.empty()) {
      kernel_frame.first_row = planes.rows.begin;
      kernel_frame.last_row = planes.rows.end - 1;
    }
    const bool tuned = settings_.tuned && pass.tuned && all;
    const CpuKernel kernel = settings_.scalar ? pass.kernel.scalar : tuned ? pass.tuned : pass.kernel.lanes;

    // Missing pixels are few: each tile leaves lanes over, but pixels far from each other share no cache lines.
    constexpr int kMissingTile = 128;
    const int tile_width = std::min(all ? pass.tile.width : kMissingTile, stride);
    const int tile_height = all ? pass.tile.height : kMissingTile;
    const int columns = (info.width + tile_width - 1) / tile_width;
    const int rows = (band.rows.count() + tile_height - 1) / tile_height;
    Watch watch(go_on, long(rows) * columns);
    arena_.execute([&] {
      tbb::parallel_for(
          tbb::blocked_range<int>(0, rows * columns, 1),
          [&](const tbb::blocked_range<int>& range) {
            for (int t = range.begin(); t < range.end() && !watch.ended(); ++t) {
              const int x0 = t % columns * tile_width, y0 = band.rows.begin + t / columns * tile_height;
              fault_point();
              kernel(kernel_frame,
                     {x0, y0, std::min(x0 + tile_width, info.width), std::min(y0 + tile_height, band.rows.end)});
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

std::unique_ptr<Device> make_cpu_device(const CpuSettings& settings) {
  CpuSettings bounded = settings;
  bounded.scalar = settings.scalar || isa_in_use() == "scalar";
  return std::make_unique<CpuDevice>(bounded);
}

}  // namespace umbrage
