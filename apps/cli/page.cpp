#include "apps/cli/page.h"

#include <cairo/cairo-ft.h>
#include <cairo/cairo-pdf.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "io/drawing_file.h"
#include "io/format.h"
#include "system/child_process.h"

namespace umbrage::cli {
namespace {

/// The font of Debian's package fonts-dejavu-core, or that of an archive.
struct Font {
  FT_Library library = nullptr;
  FT_Face face = nullptr;
  cairo_font_face_t* cairo = nullptr;
};

/// Returns the font, which is opened once and kept, or null if it is not installed.
cairo_font_face_t* font() {
  static const Font font = [] {
    Font opened;
    if (FT_Init_FreeType(&opened.library)) return opened;
    const std::string own = find_helper("DejaVuSans.ttf").string();
    for (const char* file : {own.c_str(), "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"})
      if (!opened.face && *file && FT_New_Face(opened.library, file, 0, &opened.face)) opened.face = nullptr;
    if (opened.face) opened.cairo = cairo_ft_font_face_create_for_ft_face(opened.face, 0);
    return opened;
  }();
  return font.cairo;
}

Error no_font() {
  return file_error("texts need the font {}, which is not installed: install Debian's package fonts-dejavu-core",
                    kFontFamily);
}

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

void set_color(cairo_t* c, const DrawnColor& color) { cairo_set_source_rgb(c, color[0], color[1], color[2]); }

/// Adds an arc of a circle from the current point.
void add_arc(cairo_t* c, const DrawnSegment& to) {
  double x0 = 0.0, y0 = 0.0;
  cairo_get_current_point(c, &x0, &y0);
  const double dx = to.x - x0, dy = to.y - y0, chord = std::hypot(dx, dy);
  if (chord == 0.0) return;
  const double radius = std::max(double(to.radius), 0.5 * chord);
  // The centre lies on the perpendicular bisector of the chord, on the side that gives the arc its length and sense.
  const double side = to.large_arc == to.clockwise ? 1.0 : -1.0;
  const double height = side * std::sqrt(std::max(0.0, radius * radius - 0.25 * chord * chord)) / chord;
  const double cx = 0.5 * (x0 + to.x) + height * dy, cy = 0.5 * (y0 + to.y) - height * dx;
  const double from = std::atan2(y0 - cy, x0 - cx), end = std::atan2(to.y - cy, to.x - cx);
  // On a page y points down, where cairo's positive angles are clockwise.
  if (to.clockwise)
    cairo_arc(c, cx, cy, radius, from, end);
  else
    cairo_arc_negative(c, cx, cy, radius, from, end);
}

void add_outline(cairo_t* c, const DrawnPath& path) {
  cairo_move_to(c, path.x, path.y);
  for (const DrawnSegment& to : path.segments)
    if (to.radius > 0.0f)
      add_arc(c, to);
    else
      cairo_line_to(c, to.x, to.y);
  if (path.closed) cairo_close_path(c);
  for (const DrawnPath& hole : path.holes) add_outline(c, hole);
}

void draw(cairo_t* c, const DrawnPath& path) {
  cairo_new_path(c);
  add_outline(c, path);
  cairo_set_fill_rule(c, CAIRO_FILL_RULE_WINDING);
  if (path.fill) {
    set_color(c, *path.fill);
    cairo_fill_preserve(c);
  }
  if (!path.stroke) return;
  set_color(c, *path.stroke);
  cairo_set_line_width(c, path.width);
  cairo_set_line_join(c, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(c, path.round ? CAIRO_LINE_CAP_ROUND : CAIRO_LINE_CAP_BUTT);
  const std::vector<double> dashes(path.dashes.begin(), path.dashes.end());
  cairo_set_dash(c, dashes.data(), int(dashes.size()), 0.0);
  cairo_stroke(c);
}

/// Sets the font. Outlines are not hinted, so that a text has the same width at all sizes.
void set_font(cairo_t* c, float size) {
  cairo_font_options_t* options = cairo_font_options_create();
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_set_font_options(c, options);
  cairo_font_options_destroy(options);
  cairo_set_font_face(c, font());
  cairo_set_font_size(c, size);
}

double width_of(cairo_t* c, const std::string& text) {
  cairo_text_extents_t extents{};
  cairo_text_extents(c, text.c_str(), &extents);
  return extents.x_advance;
}

void draw(cairo_t* c, const DrawnText& text) {
  if (!font()) return;
  set_font(c, text.size);
  const double before = text.anchor == TextAnchor::kStart ? 0.0 : text.anchor == TextAnchor::kMiddle ? 0.5 : 1.0;
  cairo_save(c);
  cairo_translate(c, text.x, text.y);
  if (text.upwards) cairo_rotate(c, -0.5 * std::numbers::pi);
  cairo_move_to(c, -before * width_of(c, text.text), 0.0);
  set_color(c, text.color);
  cairo_show_text(c, text.text.c_str());
  cairo_restore(c);
}

/// Returns a colour of 8 bits per channel, premultiplied.
std::uint32_t premultiplied(const std::uint8_t* rgba) {
  const std::uint32_t a = rgba[3];
  const auto times = [a](std::uint32_t v) { return (v * a + 127) / 255; };
  return a << 24 | times(rgba[0]) << 16 | times(rgba[1]) << 8 | times(rgba[2]);
}

void draw(cairo_t* c, const DrawnImage& image) {
  const Surface pixels(cairo_image_surface_create(CAIRO_FORMAT_ARGB32, image.columns, image.rows),
                       cairo_surface_destroy);
  if (cairo_surface_status(pixels.get()) != CAIRO_STATUS_SUCCESS)
    return cairo_set_source_surface(c, pixels.get(), 0.0, 0.0);  // its error becomes that of the page
  unsigned char* bytes = cairo_image_surface_get_data(pixels.get());
  const int stride = cairo_image_surface_get_stride(pixels.get());
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.columns; ++x) {
      const std::size_t at = std::size_t(y) * std::size_t(image.columns) + std::size_t(x);
      const std::uint32_t value = premultiplied(&image.rgba[4 * at]);
      std::memcpy(bytes + std::size_t(y) * std::size_t(stride) + 4 * std::size_t(x), &value, sizeof value);
    }
  cairo_surface_mark_dirty(pixels.get());
  cairo_save(c);
  cairo_translate(c, image.x, image.y);
  cairo_scale(c, image.width / image.columns, image.height / image.rows);
  cairo_set_source_surface(c, pixels.get(), 0.0, 0.0);
  cairo_pattern_set_extend(cairo_get_source(c), CAIRO_EXTEND_PAD);
  cairo_pattern_set_filter(cairo_get_source(c), CAIRO_FILTER_BILINEAR);
  cairo_rectangle(c, 0.0, 0.0, image.columns, image.rows);
  cairo_fill(c);
  cairo_restore(c);
}

void draw(cairo_t* c, std::span<const DrawnLayer> layers) {
  for (const DrawnLayer& layer : layers) {
    const bool grouped = layer.opacity < 1.0f;
    if (grouped) cairo_push_group(c);
    for (const DrawnShape& shape : layer.shapes) std::visit([c](const auto& each) { draw(c, each); }, shape);
    if (!grouped) continue;
    cairo_pop_group_to_source(c);
    cairo_paint_with_alpha(c, layer.opacity);
  }
}

bool has_text(std::span<const DrawnLayer> layers) {
  return std::any_of(layers.begin(), layers.end(), [](const DrawnLayer& layer) {
    return std::any_of(layer.shapes.begin(), layer.shapes.end(),
                       [](const DrawnShape& shape) { return std::holds_alternative<DrawnText>(shape); });
  });
}

cairo_status_t append(void* stream, const unsigned char* data, unsigned length) {
  const bool written = std::fwrite(data, 1, length, static_cast<std::FILE*>(stream)) == length;
  return written ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
}

Result<void> write_pdf(const std::filesystem::path& file, const Drawing& drawing) {
  if (has_text(drawing.layers) && !font()) return no_font();
  constexpr double kPointsPerMm = 72.0 / 25.4;
  const double scale = kPointsPerMm * drawing.mm_per_unit;
  return write_atomically(file, [&](std::FILE* stream) -> Result<void> {
    const Surface page(
        cairo_pdf_surface_create_for_stream(append, stream, scale * drawing.width, scale * drawing.height),
        cairo_surface_destroy);
    const Context context(cairo_create(page.get()), cairo_destroy);
    cairo_scale(context.get(), scale, scale);
    if (drawing.background) {
      set_color(context.get(), *drawing.background);
      cairo_paint(context.get());
    }
    draw(context.get(), drawing.layers);
    cairo_show_page(context.get());
    cairo_surface_finish(page.get());
    for (const auto status : {cairo_status(context.get()), cairo_surface_status(page.get())})
      if (status != CAIRO_STATUS_SUCCESS)
        return file_error("'{}' cannot be written: {}", file.string(), cairo_status_to_string(status));
    return {};
  });
}

}  // namespace

std::string page_extension(const std::filesystem::path& file) {
  return lowercase_extension(file) == "pdf" ? "pdf" : drawing_extension(file);
}

Result<void> write_page(const std::filesystem::path& file, const Drawing& drawing) {
  return page_extension(file) == "pdf" ? write_pdf(file, drawing) : write_drawing(file, drawing);
}

Result<float> text_width(std::string_view text, float size) {
  if (!font()) return no_font();
  const Surface none(cairo_recording_surface_create(CAIRO_CONTENT_COLOR_ALPHA, nullptr), cairo_surface_destroy);
  const Context context(cairo_create(none.get()), cairo_destroy);
  set_font(context.get(), size);
  return float(width_of(context.get(), std::string(text)));
}

Result<PagePixels> pixels_of(std::span<const DrawnLayer> layers, int width, int height) {
  if (has_text(layers) && !font()) return no_font();
  const Surface recorded(cairo_recording_surface_create(CAIRO_CONTENT_COLOR_ALPHA, nullptr), cairo_surface_destroy);
  {
    const Context context(cairo_create(recorded.get()), cairo_destroy);
    draw(context.get(), layers);
  }
  double x = 0.0, y = 0.0, w = 0.0, h = 0.0;
  cairo_recording_surface_ink_extents(recorded.get(), &x, &y, &w, &h);
  const auto inside = [](double v, int size) { return int(std::clamp(v, 0.0, double(size))); };
  PagePixels pixels{inside(std::floor(x), width), inside(std::floor(y), height), 0, 0, {}};
  pixels.width = inside(std::ceil(x + w), width) - pixels.x;
  pixels.height = inside(std::ceil(y + h), height) - pixels.y;
  if (pixels.width <= 0 || pixels.height <= 0) return PagePixels();
  pixels.argb.resize(std::size_t(pixels.width) * std::size_t(pixels.height));
  const Surface image(
      cairo_image_surface_create_for_data(reinterpret_cast<unsigned char*>(pixels.argb.data()), CAIRO_FORMAT_ARGB32,
                                          pixels.width, pixels.height, 4 * pixels.width),
      cairo_surface_destroy);
  const Context context(cairo_create(image.get()), cairo_destroy);
  cairo_translate(context.get(), -pixels.x, -pixels.y);
  draw(context.get(), layers);
  cairo_surface_flush(image.get());
  if (const auto status = cairo_status(context.get()); status != CAIRO_STATUS_SUCCESS)
    return device_error("the legend cannot be drawn: {}", cairo_status_to_string(status));
  return pixels;
}

Image drawn_over(Image picture, const PagePixels& pixels, int first_row) {
  const int begin = std::max(pixels.y, first_row), end = std::min(pixels.y + pixels.height, first_row + picture.height);
  if (begin >= end) return picture;
  for (Plane& plane : picture.planes) plane = Plane(std::as_const(plane));  // a view does not own its pixels
  Plane* alpha = picture.find("color.a");
  const std::array<Plane*, 3> color = {&picture.plane("color.r"), &picture.plane("color.g"), &picture.plane("color.b")};
  for (int y = begin; y < end; ++y)
    for (int x = pixels.x; x < std::min(pixels.x + pixels.width, picture.width); ++x) {
      const std::uint32_t argb =
          pixels.argb[std::size_t(y - pixels.y) * std::size_t(pixels.width) + std::size_t(x - pixels.x)];
      if (argb == 0) continue;
      const float over = float(argb >> 24) / 255.0f;
      const float below = (1.0f - over) * (alpha ? alpha->row(y - first_row)[x] : 1.0f), sum = over + below;
      for (int k = 0; k < 3; ++k) {
        float& value = color[std::size_t(k)]->row(y - first_row)[x];
        value = (float(argb >> (16 - 8 * k) & 255U) / 255.0f + below * value) / sum;
      }
      if (alpha) alpha->row(y - first_row)[x] = sum;
    }
  return picture;
}

DrawnImage image_of(const Image& picture) {
  DrawnImage image{
      .width = float(picture.width),
      .height = float(picture.height),
      .columns = picture.width,
      .rows = picture.height,
      .rgba = std::vector<std::uint8_t>(4 * std::size_t(picture.width) * std::size_t(picture.height), 255)};
  std::vector<const Plane*> planes = {&picture.plane("color.r"), &picture.plane("color.g"), &picture.plane("color.b")};
  if (const Plane* alpha = picture.find("color.a")) planes.push_back(alpha);
  std::vector<std::uint8_t> row(planes.size() * std::size_t(picture.width));
  for (int y = 0; y < picture.height; ++y) {
    bytes_of_row(planes, y, row.data());
    for (std::size_t x = 0; x < std::size_t(picture.width); ++x)
      std::copy_n(&row[planes.size() * x], planes.size(),
                  &image.rgba[4 * (std::size_t(y) * std::size_t(picture.width) + x)]);
  }
  return image;
}

}  // namespace umbrage::cli
