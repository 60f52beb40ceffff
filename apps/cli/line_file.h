// The lines of a picture as a .svg or .dxf file: -o lines.svg (lines alone) or --svg lines.svg (in addition to the
// picture).
#pragma once
#include <optional>
#include <string>

#include "apps/cli/frame_names.h"
#include "apps/cli/render_options.h"
#include "core/camera.h"
#include "core/strokes.h"
#include "io/drawing_of_strokes.h"
#include "io/filled_regions.h"
#include "renderer/strokes.h"

namespace umbrage::cli {

/// The file that receives the lines, and their style.
struct LineFile {
  std::string file;         ///< empty: no lines are written
  bool alone = false;       ///< the lines are the only output
  FrameNames names;         ///< file names of a turntable's frames
  StrokeParameters params;  ///< parameters of the effects that draw lines
  LineStyle style;
  std::optional<FillBy> fill;  ///< of the areas below the lines
  float mm_per_pixel = 0.0f;   ///< physical size

  explicit operator bool() const { return !file.empty(); }
};

/// Selects the look `cartoon` if lines alone are written and --look is not given.
void choose_line_look(RenderOptions& o);

/// Returns the line file of the options, checked before the model is read. `frames`: number of frames of a turntable;
/// 0: no turntable. Errors: kUsage; kFile for a file that cannot be written.
Result<LineFile> line_file_of(const RenderOptions& o, int frames);

/// Fills in the parameters and style from the recipe. Errors: kUsage if the recipe draws no lines that can be
/// written as curves.
Result<void> set_line_parameters(const RenderOptions& o, const Recipe& recipe, LineFile& lines);

/// Turns off anti-aliasing and occlusion, on which lines do not depend, when only lines are written. Occlusion stays on
/// if its radius is given, since the hint about the radius needs it, for hatching, which draws it, and for tones of
/// fills.
void disable_unused_effects(const LineFile& lines, Request& request);

/// Returns the planes of a frame that fills need.
std::vector<std::string_view> fill_planes(const LineFile& lines);

/// Traces the lines of a frame that was drawn without them, and its areas. Errors: those of drawing_of and
/// Device::download.
Result<Drawing> drawing_of_frame(const LineFile& lines, Device& device, const Frame& frame);

/// Warns of pictures on a page that a .dxf file leaves out.
void warn_of_pictures(const std::string& file, const Drawing& page);

/// Prints a note if the lines have no scale that can be measured in their file.
void print_line_notes(const LineFile& lines, const Camera& camera);

/// Traces the lines of a frame and writes them, with the legends if they are the only output. In parallel projection a
/// .dxf file is in the units of the scene, else in millimetres of a picture with 96 pixels per inch. Errors: kFile;
/// those of Device::download.
Result<void> write_lines(const LineFile& lines, int frame_number, Device& device, const Frame& frame,
                         const Legends& legends);
/// Writes lines that were traced while a picture of this camera was drawn in strips. Errors: kFile.
Result<void> write_lines(const LineFile& lines, const Strokes& traced, const Camera& camera, const Legends& legends);

}  // namespace umbrage::cli
