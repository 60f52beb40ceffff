// umbrage bench: measures the time of every effect at several sizes.
#include "apps/lab/commands.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/cli/progress.h"
#include "core/image.h"
#include "core/lists.h"
#include "core/suggest.h"
#include "effects/effects.h"
#include "renderer/draw.h"
#include "renderer/models.h"

namespace umbrage::cli {
namespace {

/// Times over several runs, milliseconds.
struct Times {
  double median = 0.0, min = 0.0;
  std::optional<double> gpu_median;  ///< median of the dispatches alone, if the device measures them
};

/// Measures `runs` runs after one uncounted run, which warms caches and allocates planes. The plane pool keeps the
/// planes between runs, as for frames that are drawn one after the other.
template <class Run>
Result<Times> time_of(int runs, Device& device, const Run& run) {
  const ScopedPlanePool pool(device.pool());
  std::vector<double> ms, gpu_ms;
  for (int i = 0; i <= runs; ++i) {
    if (auto ready = device.finish(); !ready) return ready.error();
    StageTimes times;
    if (Result<void> status = run(); !status) return status.error();
    const auto dispatches = device.finish();
    if (!dispatches) return dispatches.error();
    times.done("run");
    if (i == 0) continue;
    ms.push_back(times.total());
    if (!dispatches->empty()) gpu_ms.push_back(0.0);
    for (const DispatchTime& dispatch : *dispatches) gpu_ms.back() += dispatch.ms;
  }
  std::sort(ms.begin(), ms.end());
  std::sort(gpu_ms.begin(), gpu_ms.end());
  Times times{ms[ms.size() / 2], ms[0], {}};
  if (!gpu_ms.empty()) times.gpu_median = gpu_ms[gpu_ms.size() / 2];
  return times;
}

/// Returns whether --ao-scale applies to the effect.
bool supports_scale(const Effect& effect) {
  return (effect.kind == EffectKind::kOcclusion || effect.kind == EffectKind::kFilter) && !effect.filters_itself;
}

/// Returns the frame at reduced resolution with all its planes except further layers. `downsampling`: downsampling
/// factor.
Result<Frame> reduced_frame(Device& device, const Frame& frame, int downsampling) {
  std::vector<std::string> names = device.plane_names(frame);
  std::erase_if(names, [](const std::string& name) { return name.starts_with("layer"); });
  return device.reduced(frame, downsampling, names);
}

/// Adds the finished picture that some effects read in files of other renderers: here the albedo.
Result<void> add_beauty(Device& device, Frame& frame) {
  auto picture = device.download(frame, {"albedo.r", "albedo.g", "albedo.b"});
  if (!picture) return picture.error();
  picture->names = {"beauty.r", "beauty.g", "beauty.b"};
  return device.add(*picture, frame);
}

/// The checked options.
struct BenchPlan {
  std::vector<std::pair<int, int>> sizes;
  std::string scale;     ///< full, half or quarter
  int downsampling = 1;  ///< downsampling factor of `scale`: 1, 2 or 4
};

Result<BenchPlan> plan_of(const BenchOptions& o) {
  std::vector<std::string_view> names = {"capture"};
  for (const Effect* effect : effects()) names.push_back(effect->name);
  if (!o.effect.empty() && !contains(names, o.effect))
    return with_field(unknown_name("effect", o.effect, names), "--effect", o.effect);
  BenchPlan plan;
  plan.scale = o.request.occlusion_scale.empty() ? "full" : o.request.occlusion_scale;
  const auto downsampling = parse_scale("occlusion_scale", plan.scale);
  if (!downsampling) return downsampling.error();
  plan.downsampling = *downsampling;
  if (plan.downsampling > 1 && !o.effect.empty() && (o.effect == "capture" || !supports_scale(*find_effect(o.effect))))
    return field_error("occlusion_scale", plan.scale,
                       "`{}` cannot be '{}' with --effect {}: it takes full, or a technique or filter", o.effect);
  for (const std::string& text : o.sizes) {
    const auto size = parse_size("width", text, kMaxPixels);
    if (!size) return size.error();
    plan.sizes.push_back(*size);
  }
  return plan;
}

/// Measures one size after the other. Prints the times and keeps them for JSON.
class Bench {
 public:
  Bench(const BenchOptions& options, const BenchPlan& plan, Device& device, ProgressLine& line)
      : o_(options), plan_(plan), device_(device), line_(line) {
    // Progress counts all effects alike.
    steps_ = double(plan.sizes.size()) * (o_.effect.empty() ? double(effects().size() + 1) : 1.0);
  }

  Result<void> time_size(Scene& scene, std::pair<int, int> size) {
    size_ = size;
    Request request;
    request.width = size.first;
    request.height = size.second;
    request.look = "unsharp";
    StageTimes ignored;
    auto recipe = make_recipe(request);
    if (!recipe) return recipe.error();
    recipe->capture.ray_offsets = true;  // for effects that trace rays
    for (const Effect* effect : effects())
      recipe->capture.occluders =
          std::max(recipe->capture.occluders, occluders_read(*effect, params_of(recipe->settings, effect->name)));
    auto frame = draw(device_, scene, *recipe, ignored);
    if (!frame) return frame.error();
    if (auto added = add_beauty(device_, *frame); !added) return added;
    if (plan_.downsampling > 1) {
      auto small = reduced_frame(device_, *frame, plan_.downsampling);
      if (!small) return small.error();
      frame = std::move(small);
    }
    if (is_wanted("capture")) {
      show("capture");
      if (plan_.downsampling == 1)
        if (auto status = time_capture(frame->info.camera); !status) return status;
    }
    for (const Effect* effect : effects()) {
      if (!is_wanted(effect->name)) continue;
      show(effect->name);
      if (plan_.downsampling > 1 && !supports_scale(*effect)) continue;
      if (auto status = time_effect(*effect, *frame); !status) return status;
    }
    return {};
  }

