// Lines of a picture as an .svg file: -o lines.svg, alone, or --svg lines.svg, beside the picture.
#pragma once
#include <string>

#include "apps/cli/frame_names.h"
#include "apps/cli/render_options.h"
#include "core/lines.h"
#include "io/svg.h"

namespace umbrage::cli {

/// Where the lines go.
struct LineFile {
  std::string file;       ///< empty: nowhere
  bool alone = false;     ///< there is no other file
  FrameNames names;       ///< of a turntable's frames
  ParameterBytes params;  ///< of `outline`
  SvgStyle style;

  explicit operator bool() const { return !file.empty(); }
};

/// Lines alone are those of `cartoon`, unless --look was given.
void choose_line_look(RenderOptions& o);

/// Checked before the model is read. `frames`: of a turntable; 0: there is none. Errors: kUsage; kFile for one that
/// cannot be written.
Result<LineFile> line_file_of(const RenderOptions& o, int frames);

/// The same of what the recipe says. Errors: kUsage where it draws no lines that are curves.
Result<void> take_recipe(const RenderOptions& o, const Recipe& recipe, LineFile& lines);

/// What else a picture has takes no time where lines are all that is written: they do not depend on it.
void draw_lines_alone(Request& request);

/// Traces and writes the lines of a frame, or those that there are of a picture in bands. Errors: kFile; those of
/// Device::download.
Result<void> write_lines(const LineFile& lines, int frame_number, Device& device, const Frame& frame);
Result<void> write_lines(const LineFile& lines, const Lines& traced);

}  // namespace umbrage::cli
