// Lines, discs, arrows and letters on a picture: what the diagrams and the contact sheet are drawn with. Coordinates
// are pixels from the upper left corner, y downwards; edges are smoothed.
#pragma once
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>

#include "core/image.h"

namespace umbrage {

inline constexpr glm::vec3 kInk{0.15f};
inline constexpr int kLetterHeight = 12;  ///< of a line of text at scale 1

/// A white picture of color.r, color.g, color.b.
Image blank_paper(int width, int height);

void draw_line(Image& image, glm::vec2 from, glm::vec2 to, float width, glm::vec3 color);
/// A line with a head at its end.
void draw_arrow(Image& image, glm::vec2 from, glm::vec2 to, float width, glm::vec3 color);
void draw_disc(Image& image, glm::vec2 center, float radius, glm::vec3 color);
/// Part of a circle, angles in radians from the right, anticlockwise.
void draw_arc(Image& image, glm::vec2 center, float radius, float from_rad, float to_rad, float width, glm::vec3 color);
/// A filled rectangle; its sides lie between pixels.
void fill(Image& image, int x0, int y0, int x1, int y1, glm::vec3 color);

/// Text whose upper left corner is at (x, y); the letters are of ASCII alone.
void write_text(Image& image, int x, int y, int scale, std::string text, glm::vec3 color = kInk);
int text_width(std::string text, int scale);

/// Copies at most `most` rows and columns of a picture to where its upper left corner is to be, each value cut to [0,
/// 1].
void put(Image& image, const Image& picture, int left, int top, int most);

}  // namespace umbrage
