// Drawing: a page of vector graphics, which SVG, PDF and DXF files hold. Lengths are in units of the page, pixels of
// the picture, from its upper left corner: x to the right, y down. Colours are sRGB, 0 to 1.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace umbrage {

using DrawnColor = std::array<float, 3>;

inline constexpr float kMmPerCssPixel = 25.4f / 96.0f;          ///< 96 pixels of a screen are an inch
inline constexpr std::string_view kFontFamily = "DejaVu Sans";  ///< of all texts; in SVG sans-serif where it is missing

/// A part of a path, from the end of the part before it.
struct DrawnSegment {
  float x = 0.0f, y = 0.0f;  ///< where it ends
  float radius = 0.0f;       ///< of a circular arc; 0: a straight line
  bool large_arc = false;    ///< the arc is longer than half a circle
  bool clockwise = false;    ///< on the page
};

/// A line or an area. The last segment of a closed path ends where the path starts.
struct DrawnPath {
  float x = 0.0f, y = 0.0f;  ///< where it starts
  std::vector<DrawnSegment> segments;
  bool closed = false;
  std::optional<DrawnColor> stroke, fill;  ///< areas are filled by the non-zero rule
  float width = 1.0f;                      ///< of the stroke
  bool round = true;                       ///< ends of the stroke; joins are always round
  std::vector<float> dashes;               ///< lengths of dashes and gaps in turn; empty: solid
  std::vector<DrawnPath> holes = {};       ///< of an area: further closed outlines, which run the other way round
};

enum class TextAnchor { kStart, kMiddle, kEnd };

/// A line of text.
struct DrawnText {
  float x = 0.0f, y = 0.0f;  ///< the anchor, on the baseline
  float size = 12.0f;        ///< of the font
  TextAnchor anchor = TextAnchor::kStart;
  bool upwards = false;  ///< it runs from bottom to top
  DrawnColor color{};
  std::string text;  ///< UTF-8
};

/// A picture in the drawing.
struct DrawnImage {
  float x = 0.0f, y = 0.0f, width = 0.0f, height = 0.0f;  ///< where it is
  int columns = 0, rows = 0;                              ///< its own size, pixels
  std::vector<std::uint8_t> rgba;                         ///< sRGB, alpha not premultiplied; row 0 is at the top
};

using DrawnShape = std::variant<DrawnPath, DrawnText, DrawnImage>;

/// Shapes that belong together: a group of an SVG file, a layer of a DXF file. Later layers and shapes are on top.
/// Successive layers of one opacity are blended as one: where they overlap they are not darker.
struct DrawnLayer {
  std::string name;      ///< "outline", "hidden", "color-bar"
  int object = -1;       ///< object id, or -1
  float opacity = 1.0f;  ///< of all its shapes as a group
  std::vector<DrawnShape> shapes;
};

struct Drawing {
  float width = 0.0f, height = 0.0f;
  float mm_per_unit = kMmPerCssPixel;  ///< physical size
  std::optional<DrawnColor> background;
  std::vector<DrawnLayer> layers;
};

}  // namespace umbrage
