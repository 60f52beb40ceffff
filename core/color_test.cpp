// Colours by name and in hexadecimal notation.
#include "core/color.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace umbrage {
namespace {

using Color = std::array<float, 3>;

TEST(ColorNames, AreThoseOfCss) {
  EXPECT_EQ(color_names().size(), 148u);
  EXPECT_TRUE(std::is_sorted(color_names().begin(), color_names().end()));
  std::set<std::string_view> names(color_names().begin(), color_names().end());
  EXPECT_EQ(names.size(), 148u);
  for (const std::string_view name : color_names()) EXPECT_TRUE(named_color(name)) << name;
  EXPECT_EQ(named_color("white"), (Color{1, 1, 1}));
  EXPECT_EQ(named_color("Red"), (Color{1, 0, 0}));
  EXPECT_EQ(named_color("rebeccapurple"), (Color{0x66 / 255.0f, 0x33 / 255.0f, 0x99 / 255.0f}));
  EXPECT_EQ(named_color("yellowgreen"), (Color{0x9a / 255.0f, 0xcd / 255.0f, 0x32 / 255.0f}));
  for (const auto& [grey, gray] : {std::pair("grey", "gray"), {"darkslategrey", "darkslategray"}, {"cyan", "aqua"}})
    EXPECT_EQ(named_color(grey), named_color(gray));
}

TEST(ColorNames, HexadecimalNotationHasThreeOrSixDigits) {
  EXPECT_EQ(named_color("#ff8000"), (Color{1, 128 / 255.0f, 0}));
  EXPECT_EQ(named_color("#F80"), (Color{1, 0x88 / 255.0f, 0}));
  EXPECT_EQ(named_color("#000000"), (Color{0, 0, 0}));
  for (const char* wrong : {"", "#", "#12", "#1234", "#12345", "#1234567", "#gg0000", "#-12345", "#+1f", "ff8000",
                            "whit", "white ", "0,0,0"})
    EXPECT_FALSE(named_color(wrong)) << wrong;
}

}  // namespace
}  // namespace umbrage
