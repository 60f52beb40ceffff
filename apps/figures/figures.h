// The figures and tables of the papers, made anew, each with the numbers that it must show.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "core/device.h"
#include "core/image.h"
#include "core/result.h"

namespace umbrage {

struct FigurePicture {
  std::string file;     ///< name without folder: "unsharp-4-threshold-0.1.png"
  std::string caption;  ///< what was done, in a few words
  std::string command;  ///< the command line that draws it
  Image image;          ///< color.r, color.g, color.b
  bool detail = false;  ///< the contact sheet shows its middle unscaled instead of the whole
};

/// A number read off a figure's pictures, and whether it is what the paper shows.
struct FigureNumber {
  std::string what;
  double value = 0.0;
  double least = 0.0, most = 0.0;  ///< inclusive
  bool holds() const { return value >= least && value <= most; }
};

struct Figure {
  std::string id, title;
  std::vector<FigurePicture> pictures;
  std::vector<FigureNumber> numbers;
};

/// A row of a table of times.
struct TableRow {
  std::string setting;
  double ms = 0.0;
  std::string note;  ///< "+27.2 %", or empty
};
struct FigureTable {
  std::string id, title;
  std::vector<TableRow> rows;
};

/// Where the Stanford bunny is looked for: Debian's glmark2-data.
inline constexpr const char* kBunnyFile = "/usr/share/glmark2/models/bunny.obj";

/// Figures 1 to 6 of [Chamberlin 2011] at size x size pixels (the paper: 1024); windows scale with it.
/// `bunny` is the model of figure 3. `progress` is called with the name of each figure before it is drawn.
Result<std::vector<Figure>> unsharp_figures(Device& device, const std::string& bunny, int size,
                                            const std::function<void(const std::string&)>& progress);

/// The paper's claims of cost: time of the effect against the window and against the number of triangles; median of
/// `runs` runs.
Result<std::vector<FigureTable>> unsharp_tables(Device& device, const std::string& bunny, int size, int runs,
                                                const std::function<void(const std::string&)>& progress);

/// Figures 1 to 6 and the pairs of appendix B of [Lajzer and Nottingham] at size x size pixels (the paper: 512), in the
/// paper's preset and in ours.
Result<std::vector<Figure>> cartoon_figures(Device& device, int size,
                                            const std::function<void(const std::string&)>& progress);

/// Time of every pass for both presets, and of the occlusion against the number of triangles; median of `runs` runs.
Result<std::vector<FigureTable>> cartoon_tables(Device& device, int size, int runs,
                                                const std::function<void(const std::string&)>& progress);

/// Figures 1 to 16 of [Colliander and Törnquist 2015] at size x size pixels, in the paper's preset and in ours.
Result<std::vector<Figure>> bleeding_figures(Device& device, int size,
                                             const std::function<void(const std::string&)>& progress);

/// Table 1: time of a picture without occlusion and with 8 to 64 samples, with bleeding and without; median of `runs`
/// runs.
Result<std::vector<FigureTable>> bleeding_tables(Device& device, int size, int runs,
                                                 const std::function<void(const std::string&)>& progress);

/// All pictures on one sheet, a row per figure, with captions.
Image contact_sheet(const std::vector<Figure>& figures, int tile);

}  // namespace umbrage
