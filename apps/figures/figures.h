// Reproduces the figures and tables of the papers and measures numbers that must lie within given bounds.
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
  std::string caption;  ///< short description of the settings
  std::string command;  ///< the command line that draws it
  Image image;          ///< color.r, color.g, color.b
  bool detail = false;  ///< show the middle at full resolution on the contact sheet, not the whole picture
};

/// A number measured from the pictures of a figure, with the bounds that reproduce the paper.
struct FigureNumber {
  std::string what;
  double value = 0.0;
  double min = 0.0, max = 0.0;  ///< bounds, inclusive
  bool holds() const { return value >= min && value <= max; }
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

/// Default file of the Stanford bunny, from Debian's package glmark2-data.
inline constexpr const char* kBunnyFile = "/usr/share/glmark2/models/bunny.obj";

/// What the figures and tables of the papers depend on.
struct FigureSettings {
  std::string bunny = kBunnyFile;  ///< model file of figures 2 and 3 of [Chamberlin 2011]
  int size = 512;                  ///< side of the pictures, pixels
  int runs = 5;                    ///< of which a time is the median
  /// Receives the name of each figure and table before it is made.
  std::function<void(const std::string&)> progress = [](const std::string&) {};
};

/// Draws figures 1 to 6 of [Chamberlin 2011] (the paper: 1024 pixels); kernel windows scale with the size.
Result<std::vector<Figure>> unsharp_figures(Device& device, const FigureSettings& settings);

/// Measures the paper's claims about cost: time of the effect against the kernel window and against the number of
/// triangles.
Result<std::vector<FigureTable>> unsharp_tables(Device& device, const FigureSettings& settings);

/// Draws figures 1 to 6 and the picture pairs of appendix B of [Lajzer and Nottingham] (the paper: 512 pixels), in the
/// paper's preset and in ours.
Result<std::vector<Figure>> cartoon_figures(Device& device, const FigureSettings& settings);

/// Measures the time of every effect for both presets, and of the occlusion against the number of triangles.
Result<std::vector<FigureTable>> cartoon_tables(Device& device, const FigureSettings& settings);

/// Draws figures 1 to 16 of [Colliander and Törnquist 2015], in the paper's preset and in ours.
Result<std::vector<Figure>> bleeding_figures(Device& device, const FigureSettings& settings);

/// Measures table 1: time of a picture without occlusion and with 8 to 64 samples, with and without color bleeding.
Result<std::vector<FigureTable>> bleeding_tables(Device& device, const FigureSettings& settings);

/// Returns all pictures on one sheet, a row per figure, with captions. `tile`: side of a picture on the sheet, pixels.
Image contact_sheet(const std::vector<Figure>& figures, int tile);

}  // namespace umbrage
