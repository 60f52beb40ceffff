// All pictures of a paper on one sheet.
#include <algorithm>
#include <array>
#include <cstring>

#include "apps/figures/figures.h"
#include "stb_easy_font.h"

namespace umbrage {
namespace {

constexpr int kGap = 12;        // between pictures, pixels
constexpr int kLetter = 12;     // height of a line of the font, pixels
constexpr int kWideTile = 384;  // from this size on letters are doubled
constexpr float kPaper = 1.0f, kInk = 0.15f;

void fill(Image& sheet, int x0, int y0, int x1, int y1, float value) {
  for (Plane& plane : sheet.planes)
    for (int y = std::max(y0, 0); y < std::min(y1, sheet.height); ++y)
      for (int x = std::max(x0, 0); x < std::min(x1, sheet.width); ++x) plane.at(x, y) = value;
}

void write_text(Image& sheet, int x, int y, int scale, std::string text) {
  struct Vertex {
    float x, y, z;
    unsigned char color[4];
  };
  std::vector<Vertex> vertices(text.size() * 4 * 20 + 4);  // no letter takes more than 20 quads
  const int quads =
      stb_easy_font_print(0, 0, text.data(), nullptr, vertices.data(), int(vertices.size() * sizeof(Vertex)));
  for (int q = 0; q < quads; ++q) {
    const Vertex &a = vertices[std::size_t(q) * 4], &c = vertices[std::size_t(q) * 4 + 2];
    fill(sheet, x + int(a.x) * scale, y + int(a.y) * scale, x + int(c.x) * scale, y + int(c.y) * scale, kInk);
  }
}

/// The tile x tile pixels in the middle, or all where there are fewer.
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
  const int line = kLetter * scale;
  const int row_height = line + tile + line + kGap;
  Image sheet(int(columns) * (tile + kGap) + kGap, int(figures.size()) * row_height + kGap);
  constexpr std::array kChannels = {"color.r", "color.g", "color.b"};
  for (const char* name : kChannels) sheet.add(name);
  fill(sheet, 0, 0, sheet.width, sheet.height, kPaper);
  for (std::size_t r = 0; r < figures.size(); ++r) {
    const int top = kGap + int(r) * row_height;
    write_text(sheet, kGap, top, scale, fmt::format("Figure {}. {}", figures[r].id, figures[r].title));
    for (std::size_t c = 0; c < figures[r].pictures.size(); ++c) {
      const FigurePicture& picture = figures[r].pictures[c];
      const int left = kGap + int(c) * (tile + kGap);
      const Image small = picture.detail ? middle(picture.image, tile)
                                         : downsample(picture.image, std::max(1, picture.image.width / tile));
      for (const char* name : kChannels)
        for (int y = 0; y < std::min(tile, small.height); ++y)
          for (int x = 0; x < std::min(tile, small.width); ++x)
            sheet.plane(name).at(left + x, top + line + y) = std::clamp(small.plane(name).at(x, y), 0.0f, 1.0f);
      write_text(sheet, left, top + line + tile + 4, scale,
                 picture.caption + (picture.detail ? " (middle, unscaled)" : ""));
    }
  }
  return sheet;
}

}  // namespace umbrage
