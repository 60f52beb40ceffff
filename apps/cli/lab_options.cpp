#include "apps/cli/lab_options.h"

#include <CLI/CLI.hpp>
#include <tuple>

#include "apps/compare/tune.h"  // for intervals

namespace umbrage::cli {
namespace {

/// Adds --cameras, --samples and --runs to a group of the help.
void add_measure_options(CLI::App& command, MeasureOptions& o, const std::string& group) {
  add_number(command, "--cameras", o.cameras, kCameras, "max number of views of each scene")->group(group);
  add_number(command, "--samples", o.samples, kSamples, "rays per pixel of the ground truth, an even number")
      ->group(group);
  add_number(command, "--runs", o.runs, kRuns, "runs per measured time")->group(group);
}

void add_compare(CLI::App& app, std::function<Result<void>()>& run, decltype(LabActions::compare) action) {
  const auto [command, options] = add_model_command(
      app, run, "compare", "measure each technique against ray-traced ground truth", kCompare, action);
  const auto comparison = "Comparison";
  command->get_option("MODEL")->required(false);  // --sequence has scenes of its own
  command
      ->add_option("--ao", options->techniques,
                   "techniques, such as unsharp,reference, or all [all; with --sequence that of each look]")
      ->type_name("NAMES")
      ->group(comparison);
  CLI::Option* sequence =
      command
          ->add_flag("--sequence", options->sequence,
                     "measure the flicker of short sequences, single and steady, beside that of their ground truth")
          ->group(comparison);
  for (const auto& [name, value, help] :
       {std::tuple("--motion", &options->motions, "what moves: turntable, walk, pan, object, light [all]"),
        {"--look", &options->looks, "looks of the sequences [ao,studio]"}})
    command->add_option(name, *value, help)->type_name("NAMES")->group(comparison)->needs(sequence);
  command
      ->add_flag("--light", options->light,
                 "also compare the indirect light of techniques with one bounce of the reference, and the light of a "
                 "clear sky, a studio and a sunset")
      ->group(comparison)
      ->excludes(sequence);
  add_one(*command, *options, "occlusion_scale", comparison,
          "resolution at which techniques run: full, half or quarter", "full");
  command
      ->add_option("--filter", options->filter,
                   "effect that filters the result of each technique that does not filter itself; none: no filter "
                   "[denoise]")
      ->type_name("NAME")
      ->group(comparison)
      ->excludes(sequence);
  command
      ->add_flag("--budget", options->budget,
                 "divide the error of each screen-space technique: that of what the view holds, and its own")
      ->group(comparison)
      ->excludes(sequence);
  command->add_option("-o,--output", options->output, "folder for index.html and scores.json [report]")
      ->type_name("DIR")
      ->group(comparison);
  add_sizes(*command, options->sizes, "960,540 and 480,270; with --sequence 384,384")->group(comparison);
  add_measure_options(*command, *options, comparison);
  command->add_option("--baseline", options->baseline, "earlier scores.json; fail if a score is worse than in it")
      ->type_name("FILE")
      ->group(comparison);
  add_group(*command, *options, kCompare, "Technique");
  add_device_options(*command, *options, kCompare);
}

void add_tune(CLI::App& app, std::function<Result<void>()>& run, decltype(LabActions::tune) action) {
  const auto [command, options] = add_model_command(
      app, run, "tune", "search the best settings for a scene, against ray-traced ground truth", kTune, action);
  std::tie(options->request.width, options->request.height) = std::pair(960, 540);
  const auto search = "Search";
  add_number(*command, "--time", options->budget_ms, kBudgetMs, "max time of occlusion with its filter, milliseconds",
             "time of the initial settings")
      ->group(search);
  add_number(*command, "--trials", options->trials, kTrials, "max number of settings to try")->group(search);
  add_one(*command, *options, "width", search, "", "960,540");
  add_one(*command, *options, "look", search, "look that provides the technique, filter and initial settings");
  add_one(*command, *options, "occlusion", search);
  add_one(*command, *options, "occlusion_scale", search, "", "all are tried");
  add_measure_options(*command, *options, search);
  command->add_flag("--json", options->json, "print all tried settings as JSON");
  add_group(*command, *options, kTune, "Technique");
  add_device_options(*command, *options, kTune);
}

void add_figures(CLI::App& app, std::function<Result<void>()>& run, decltype(LabActions::figures) action) {
  CLI::App* command = app.add_subcommand("figures", "reproduce the figures and tables of a paper");
  auto options = std::make_shared<FiguresOptions>();
  command->add_option("--paper", options->paper, "unsharp, cartoon or bleeding [unsharp]")->type_name("NAME");
  command->add_option("-o,--output", options->output, "folder to write to [figures]")->type_name("DIR");
  add_number(*command, "--size", options->size, {128, 4096, NumberKind::kInteger}, "side of the pictures in pixels",
             "the paper's: unsharp 1024, cartoon 512, bleeding 768");
  add_number(*command, "--runs", options->runs, {1, 1000, NumberKind::kInteger},
             "runs per measured time in the tables");
  command->add_option("--bunny", options->bunny, "the Stanford bunny, for unsharp [Debian's glmark2-data]")
      ->type_name("FILE");
  add_device_options(*command, *options, kFigures);
  command->callback([options, &run, action] { run = with_options(options, action); });
}

void add_bench(CLI::App& app, std::function<Result<void>()>& run, decltype(LabActions::bench) action) {
  CLI::App* command = app.add_subcommand("bench", "measure the time of every effect");
  auto options = std::make_shared<BenchOptions>();
  command->add_option("MODEL", options->models, "model or built-in scene [scene:claw]")->expected(0, 1);
  command->add_option("--effect", options->effect, "measure this effect only; capture is allowed too")
      ->type_name("NAME");
  add_one(*command, *options, "occlusion_scale", "",
          "full; half or quarter measure techniques and filters alone, at that resolution", "full");
  add_sizes(*command, options->sizes, "1024,1024");
  add_number(*command, "--runs", options->runs, {1, 10000, NumberKind::kInteger}, "runs per measured time");
  command->add_flag("--json", options->json, "print JSON");
  add_device_options(*command, *options, kBench);
  command->callback([options, &run, action] { run = with_options(options, action); });
}

}  // namespace

void add_lab(CLI::App& app, std::function<Result<void>()>& run, const LabActions& actions) {
  add_compare(app, run, actions.compare);
  add_tune(app, run, actions.tune);
  add_figures(app, run, actions.figures);
  add_bench(app, run, actions.bench);
}

}  // namespace umbrage::cli