  const nlohmann::json& records() const { return records_; }

 private:
  bool is_wanted(std::string_view effect) const { return o_.effect.empty() || o_.effect == effect; }

  void show(std::string_view effect) {
    line_.show(fmt::format("timing {} at {}x{}", effect, size_.first, size_.second), step_++ / steps_);
  }

  void report(std::string_view effect, const std::string& setting, const Times& t) {
    records_.push_back({{"effect", effect},
                        {"setting", setting},
                        {"device", device_.name()},
                        {"width", size_.first},
                        {"height", size_.second},
                        {"threads", device_.threads()},
                        {"ms", t.median},
                        {"ms_min", t.min}});
    if (plan_.downsampling > 1) records_.back()["scale"] = plan_.scale;
    if (t.gpu_median) records_.back()["gpu_ms"] = *t.gpu_median;
    line_.wipe();
    if (!o_.json)
      fmt::print("{:<10} {:<28} {:>11} {:9.2f} {:9.2f}{}\n", effect, setting,
                 fmt::format("{}x{}", size_.first, size_.second), t.median, t.min,
                 t.gpu_median ? fmt::format(" {:9.3f} on the GPU", *t.gpu_median) : "");
  }

  /// Measures `run` and reports its times.
  template <class Run>
  Result<void> time_run(std::string_view effect, const std::string& setting, const Run& run) {
    const auto times = time_of(o_.runs, device_, run);
    if (!times) return times.error();
    report(effect, setting, *times);
    return {};
  }

  Result<void> time_capture(const Camera& camera) {
    for (const int shadows : {0, 1}) {
      auto status = time_run("capture", shadows > 0 ? "shadow" : "", [&]() -> Result<void> {
        const auto frame = device_.capture(camera, {.width = size_.first, .height = size_.second, .shadows = shadows});
        return frame ? Result<void>() : frame.error();
      });
      if (!status) return status;
    }
    return {};
  }

  /// Measures all variants of an effect. Measures variants of a technique at half resolution as well.
  Result<void> time_effect(const Effect& effect, Frame& frame) {
    const std::vector<std::string_view> no_variants = {""};
    for (const std::string_view variant : effect.variants.empty() ? no_variants : effect.variants) {
      EffectSettings settings = look_settings(*find_look("unsharp"));
      if (auto set = apply_variant(settings, effect, variant); !set) return set;
      auto status = time_run(effect.name, std::string(variant), [&]() -> Result<void> {
        const auto ran = device_.run(effect, params_of(settings, effect.name), frame);
        return ran ? Result<void>() : ran.error();
      });
      if (!status) return status;
      if (effect.kind != EffectKind::kOcclusion || plan_.downsampling > 1) continue;
      // Includes all work of --ao-scale half: downsampling, the technique, upsampling and filling in between.
      Look technique_only;
      technique_only.effects = {"occlusion"};
      const LookRun half = {
          .look = &technique_only, .occlusion = effect.name, .occlusion_downsampling = 2, .settings = &settings};
      const std::string setting = variant.empty() ? "scale=half" : fmt::format("{} scale=half", variant);
      status = time_run(effect.name, setting, [&]() -> Result<void> {
        const auto state = run_look(half, device_, frame);
        return state ? Result<void>() : state.error();
      });
      if (!status) return status;
    }
    return {};
  }

  const BenchOptions& o_;
  const BenchPlan& plan_;
  Device& device_;
  ProgressLine& line_;
  double steps_ = 1.0, step_ = 0.0;
  std::pair<int, int> size_;
  nlohmann::json records_ = nlohmann::json::array();
};

}  // namespace

Result<void> run_bench(const BenchOptions& o) {
  const auto plan = plan_of(o);
  if (!plan) return plan.error();
  auto created = device_of(o);
  if (!created) return created.error();
  Device& device = **created;
  ProgressLine line;
  line.show("reading the model");
  auto scene = load_scene(o.models.empty() ? "scene:claw" : o.models[0]);
  if (!scene) return scene.error();
  if (auto ready = device.prepare(*scene); !ready) return ready;
  line.wipe();
  if (!o.json)
    fmt::print("{} ({} triangles), {}, median and min of {} runs\n{:<10} {:<28} {:>11} {:>9} {:>9}\n", scene->name,
               scene->triangle_count(), device.description(), o.runs, "effect", "setting", "size", "ms", "ms_min");
  Bench timings(o, *plan, device, line);
  for (const auto& size : plan->sizes)
    if (auto status = timings.time_size(*scene, size); !status) return status;
  if (o.json) fmt::print("{}\n", timings.records().dump(2));
  return {};
}

}  // namespace umbrage::cli
