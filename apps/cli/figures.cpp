// umbrage figures: the papers' figures and tables, with the numbers that they must show.
#include "apps/figures/figures.h"

#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/cli/commands.h"
#include "apps/cli/options.h"
#include "core/suggest.h"
#include "io/image_file.h"

namespace umbrage::cli {
namespace {

namespace fs = std::filesystem;

struct FiguresOptions : CommonOptions {
  std::string paper = "unsharp", output = "figures", bunny = kBunnyFile;
  int size = 1024, runs = 5;
};

constexpr std::array<std::string_view, 1> kPapers = {"unsharp"};

std::string report_of(const std::vector<Figure>& figures, const std::vector<FigureTable>& tables,
                      const std::string& device, int size) {
  std::string text = "# Figures of the unsharp-mask paper\n\n![contact sheet](contact-sheet.png)\n";
  for (const Figure& figure : figures) {
    text += fmt::format("\n## Figure {}: {}\n\n", figure.id, figure.title);
    for (const FigurePicture& picture : figure.pictures)
      text += fmt::format("* [{}]({}): `{}`\n", picture.caption, picture.file, picture.command);
    text += "\n| number | value | bound | holds |\n| --- | --- | --- | --- |\n";
    for (const FigureNumber& number : figure.numbers) {
      const std::string bound = number.most > 1e29 ? fmt::format("at least {:g}", number.least)
                                                   : fmt::format("{:g} to {:g}", number.least, number.most);
      text +=
          fmt::format("| {} | {:.4g} | {} | {} |\n", number.what, number.value, bound, number.holds() ? "yes" : "no");
    }
  }
  for (const FigureTable& table : tables) {
    text += fmt::format("\n## {}\n\n{}x{} pixels, {}\n\n| | ms |\n| --- | --- |\n", table.title, size, size, device);
    for (const TableRow& row : table.rows) text += fmt::format("| {} | {:.1f} |\n", row.setting, row.ms);
  }
  return text;
}

Result<void> make_figures(const FiguresOptions& o) {
  if (std::find(kPapers.begin(), kPapers.end(), o.paper) == kPapers.end())
    return usage_error("there is no paper '{}'{}", o.paper, suggestion(o.paper, kPapers));
  constexpr int kLeastSize = 128, kMostSize = 4096, kMostRuns = 1000;
  if (o.size < kLeastSize || o.size > kMostSize)
    return usage_error("--size cannot be {}: it takes {} to {} pixels", o.size, kLeastSize, kMostSize);
  if (o.runs < 1 || o.runs > kMostRuns) return usage_error("--runs cannot be {}: it takes 1 to {}", o.runs, kMostRuns);
  auto device = device_of(o);
  if (!device) return device.error();
  if (!fs::exists(o.bunny))
    return file_error("{}: the bunny of figure 3 is missing; install glmark2-data or name it with --bunny", o.bunny);
  std::error_code error;
  fs::create_directories(o.output, error);
  if (!fs::is_directory(o.output)) return file_error("{}: the folder cannot be made", o.output);
  const fs::path folder(o.output);
  if (auto writable = check_writable(folder / "contact-sheet.png"); !writable) return writable;

  const bool on_terminal = ::isatty(STDERR_FILENO) != 0;
  const auto progress = [on_terminal](const std::string& what) {
    if (on_terminal) fmt::print(stderr, "{}...\n", what);
  };
  const auto figures = unsharp_figures(**device, o.bunny, o.size, progress);
  if (!figures) return figures.error();
  const auto tables = unsharp_tables(**device, o.bunny, o.size, o.runs, progress);
  if (!tables) return tables.error();

  nlohmann::json records = nlohmann::json::array();
  int missed = 0;
  std::size_t picture_count = 0;
  for (const Figure& figure : *figures) {
    picture_count += figure.pictures.size();
    for (const FigurePicture& picture : figure.pictures)
      if (auto written = write_image(folder / picture.file, picture.image); !written) return written;
    for (const FigureNumber& number : figure.numbers) {
      records.push_back(
          {{"figure", figure.id}, {"what", number.what}, {"value", number.value}, {"holds", number.holds()}});
      missed += !number.holds();
      fmt::print("figure {:<5} {:<55} {:10.4f}  {}\n", figure.id, number.what, number.value,
                 number.holds() ? "holds" : "MISSED");
    }
  }
  for (const FigureTable& table : *tables)
    for (const TableRow& row : table.rows) fmt::print("{:<12} {:<55} {:7.1f} ms\n", table.id, row.setting, row.ms);
  if (auto written = write_image(folder / "contact-sheet.png", contact_sheet(*figures, o.size / 2)); !written)
    return written;
  if (auto written = write_text(folder / "numbers.json", records.dump(2) + "\n"); !written) return written;
  if (auto written = write_text(folder / "index.md", report_of(*figures, *tables, (*device)->description(), o.size));
      !written)
    return written;
  fmt::print("{} pictures, contact-sheet.png and index.md are in {}\n", picture_count, o.output);
  if (missed > 0)
    return Error{ErrorKind::kInternal,
                 fmt::format("{} of {} numbers are not what the paper shows", missed, records.size())};
  return {};
}

}  // namespace

void add_figures(CLI::App& app, std::function<Result<void>()>& run) {
  CLI::App* command = app.add_subcommand("figures", "make the figures and tables of a paper");
  auto options = std::make_shared<FiguresOptions>();
  command->add_option("--paper", options->paper, "unsharp [unsharp]");
  command->add_option("-o,--output", options->output, "folder to write to [figures]");
  command->add_option("--size", options->size, "side of the pictures in pixels [1024]");
  command->add_option("--runs", options->runs, "runs behind each time in the tables [5]");
  command->add_option("--bunny", options->bunny, "the Stanford bunny [Debian's glmark2-data]");
  add_device_options(*command, *options);
  command->callback([options, &run] { run = [options] { return make_figures(*options); }; });
}

}  // namespace umbrage::cli
