// Pages of vector graphics as pixels and as PDF, by cairo.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "core/drawing.h"
#include "core/image.h"
#include "core/result.h"

namespace umbrage::cli {

/// Returns the width of a text, in the unit of `size`. Errors: kFile if the font is not installed.
Result<float> text_width(std::string_view text, float size);

/// A rectangle of a page as pixels.
struct PagePixels {
  int x = 0, y = 0, width = 0, height = 0;  ///< where it is on the page
  std::vector<std::uint32_t> argb;          ///< sRGB, premultiplied: alpha in the upper 8 bits; width * height
};

/// Returns the pixels that the layers cover on a page of width x height pixels, antialiased. Errors: kFile if the font
/// is not installed; kDevice without memory.
Result<PagePixels> pixels_of(std::span<const DrawnLayer> layers, int width, int height);

/// Returns a picture of display values, color.r, color.g, color.b and, if present, color.a, or rows of it, with pixels
/// drawn over it. `first_row`: row of the page that is the first one of `picture`.
Image drawn_over(Image picture, const PagePixels& pixels, int first_row);

/// Returns a picture with the planes color.r, color.g and color.b, and color.a if present, as a shape that fills the
/// page.
DrawnImage image_of(const Image& picture);

/// Returns the extension of a file of vector graphics in lower case, "svg", "pdf" or "dxf"; empty for other files.
std::string page_extension(const std::filesystem::path& file);
inline bool is_page(const std::filesystem::path& file) { return !page_extension(file).empty(); }

/// Writes a drawing in the format of the file's extension, atomically: a .pdf has one page of the drawing's physical
/// size. Errors: those of write_drawing (io/drawing_file.h); kFile if the font is not installed.
Result<void> write_page(const std::filesystem::path& file, const Drawing& drawing);

}  // namespace umbrage::cli
