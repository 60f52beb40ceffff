#include "renderer/strokes.h"

#include "io/image_file.h"
#include "io/svg.h"
#include "renderer/lines.h"

namespace umbrage {

Result<ParameterBytes> wanted_lines(bool strokes, const Recipe& recipe) {
  return strokes ? line_parameters(recipe) : ParameterBytes();
}

Result<void> add_strokes(Device& device, const Frame& frame, const ParameterBytes& outline_params, Picture& picture) {
  const auto lines = traced_lines(device, frame, outline_params);
  if (!lines) return lines.error();
  for (const Line& line : lines->lines) {
    Stroke& stroke = picture.strokes.emplace_back();
    stroke.kind = StrokeKind(line.kind);
    stroke.object = line.object;
    stroke.closed = line.closed;
    for (const LinePoint& p : line.points) stroke.points.push_back({p.x, p.y, p.width});
  }
  picture.stroke_color = line_color(outline_params);
  picture.stroke_opacity = line_opacity(outline_params);
  return {};
}

Result<void> write_strokes(const Picture& picture, const std::filesystem::path& file) {
  if (!(picture.stroke_opacity > 0.0f))
    return usage_error(
        "there are no strokes to write to '{}': the request is to ask for them, and stroke_opacity above 0",
        file.string());
  if (picture.width < 1 || picture.height < 1)
    return usage_error("there is no picture to write to '{}'", file.string());
  if (auto writable = check_writable(file); !writable) return writable;
  Lines lines{picture.width, picture.height, {}};
  for (const Stroke& stroke : picture.strokes) {
    Line& line = lines.lines.emplace_back();
    line.kind = LineKind(stroke.kind);
    line.object = stroke.object;
    line.closed = stroke.closed;
    for (const StrokePoint& p : stroke.points) line.points.push_back({p.x, p.y, p.width});
  }
  return write_svg(file, lines, {.color = picture.stroke_color, .opacity = picture.stroke_opacity});
}

}  // namespace umbrage
