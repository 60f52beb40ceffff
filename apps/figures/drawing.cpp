#include "apps/figures/drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "apps/figures/figures.h"
#include "stb_easy_font.h"

namespace umbrage {
namespace {

using glm::vec2;
using glm::vec3;

constexpr std::array kChannels = {"color.r", "color.g", "color.b"};

/// Blends a color into the pixels of a shape, with anti-aliased edges. `distance` returns the signed distance of a
/// pixel centre from the shape's edge in pixels, negative inside.
template <class Distance>
void paint(Image& image, vec2 low, vec2 high, vec3 color, const Distance& distance) {
  const int x0 = std::max(0, int(std::floor(low.x)) - 1), x1 = std::min(image.width, int(std::ceil(high.x)) + 2);
  const int y0 = std::max(0, int(std::floor(low.y)) - 1), y1 = std::min(image.height, int(std::ceil(high.y)) + 2);
  for (std::size_t k = 0; k < kChannels.size(); ++k) {
    Plane& plane = image.plane(kChannels[k]);
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) {
        const float cover = std::clamp(0.5f - distance(vec2(float(x) + 0.5f, float(y) + 0.5f)), 0.0f, 1.0f);
        plane.at(x, y) += cover * (color[int(k)] - plane.at(x, y));
      }
  }
}

/// The corners of a rectangle. The font draws letters as rectangles.
struct Box {
  int x0, y0, x1, y1;
};
/// Returns the rectangles of a text.
std::vector<Box> letters(std::string& text) {
  struct Vertex {
    float x, y, z;
    unsigned char color[4];
  };
  std::vector<Vertex> vertices(text.size() * 4 * 20 + 4);  // a letter has at most 20 quads
  const int quads =
      stb_easy_font_print(0, 0, text.data(), nullptr, vertices.data(), int(vertices.size() * sizeof(Vertex)));
  std::vector<Box> boxes;
  for (int q = 0; q < quads; ++q) {
    const Vertex &a = vertices[std::size_t(q) * 4], &c = vertices[std::size_t(q) * 4 + 2];
    boxes.push_back({int(a.x), int(a.y), int(c.x), int(c.y)});
  }
  return boxes;
}

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

Image blank_paper(int width, int height) {
  Image image(width, height);
  for (const char* name : kChannels) image.add(name) = Plane(width, height, 1.0f);
  return image;
}

void draw_line(Image& image, vec2 from, vec2 to, float width, vec3 color) {
  const vec2 along = to - from;
  const float squared = std::max(glm::dot(along, along), 1e-12f);
  paint(image, glm::min(from, to) - width, glm::max(from, to) + width, color, [&](vec2 p) {
    const float t = std::clamp(glm::dot(p - from, along) / squared, 0.0f, 1.0f);
    return glm::length(p - from - t * along) - 0.5f * width;
  });
}

void draw_arrow(Image& image, vec2 from, vec2 to, float width, vec3 color) {
  const float length = glm::length(to - from);
  if (length < 1e-3f) return;
  const vec2 along = (to - from) / length, across(-along.y, along.x);
  const float head = std::min(4.5f * width, length), half = 0.4f * head;
  draw_line(image, from, to - 0.7f * head * along, width, color);
  paint(image, glm::min(to, to - head) - head, glm::max(to, to + head) + head, color, [&](vec2 p) {
    const float back = glm::dot(to - p, along), side = std::abs(glm::dot(p - to, across));
    const float slope = half / head, steep = std::sqrt(1.0f + slope * slope);
    return std::max(back - head, (side - slope * back) / steep);
  });
}

void draw_disc(Image& image, vec2 center, float radius, vec3 color) {
  paint(image, center - radius, center + radius, color, [&](vec2 p) { return glm::length(p - center) - radius; });
}

void draw_arc(Image& image, vec2 center, float radius, float from_rad, float to_rad, float width, vec3 color) {
  const int steps = std::max(2, int(std::ceil(std::abs(to_rad - from_rad) * radius / 3.0f)));
  const auto at = [&](int i) {
    const float angle = from_rad + (to_rad - from_rad) * float(i) / float(steps);
    return center + radius * vec2(std::cos(angle), -std::sin(angle));
  };
  for (int i = 0; i < steps; ++i) draw_line(image, at(i), at(i + 1), width, color);
}

void fill(Image& image, int x0, int y0, int x1, int y1, vec3 color) {
  for (std::size_t k = 0; k < kChannels.size(); ++k)
    for (int y = std::max(y0, 0); y < std::min(y1, image.height); ++y)
      for (int x = std::max(x0, 0); x < std::min(x1, image.width); ++x)
        image.plane(kChannels[k]).at(x, y) = color[int(k)];
}

void write_text(Image& image, int x, int y, int scale, std::string text, vec3 color) {
  for (const Box& box : letters(text))
    fill(image, x + box.x0 * scale, y + box.y0 * scale, x + box.x1 * scale, y + box.y1 * scale, color);
}

int text_width(std::string text, int scale) { return stb_easy_font_width(text.data()) * scale; }

void paste(Image& image, const Image& picture, int left, int top, int max) {
  for (const char* name : kChannels)
    for (int y = 0; y < std::min(max, picture.height); ++y)
      for (int x = 0; x < std::min(max, picture.width); ++x)
        if (left + x >= 0 && left + x < image.width && top + y >= 0 && top + y < image.height)
          image.plane(name).at(left + x, top + y) = std::clamp(picture.plane(name).at(x, y), 0.0f, 1.0f);
}

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
