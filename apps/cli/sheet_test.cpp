// Tests of sheets of views: places, sizes and scale of the views of a box, files, and what is refused.
#include <algorithm>

#include "run_program.h"

namespace umbrage::test {
namespace {

/// Pixels from begin to end, exclusive.
struct Extent {
  int begin = 0, end = 0;
  int size() const { return end - begin; }
};

class Sheet : public ProgramTest {
 protected:
  /// Writes a box of 4 x 2 x 1 around a point that is not the origin: y is up, so its front is 4 x 2.
  void SetUp() override {
    ProgramTest::SetUp();
    std::string text;
    for (int k = 0; k < 8; ++k) text += fmt::format("v {} {} {}\n", k & 1 ? 7 : 3, k & 2 ? 12 : 10, k & 4 ? -4 : -5);
    write("box.obj", text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
  }

  /// Returns whether a pixel of out.png shows the red model.
  static bool is_model(const Image& sheet, int x, int y) {
    return sheet.plane("color.r").at(x, y) - sheet.plane("color.g").at(x, y) > 0.15f;
  }
  static std::vector<Extent> runs(int count, const std::function<bool(int)>& is_set) {
    std::vector<Extent> runs;
    for (int k = 0; k < count; ++k)
      if (is_set(k)) {
        if (runs.empty() || runs.back().end < k) runs.push_back({k, k});
        runs.back().end = k + 1;
      }
    return runs;
  }
  /// Returns the rows with views, and the views in each: their columns.
  static std::vector<std::pair<Extent, std::vector<Extent>>> views_in(const Image& sheet) {
    std::vector<std::pair<Extent, std::vector<Extent>>> found;
    for (const Extent& rows : runs(sheet.height, [&](int y) {
           for (int x = 0; x < sheet.width; ++x)
             if (is_model(sheet, x, y)) return true;
           return false;
         }))
      found.emplace_back(rows, runs(sheet.width, [&](int x) {
                           for (int y = rows.begin; y < rows.end; ++y)
                             if (is_model(sheet, x, y)) return true;
                           return false;
                         }));
    return found;
  }
};

const std::string kRed = "box.obj --look lit --color red --resolution 400x300 --views front,top,right ";

TEST_F(Sheet, ViewsAreAlignedAtOneScale) {
  for (const bool first_angle : {false, true}) {
    SCOPED_TRACE(first_angle);
    good(kRed + (first_angle ? "--projection first -o out.png" : "-o out.png"));
    auto rows = views_in(image("out.png"));
    ASSERT_EQ(rows.size(), 2u);
    // In third-angle projection the top view is above the front and the right one to the right; else the other way.
    if (first_angle) std::swap(rows[0], rows[1]);
    ASSERT_EQ(rows[0].second.size(), 1u);
    ASSERT_EQ(rows[1].second.size(), 2u);
    const Extent top_x = rows[0].second[0], front_x = rows[1].second[first_angle ? 1 : 0];
    const Extent right_x = rows[1].second[first_angle ? 0 : 1];
    EXPECT_NEAR(front_x.begin, top_x.begin, 1);
    EXPECT_NEAR(front_x.end, top_x.end, 1);
    const double scale = front_x.size() / 4.0;
    EXPECT_GT(scale, 20.0);
    EXPECT_NEAR(rows[0].first.size(), 1.0 * scale, 2.0);
    EXPECT_NEAR(rows[1].first.size(), 2.0 * scale, 2.0);
    EXPECT_NEAR(right_x.size(), 1.0 * scale, 2.0);
  }
}

TEST_F(Sheet, HasAStandardScaleOnPaper) {
  // 4 units of 10 mm at 2:1 are 80 mm, which are 315 pixels at 100 dpi.
  const std::string line =
      "box.obj --color red --look lit --views front --print-size 120,80 --dpi 100 --length-unit cm -o ";
  good(line + "out.png");
  const auto rows = views_in(image("out.png"));
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_NEAR(rows[0].second[0].size(), 80.0 / 25.4 * 100.0, 2.0);
  good(line + "out.pdf");
  ASSERT_EQ(std::system(fmt::format("cd {} && pdftotext out.pdf out.txt", quoted(folder_.string())).c_str()), 0);
  EXPECT_NE(text_of(folder_ / "out.txt").find("scale 2:1"), std::string::npos) << text_of(folder_ / "out.txt");
}

TEST_F(Sheet, LinesOfAllViewsAreOnOnePage) {
  good("box.obj --views front,top,right,iso --resolution 800x600 -o out.svg");
  const std::string svg = text_of(folder_ / "out.svg");
  for (const char* name : {">front<", ">top<", ">right<", ">iso<"})
    EXPECT_NE(svg.find(name), std::string::npos) << name;
  EXPECT_EQ(svg.find("<image"), std::string::npos);
  ASSERT_EQ(
      std::system(fmt::format("cd {} && rsvg-convert -b white out.svg -o svg.png", quoted(folder_.string())).c_str()),
      0);
  const Image page = image("svg.png");
  int dark = 0;
  for (int y = 0; y < page.height; ++y)
    for (int x = 0; x < page.width; ++x) dark += page.plane("color.g").at(x, y) < 0.5f;
  EXPECT_GT(dark, 2000);
}

TEST_F(Sheet, WrongOptionsAreRefused) {
  const std::pair<const char*, const char*> cases[] = {
      {"--views front,above", "front, back, left, right, top, bottom, iso"},
      {"--views front,front", "twice"},
      {"--views front --camera-azimuth-angle 30", "leave out its other options"},
      {"--views front --turntable 4", "--turntable"},
      {"--views front --passes depth", "--passes"},
      {"--views front --axes", "--axes"},
      {"--views front --projection second", "first or third"},
      {"--projection first", "--views"},
      {"--views front,back,left,right,top --resolution 32", "too small"},
      {"--views front --camera-view-angle 20", "leave out its other options"},
      {"--views front --look cartoon --svg b.svg", "--svg"},
      {"--views front --resolution 4000 --memory 20M", "--memory"},
  };
  for (const auto& [words, sentence] : cases) bad(std::string("box.obj -o out.png ") + words, 2, {sentence});
}

TEST_F(Sheet, HasTheBackgroundOfAStyle) {
  bad("box.obj --views front --same-view -o {stem}.png", 2, {"--same-view"});
  bad("box.obj --views front -o out.exr", 2, {".png, .svg or .pdf"});
  good("box.obj --look cartoon --views front,top --style dark --resolution 400x300 -o out.svg");
  ASSERT_EQ(std::system(fmt::format("cd {} && rsvg-convert out.svg -o svg.png", quoted(folder_.string())).c_str()), 0);
  const Image page = image("svg.png");
  EXPECT_LT(page.plane("color.g").at(5, 5), 0.4f);
  float max = 0.0f;
  for (int y = 0; y < page.height; ++y)
    for (int x = 0; x < page.width; ++x) max = std::max(max, page.plane("color.g").at(x, y));
  EXPECT_GT(max, 0.7f);  // lines and names
}

}  // namespace
}  // namespace umbrage::test
