// Draws lines, discs, arrows and text into an image, for the diagrams and the contact sheet. Coordinates are pixels
// from the upper left corner, y downwards. Edges are anti-aliased.
#pragma once
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>

#include "core/image.h"

namespace umbrage {

inline constexpr glm::vec3 kInk{0.15f};
inline constexpr int kLetterHeight = 12;  ///< height of a line of text at scale 1, pixels

/// Returns a white image with planes color.r, color.g, color.b.
Image blank_paper(int width, int height);

void draw_line(Image& image, glm::vec2 from, glm::vec2 to, float width, glm::vec3 color);
/// Draws a line with an arrowhead at `to`.
void draw_arrow(Image& image, glm::vec2 from, glm::vec2 to, float width, glm::vec3 color);
void draw_disc(Image& image, glm::vec2 center, float radius, glm::vec3 color);
/// Draws a circular arc. Angles are counterclockwise from the positive x axis.
void draw_arc(Image& image, glm::vec2 center, float radius, float from_rad, float to_rad, float width, glm::vec3 color);
/// Fills the pixels [x0, x1) x [y0, y1).
void fill(Image& image, int x0, int y0, int x1, int y1, glm::vec3 color);

/// Draws ASCII text with its upper left corner at (x, y).
void write_text(Image& image, int x, int y, int scale, std::string text, glm::vec3 color = kInk);
int text_width(std::string text, int scale);

/// Copies at most `max` rows and columns of a picture to (left, top), with values clamped to [0, 1].
void paste(Image& image, const Image& picture, int left, int top, int max);

}  // namespace umbrage
