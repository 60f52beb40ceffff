// umbrage figures: reproduces the figures and tables of the papers and checks numbers measured from them.
#include "apps/lab/commands.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/cli/progress.h"
#include "apps/figures/figures.h"
#include "core/suggest.h"
#include "io/image_file.h"

namespace umbrage::cli {
namespace {

namespace fs = std::filesystem;

struct Paper {
  std::string_view name, title;
  int size;         // side in pixels in the paper
  bool with_bunny;  // whether the figures need the file of --bunny
  Result<std::vector<Figure>> (*figures)(Device&, const FigureSettings&);
  Result<std::vector<FigureTable>> (*tables)(Device&, const FigureSettings&);
};

constexpr Paper kPapers[] = {
    {"unsharp", "the unsharp-mask paper", 1024, true, unsharp_figures, unsharp_tables},
    {"cartoon", "the cartoon-rendering paper", 512, false, cartoon_figures, cartoon_tables},
    {"bleeding", "the colour-bleeding paper", 768, false, bleeding_figures, bleeding_tables},
};

std::string report_of(const Paper& paper, const std::vector<Figure>& figures, const std::vector<FigureTable>& tables,
                      const std::string& device, int size) {
  std::string text = fmt::format("# Figures of {}\n\n![contact sheet](contact-sheet.png)\n", paper.title);
  for (const Figure& figure : figures) {
    text += fmt::format("\n## Figure {}: {}\n\n", figure.id, figure.title);
    for (const FigurePicture& picture : figure.pictures)
      text += fmt::format("* [{}]({}): `{}`\n", picture.caption, picture.file, picture.command);
    text += "\n| number | value | bound | holds |\n| --- | --- | --- | --- |\n";
    for (const FigureNumber& number : figure.numbers) {
      const std::string bound = number.max > 1e29 ? fmt::format("at least {:g}", number.min)
                                                  : fmt::format("{:g} to {:g}", number.min, number.max);
      text +=
          fmt::format("| {} | {:.4g} | {} | {} |\n", number.what, number.value, bound, number.holds() ? "yes" : "no");
    }
  }
  for (const FigureTable& table : tables) {
    const bool has_notes =
        std::any_of(table.rows.begin(), table.rows.end(), [](const TableRow& r) { return !r.note.empty(); });
    text += fmt::format("\n## {}\n\n{}x{} pixels, {}\n\n| | ms |{}\n| --- | --- |{}\n", table.title, size, size, device,
                        has_notes ? " |" : "", has_notes ? " --- |" : "");
    for (const TableRow& row : table.rows)
      text += fmt::format("| {} | {:.1f} |{}\n", row.setting, row.ms, has_notes ? fmt::format(" {} |", row.note) : "");
  }
  return text;
}

}  // namespace

Result<void> run_figures(const FiguresOptions& requested) {
  FiguresOptions o = requested;
  if (o.bunny.empty()) o.bunny = kBunnyFile;
  const auto paper =
      std::find_if(std::begin(kPapers), std::end(kPapers), [&](const Paper& p) { return p.name == o.paper; });
  if (paper == std::end(kPapers)) {
    std::vector<std::string_view> names;
    for (const Paper& p : kPapers) names.push_back(p.name);
    return with_field(unknown_name("paper", o.paper, names), "--paper", o.paper);
  }
  if (o.size == 0) o.size = paper->size;
  auto device = device_of(o);
  if (!device) return device.error();
  if (paper->with_bunny && !fs::exists(o.bunny))
    return with_field(
        file_error("'{}': the Stanford bunny is missing; install glmark2-data or name it with --bunny", o.bunny),
        "--bunny", o.bunny);
  const fs::path folder(o.output);
  if (auto writable = check_folder(folder, {"contact-sheet.png", "numbers.json", "index.md"}); !writable)
    return writable;

  ProgressLine line;
  const FigureSettings settings{o.bunny, o.size, o.runs, [&line](const std::string& what) { line.show(what); }};
  const auto figures = paper->figures(**device, settings);
  if (!figures) return figures.error();
  const auto tables = paper->tables(**device, settings);
  if (!tables) return tables.error();
  line.wipe();
  if (auto made = make_folder(folder); !made) return made;

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
      fmt::print("figure {:<8} {:<70} {:10.4f}  {}\n", figure.id, number.what, number.value,
                 number.holds() ? "holds" : "MISSED");
    }
  }
  for (const FigureTable& table : *tables)
    for (const TableRow& row : table.rows)
      fmt::print("{:<15} {:<70} {:7.1f} ms{}{}\n", table.id, row.setting, row.ms, row.note.empty() ? "" : "  ",
                 row.note);
  if (auto written = write_image(folder / "contact-sheet.png", contact_sheet(*figures, o.size / 2), {.small = true});
      !written)
    return written;
  if (auto written = write_text(folder / "numbers.json", records.dump(2) + "\n"); !written) return written;
  if (auto written =
          write_text(folder / "index.md", report_of(*paper, *figures, *tables, (*device)->description(), o.size));
      !written)
    return written;
  fmt::print("{} pictures, contact-sheet.png and index.md are in {}\n", picture_count, o.output);
  if (missed > 0)
    return Error{ErrorKind::kInternal, fmt::format("{} of {} numbers are out of bounds", missed, records.size())};
  return {};
}

}  // namespace umbrage::cli
