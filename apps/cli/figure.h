// Figures: the physical size of a picture, and legends in it or in a file of their own.
#pragma once
#include <string>

#include "apps/cli/legend.h"
#include "apps/cli/page.h"
#include "renderer/recipe.h"

namespace CLI {
class App;
}

namespace umbrage::cli {

struct RenderOptions;

/// The options of figures.
struct FigureOptions {
  LegendSettings legend;      ///< without `font_size` and `ink`
  std::string legend_file;    ///< receives the legends in place of the picture; empty: none
  std::string fill = "none";  ///< of the areas of a page of lines: "none", "part" or "tone"
  std::string print_size;     ///< "80,60": width and height on paper, mm; empty: by the number of pixels
  double dpi = 0.0;           ///< pixels per inch on paper; 0: not given

  /// Returns the length of a pixel on paper, mm.
  float mm_per_pixel() const;
};

/// Adds the options of figures to the group Figure.
void add_figure_options(CLI::App& command, FigureOptions& options);

/// Sets the size of the picture in pixels from its size on paper, and the size of the legends' font, which is 8 points
/// on paper. Errors: kUsage for a wrong size, and for legends that the output cannot hold.
Result<void> apply_figure_options(RenderOptions& o);

/// The legends of a picture.
struct Legends {
  std::vector<DrawnLayer> layers;
  bool own_file = false;  ///< they are not drawn in the picture
  PagePixels pixels;      ///< of the layers, for a picture that is no page of vector graphics

  /// Returns a page with a picture, and above it the legends that are drawn in the picture.
  Drawing page_of(const Image& picture, float mm_per_pixel) const;
};

/// Returns the legends that the options ask for, in the colour that the background of the recipe needs. `camera`: of
/// the picture without guard band. Errors: those of legends_of.
Result<Legends> make_legends(const RenderOptions& o, const Scene& scene, const Camera& camera, const Recipe& recipe);

/// Writes legends to the file of --legend, if it is given. Errors: kFile.
Result<void> write_legends(const RenderOptions& o, const Legends& legends, const Recipe& recipe);

}  // namespace umbrage::cli
