// The contact sheet: all pictures of a paper in one image.
#include <algorithm>

#include "apps/figures/drawing.h"
#include "apps/figures/figures.h"

namespace umbrage {
namespace {

constexpr int kGap = 12;        // between pictures, pixels
constexpr int kWideTile = 384;  // min tile size at which the text is drawn at scale 2

/// Returns the tile x tile pixels in the middle; the whole image if it is smaller.
Image middle(const Image& image, int tile) {
  Image part(std::min(tile, image.width), std::min(tile, image.height));
  const int left = (image.width - part.width) / 2, top = (image.height - part.height) / 2;
  for (const std::string& name : image.names) {
    Plane& plane = part.add(name);
    for (int y = 0; y < part.height; ++y)
      for (int x = 0; x < part.width; ++x) plane.at(x, y) = image.plane(name).at(left + x, top + y);
  }
  return part;
}

}  // namespace

Image contact_sheet(const std::vector<Figure>& figures, int tile) {
  std::size_t columns = 1;
  for (const Figure& figure : figures) columns = std::max(columns, figure.pictures.size());
  const int scale = tile < kWideTile ? 1 : 2;
  const int line = kLetterHeight * scale;
  const int row_height = line + tile + line + kGap;
  Image sheet = blank_paper(int(columns) * (tile + kGap) + kGap, int(figures.size()) * row_height + kGap);
  for (std::size_t r = 0; r < figures.size(); ++r) {
    const int top = kGap + int(r) * row_height;
    write_text(sheet, kGap, top, scale, fmt::format("Figure {}. {}", figures[r].id, figures[r].title));
    for (std::size_t c = 0; c < figures[r].pictures.size(); ++c) {
      const FigurePicture& picture = figures[r].pictures[c];
      const int left = kGap + int(c) * (tile + kGap);
      const Image small = picture.detail ? middle(picture.image, tile)
                                         : downsample(picture.image, std::max(1, picture.image.width / tile));
      paste(sheet, small, left, top + line, tile);
      write_text(sheet, left, top + line + tile + 4, scale,
                 picture.caption + (picture.detail ? " (middle, unscaled)" : ""));
    }
  }
  return sheet;
}

}  // namespace umbrage
