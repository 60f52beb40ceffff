// Sheets of views: orthographic views of a model on one page, aligned and at one scale, after ISO 128-3 and ISO 5456-2.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "apps/cli/render_frames.h"

namespace CLI {
class App;
}

namespace umbrage::cli {

/// A named view of a model: the direction from the model to the camera, and what is up in the picture. Unit vectors.
struct NamedView {
  std::string_view name;
  glm::vec3 towards_camera, up;
  int column, row;  ///< place on a sheet in third-angle projection; the front is at 0, 0, rows go down
};

/// Returns the views front, back, left, right, top, bottom and iso of models with this up direction. The front is the
/// side that faces +z, or -y where z is up.
std::vector<NamedView> named_views(const glm::vec3& up);

/// Where views are on a page, and their scale.
struct SheetLayout {
  struct Cell {
    int x = 0, y = 0, width = 0, height = 0;                     ///< pixels; width and height are even
    float left = 0.0f, right = 0.0f, bottom = 0.0f, top = 0.0f;  ///< extent of the model, scene units
  };
  std::vector<Cell> cells;  ///< one per view
  double pixels_per_unit = 0.0;
  std::string scale;  ///< "1:2"; empty if the unit of the model or the size of the page is not known
};

/// How a sheet is laid out.
struct SheetSettings {
  bool first_angle = false;
  int width = 0, height = 0;  ///< of the page, pixels
  float font = 0.0f;          ///< size of the font, pixels
  double mm_per_pixel = 0.0;  ///< 0: not known
  double mm_per_unit = 0.0;   ///< of the model's unit; 0: not known
};

/// Returns the layout of views. If both units are known the scale is 1, 2 or 5 times a power of ten to 1, or 1 to that
/// [ISO 5455]; else the views fill the page. Errors: kUsage if the page is too small, and for models without extent.
Result<SheetLayout> layout_of(const Scene& scene, const std::vector<NamedView>& views, const SheetSettings& settings);

/// Adds --views and --projection to the group Figure.
void add_sheet_options(CLI::App& command, RenderOptions& options);

/// Sets what follows from --views: parallel projection, a white background and no ground, unless they are given.
/// Errors: kUsage for unknown views, and for options of the camera.
Result<void> apply_sheet_options(RenderOptions& o);

/// Draws the views of a prepared scene and writes the sheet. Changes the views of the scene. Errors: kUsage; kFile;
/// those of the device.
Result<void> draw_sheet(const RenderOptions& o, const RenderJob& job, Device& device, Scene& scene, StageTimes& times);

}  // namespace umbrage::cli
