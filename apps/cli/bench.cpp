// umbrage bench: time of every effect, device and size.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/cli/commands.h"
#include "apps/cli/options.h"
#include "apps/cli/progress.h"
#include "core/image.h"
#include "core/suggest.h"
#include "effects/effects.h"
#include "renderer/draw.h"
#include "renderer/models.h"

namespace umbrage::cli {
namespace {

struct BenchOptions : CommonOptions {
  std::vector<std::string> sizes = {"1024,1024"};
  std::string effect;
  int runs = 9;
  bool json = false;
};

struct Times {
  double median = 0.0, least = 0.0;
  std::optional<double> gpu_median;  ///< of the passes alone, where the device measures them
};

/// Runs something again and again. The first run, which is not counted, warms caches and pays for fresh memory; the
/// others take it over, as frames do that are drawn one after the other.
template <class Run>
Result<Times> time_of(int runs, Device& device, const Run& run) {
  const KeptPlanes kept;
  std::vector<double> ms, gpu_ms;
  if (auto done = device.finish(); !done) return done.error();
  for (int i = 0; i <= runs; ++i) {
    device.take_pass_times();
    StageTimes times;
    if (Result<void> done = run(); !done) return done.error();
    if (Result<void> done = device.finish(); !done) return done.error();
    times.done("run");
    const auto passes = device.take_pass_times();
    if (i == 0) continue;
    ms.push_back(times.total());
    if (!passes.empty()) gpu_ms.push_back(0.0);
    for (const PassTime& pass : passes) gpu_ms.back() += pass.ms;
  }
  std::sort(ms.begin(), ms.end());
  std::sort(gpu_ms.begin(), gpu_ms.end());
  Times times{ms[ms.size() / 2], ms[0], {}};
  if (!gpu_ms.empty()) times.gpu_median = gpu_ms[gpu_ms.size() / 2];
  return times;
}

/// What --ao-scale holds for.
bool runs_reduced(const Effect& effect) {
  return effect.kind == EffectKind::kOcclusion || effect.kind == EffectKind::kFilter;
}

/// The frame at reduced resolution, all its planes.
Result<Frame> reduced_frame(Device& device, const Frame& frame, int every) {
  std::vector<std::string> names = device.plane_names(frame);
  std::erase_if(names, [](const std::string& name) { return name.starts_with("layer"); });
  return device.reduced(frame, every, names);
}

Result<void> bench(const BenchOptions& o) {
  constexpr int kMostRuns = 10000;
  if (o.runs < 1 || o.runs > kMostRuns) return usage_error("--runs cannot be {}: it takes 1 to {}", o.runs, kMostRuns);
  std::vector<std::string_view> names = {"capture"};
  for (const Effect* effect : effects()) names.push_back(effect->name);
  if (!o.effect.empty() && std::find(names.begin(), names.end(), o.effect) == names.end())
    return usage_error("there is no effect '{}' to time{}", o.effect, suggestion(o.effect, names));
  const std::string scale = o.request.occlusion_scale.empty() ? "full" : o.request.occlusion_scale;
  const auto every = parse_scale("occlusion_scale", scale);
  if (!every) return every.error();
  if (*every > 1 && !o.effect.empty() && (o.effect == "capture" || !runs_reduced(*find_effect(o.effect))))
    return usage_error("--ao-scale cannot be '{}' with --effect {}: it takes full, or a technique or filter", scale,
                       o.effect);
  std::vector<std::pair<int, int>> sizes;
  for (const std::string& text : o.sizes) {
    const auto size = parse_size("width", text, kMostPixels);
    if (!size) return size.error();
    sizes.push_back(*size);
  }
  auto with_threads = device_of(o);
  if (!with_threads) return with_threads.error();
  Device& device = **with_threads;
  ProgressLine line;
  line.show("reading the model");
  auto scene = load_scene(o.models.empty() ? "scene:claw" : o.models[0]);
  if (!scene) return scene.error();
  if (auto ready = device.prepare(*scene); !ready) return ready;

  nlohmann::json records = nlohmann::json::array();
  line.wipe();
  if (!o.json)
    fmt::print("{} ({} triangles), {}, median and least of {} runs\n{:<10} {:<28} {:>11} {:>9} {:>9}\n", scene->name,
               scene->triangle_count(), device.description(), o.runs, "effect", "setting", "size", "ms", "ms_min");
  // As if all took the same time.
  const double steps = double(sizes.size()) * (o.effect.empty() ? double(effects().size() + 1) : 1.0);
  double step = 0.0;
  for (const auto& [width, height] : sizes) {
    const auto timing = [&, width = width, height = height](std::string_view effect) {
      line.show(fmt::format("timing {} at {}x{}", effect, width, height), step++ / steps);
    };
    const auto report = [&, width = width, height = height](std::string_view effect, const std::string& setting,
                                                            const Times& t) {
      records.push_back({{"effect", effect},
                         {"setting", setting},
                         {"device", device.name()},
                         {"width", width},
                         {"height", height},
                         {"threads", device.threads()},
                         {"ms", t.median},
                         {"ms_min", t.least}});
      if (*every > 1) records.back()["scale"] = scale;
      if (t.gpu_median) records.back()["gpu_ms"] = *t.gpu_median;
      line.wipe();
      if (!o.json)
        fmt::print("{:<10} {:<28} {:>11} {:9.2f} {:9.2f}{}\n", effect, setting, fmt::format("{}x{}", width, height),
                   t.median, t.least, t.gpu_median ? fmt::format(" {:9.3f} on the GPU", *t.gpu_median) : "");
    };
    RenderRequest draw_with;
    draw_with.width = width;
    draw_with.height = height;
    draw_with.look = "unsharp";
    StageTimes ignored;
    auto frame = draw(device, *scene, draw_with, ignored);
    if (!frame) return frame.error();
    if (*every > 1) {
      auto small = reduced_frame(device, *frame, *every);
      if (!small) return small.error();
      frame = std::move(small);
    }
    if (o.effect.empty() || o.effect == "capture") timing("capture");
    if (*every == 1 && (o.effect.empty() || o.effect == "capture"))
      for (const bool shadow : {false, true}) {
        const auto times = time_of(o.runs, device, [&, width = width, height = height]() -> Result<void> {
          const auto drawn =
              device.capture(frame->info.camera, {.width = width, .height = height, .shadows = shadow ? 1 : 0});
          return drawn ? Result<void>() : drawn.error();
        });
        if (!times) return times.error();
        report("capture", shadow ? "shadow" : "", *times);
      }
    for (const Effect* effect : effects()) {
      if (!o.effect.empty() && o.effect != effect->name) continue;
      timing(effect->name);
      if (*every > 1 && !runs_reduced(*effect)) continue;
      const std::vector<std::string_view> only_own = {""};
      for (const std::string_view variant : effect->variants.empty() ? only_own : effect->variants) {
        EffectSettings settings = look_settings(*find_look("unsharp"));
        if (auto set = apply_variant(settings, *effect, variant); !set) return set;
        const auto times = time_of(o.runs, device, [&]() -> Result<void> {
          const auto done = device.run(*effect, params_of(settings, effect->name), *frame);
          return done ? Result<void>() : done.error();
        });
        if (!times) return times.error();
        report(effect->name, std::string(variant), *times);
        if (effect->kind != EffectKind::kOcclusion || *every > 1) continue;
        // All that --ao-scale half does: taking pixels out, the technique, putting back, and filling between.
        Look alone;
        alone.effects = {"occlusion"};
        const LookRun half = {.look = &alone, .occlusion = effect->name, .occlusion_every = 2, .settings = &settings};
        const auto half_times = time_of(o.runs, device, [&]() -> Result<void> {
          const auto done = run_look(half, device, *frame);
          return done ? Result<void>() : done.error();
        });
        if (!half_times) return half_times.error();
        report(effect->name, variant.empty() ? "scale=half" : fmt::format("{} scale=half", variant), *half_times);
      }
    }
  }
  if (o.json) fmt::print("{}\n", records.dump(2));
  return {};
}

}  // namespace

void add_bench(CLI::App& app, std::function<Result<void>()>& run) {
  CLI::App* command = app.add_subcommand("bench", "time every effect");
  auto options = std::make_shared<BenchOptions>();
  command->add_option("MODEL", options->models, "model or built-in scene [scene:claw]")->expected(0, 1);
  command->add_option("--effect", options->effect, "time this one only; capture is one too");
  add_one(*command, *options, "occlusion_scale", "",
          "full, or half or quarter: techniques and filters alone, at that share of the resolution", "full");
  command->add_option("--resolution", options->sizes, "width,height; may be given several times [1024,1024]")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  command->add_option("--runs", options->runs, "runs behind each time [9]");
  command->add_flag("--json", options->json, "print JSON");
  add_device_options(*command, *options, kBench);
  command->callback([options, &run] { run = with_options(options, bench); });
}

}  // namespace umbrage::cli
