#include "apps/cli/output.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/cli/picture_file.h"

namespace umbrage::cli {

void add_output_options(CLI::App& command, RenderOptions& options, std::string_view help_of_memory) {
  const auto output = "Output";
  add_one(command, options, "passes", output);
  add_one(command, options, "bits", output);
  add_number(command, "--picture-quality", options.picture_quality, {1, 100, NumberKind::kInteger},
             "quality of a .jpg or .webp (of a .webp, 100 is lossless)")
      ->group(output);
  command.add_flag("--half", options.half, "16-bit floats in an EXR, for planes for which their precision suffices")
      ->group(output);
  CLI::Option* memory =
      command.add_option("--memory", options.memory, fmt::format("{} [{}]", help_of_memory, options.memory));
  memory->type_name("SIZE")->group(output);
  add_check(*memory, [](const std::string& text) -> Result<void> {
    const auto bytes = parse_memory(text);
    return bytes ? Result<void>() : bytes.error();
  });
  command.add_flag("--json", options.json, "print the time of each stage as JSON")->group(output);
}

void add_frame_rate(CLI::App& command, double& frame_rate) {
  add_number(command, "--frame-rate", frame_rate, {0.1, 1000},
             "frames per second of a video, a camera path or an animation")
      ->group("Output");
}

Result<double> parse_memory(std::string_view text) {
  constexpr std::string_view kUnits = "KMGT";
  const std::size_t unit = text.empty() ? std::string_view::npos : kUnits.find(text.back());
  const auto number = parse_number(text.substr(0, text.size() - (unit == std::string_view::npos ? 0 : 1)));
  if (!number || !(*number > 0.0))
    return field_error(
        "--memory", text,
        "{} cannot be '{}': it takes a number of bytes, or a number followed by K, M, G or T, such as 6G");
  return unit == std::string_view::npos ? *number : *number * std::pow(1024.0, double(unit + 1));
}

Result<void> check_piped(const RenderOptions& o) {
  if (::isatty(STDOUT_FILENO))
    return usage_error("-o - writes a PNG to standard output, which is a terminal: redirect it to a file or a program");
  if (o.json) return with_field(usage_error("-o - and --json cannot both write to standard output"), "--json");
  return {};
}

Result<void> check_output(const RenderOptions& o, const std::string& extension) {
  if (extension != "exr" && (o.request.passes.size() > 1 || o.writes_only("all")))
    return field_error("passes", o.text_of("passes"),
                       "`{}` {} needs a file that holds several passes: write to a name that ends in .exr");
  if (o.bits() != 8 && extension != "png")
    return field_error("bits", o.bits(), "`{0}` is for .png files, not .{2}", extension);
  if (auto status = check_format(o, extension); !status) return status;
  if (o.picture_quality != WriteSettings().quality && extension != "jpg" && extension != "jpeg" && extension != "webp")
    return field_error("--picture-quality", o.picture_quality, "{0} is for .jpg and .webp files, not .{2}", extension);
  if (o.half && extension != "exr") return field_error("--half", true, "{0} is for .exr files, not .{2}", extension);
  return {};
}

std::vector<DispatchTime> times_by_dispatch(const std::vector<DispatchTime>& dispatches) {
  std::vector<DispatchTime> sums;
  for (const DispatchTime& dispatch : dispatches) {
    const auto same = std::find_if(sums.begin(), sums.end(), [&](const DispatchTime& sum) {
      return sum.effect == dispatch.effect && sum.dispatch == dispatch.dispatch;
    });
    if (same == sums.end())
      sums.push_back(dispatch);
    else
      same->ms += dispatch.ms;
  }
  return sums;
}

void print_times(const StageTimes& times, const std::vector<DispatchTime>& dispatches, bool json) {
  if (!json) {
    for (const auto& stage : times.stages) fmt::print(stderr, "{:<12}{:9.1f} ms\n", stage.name, stage.ms);
    fmt::print(stderr, "{:<12}{:9.1f} ms\n", "total", times.total());
    for (const DispatchTime& dispatch : dispatches)
      fmt::print(stderr, "{:<34}{:9.3f} ms on the GPU\n", fmt::format("{} / {}", dispatch.effect, dispatch.dispatch),
                 dispatch.ms);
    return;
  }
  nlohmann::json records = nlohmann::json::array();
  for (const auto& stage : times.stages) records.push_back({{"stage", stage.name}, {"ms", stage.ms}});
  for (const DispatchTime& dispatch : dispatches)
    records.push_back({{"stage", dispatch.effect}, {"pass", dispatch.dispatch}, {"gpu_ms", dispatch.ms}});
  records.push_back({{"stage", "total"}, {"ms", times.total()}});
  fmt::print("{}\n", records.dump(2));
}

void add_times(StageTimes& sum, const StageTimes& more) {
  for (const StageTimes::Stage& stage : more.stages) {
    const auto same = std::find_if(sum.stages.begin(), sum.stages.end(),
                                   [&](const StageTimes::Stage& known) { return known.name == stage.name; });
    if (same == sum.stages.end())
      sum.stages.push_back(stage);
    else
      same->ms += stage.ms;
  }
}

}  // namespace umbrage::cli
