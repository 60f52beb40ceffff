// Drawings as .dxf files, read back with ezdxf.
#include "io/dxf.h"

#include <map>

#include "run_program.h"
#include "support.h"

namespace umbrage {
namespace {

class DxfTest : public test::ProgramTest {
 protected:
  /// Returns the entities of a .dxf file as ezdxf reads them, one a line: type, layer, line type and numbers; in the
  /// end the extents. Fails if ezdxf reports an error.
  std::string entities(const std::string& file) {
    write("read.py", R"(
import sys, ezdxf
from ezdxf.lldxf.encoding import decode_dxf_unicode
drawing = ezdxf.readfile(sys.argv[1])
assert drawing.dxfversion == "AC1009" and not drawing.audit().errors
assert {"visible", "hidden", "section", "hatch"} <= {layer.dxf.name for layer in drawing.layers}
assert drawing.layers.get("hidden").dxf.linetype == "DASHED" and drawing.linetypes.get("DASHED")
for e in drawing.modelspace():
    kind, numbers = e.dxftype(), []
    if kind == "LINE": numbers = [e.dxf.start.x, e.dxf.start.y, e.dxf.end.x, e.dxf.end.y]
    elif kind == "CIRCLE": numbers = [e.dxf.center.x, e.dxf.center.y, e.dxf.radius]
    elif kind == "POLYLINE": numbers = [n for v in e.vertices for n in (v.dxf.location.x, v.dxf.location.y, v.dxf.bulge)]
    elif kind == "TEXT": numbers = [e.dxf.insert.x, e.dxf.insert.y, e.dxf.height]
    print(kind, e.dxf.layer, e.dxf.linetype, "closed" if getattr(e, "is_closed", False) else "open",
          *(f"{n + 0:.3f}" for n in numbers), decode_dxf_unicode(e.dxf.text) if kind == "TEXT" else "")
print("extents", *(f"{n:.3f}" for key in ("$EXTMIN", "$EXTMAX") for n in drawing.header[key][:2]))
)");
    const std::string line = fmt::format("cd {} && /usr/bin/python3 read.py {} > entities.txt",
                                         test::quoted(folder_.string()), test::quoted(file));
    EXPECT_EQ(std::system(line.c_str()), 0) << line << ": scripts/setup installs python3-ezdxf";
    return test::text_of(folder_ / "entities.txt");
  }
};

TEST_F(DxfTest, HasLinesArcsCirclesAndTexts) {
  Drawing drawing{.width = 100.0f, .height = 50.0f, .mm_per_unit = 2.0f};
  const auto add = [&](const char* layer, const DrawnShape& shape) {
    drawing.layers.push_back({.name = layer, .shapes = {shape}});
  };
  add("outline", DrawnPath{.x = 1, .y = 2, .segments = {{.x = 11, .y = 2}}, .stroke = DrawnColor{}});
  add("hidden", DrawnPath{.x = 0, .y = 0, .segments = {{.x = 0, .y = 40}}, .stroke = DrawnColor{}, .dashes = {3, 2}});
  const DrawnSegment there{.x = 30, .y = 20, .radius = 10}, back{.x = 10, .y = 20, .radius = 10};
  add("section", DrawnPath{.x = 10, .y = 20, .segments = {there, back}, .closed = true, .stroke = DrawnColor{}});
  // A quarter turn to the right on the page, then a line.
  const DrawnSegment quarter{.x = 70, .y = 20, .radius = 10, .clockwise = true};
  add("cross-hatch", DrawnPath{.x = 60, .y = 10, .segments = {quarter, {.x = 70, .y = 30}}, .stroke = DrawnColor{}});
  add("my layer", DrawnText{.x = 5, .y = 45, .size = 10, .text = "12 \xc2\xb5m\n"});
  std::ofstream(folder_ / "drawing.dxf") << *dxf_text(drawing);
  EXPECT_EQ(entities("drawing.dxf"),
            "LINE visible BYLAYER open 2.000 96.000 22.000 96.000 \n"
            "LINE hidden DASHED open 0.000 100.000 0.000 20.000 \n"
            "CIRCLE section BYLAYER open 40.000 60.000 20.000 \n"
            "POLYLINE hatch BYLAYER open 120.000 80.000 -0.414 140.000 60.000 0.000 140.000 40.000 0.000 \n"
            "TEXT my_layer BYLAYER open 10.000 10.000 14.580 12 \xc2\xb5m \n"
            "extents 0.000 0.000 200.000 100.000\n");
  drawing.mm_per_unit = INFINITY;
  EXPECT_FALSE(dxf_text(drawing));
}

constexpr const char* kBox =
    "v 0 0 0\nv 40 0 0\nv 40 0 10\nv 0 0 10\nv 0 20 0\nv 40 20 0\nv 40 20 10\nv 0 20 10\n"
    "f 4 3 7 8\nf 3 2 6 7\nf 1 4 8 5\nf 2 1 5 6\nf 8 7 6 5\nf 1 2 3 4\n";

TEST_F(DxfTest, CapsOfSectionsHaveLayersForTheirOutlinesAndHatching) {
  write("box.obj", kBox);
  for (const std::string look : {"cartoon", "technical"}) {
    good(
        "box.obj --device cpu --resolution 600,600 --camera-orthographic --camera-direction 0,0,-1 --section z<50% "
        "--look " +
        look + " -o cut.dxf");
    std::map<std::string, int> lines;
    int straight = 0;
    std::istringstream all(entities("cut.dxf"));
    for (std::string line; std::getline(all, line) && !line.starts_with("extents");) {
      const test::Words words = test::words_of(line);
      ++lines[words[1]];
      if (words[0] != "LINE" || words[1] != "hatch") continue;
      ++straight;
      const double x = std::stod(words[6]) - std::stod(words[4]), y = std::stod(words[7]) - std::stod(words[5]);
      EXPECT_NEAR(std::abs(x), std::abs(y), 0.1) << line;
    }
    EXPECT_EQ(lines["section"], 4);
    EXPECT_GT(straight, 30);
    EXPECT_LE(lines["hatch"], straight + 4) << "lines of hatching are straight";
    EXPECT_EQ(lines.size(), 2u) << "nothing else is seen from above";
  }
}

TEST_F(DxfTest, OfParallelViewsHasTheUnitsOfTheModel) {
  write("box.obj", kBox);
  good("box.obj --device cpu --resolution 600,600 --camera-orthographic --camera-direction 0,0,-1 -o front.dxf");
  double min[2] = {1e9, 1e9}, max[2] = {-1e9, -1e9};
  std::istringstream lines(entities("front.dxf"));
  int count = 0;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("LINE visible")) continue;
    ++count;
    const test::Words words = test::words_of(line);
    for (std::size_t k = 4; k < 8; ++k)
      min[k % 2] = std::min(min[k % 2], std::stod(words[k])), max[k % 2] = std::max(max[k % 2], std::stod(words[k]));
  }
  EXPECT_EQ(count, 4);
  const double pixel = 50.0 / 600.0;  // about
  EXPECT_NEAR(max[0] - min[0], 40.0, pixel);
  EXPECT_NEAR(max[1] - min[1], 20.0, pixel);
}

TEST_F(DxfTest, TheRimOfACylinderIsACircle) {
  std::string text, rim[2];
  constexpr int kSides = 360;
  for (int end = 0; end < 2; ++end)
    for (int k = 0; k < kSides; ++k) {
      const double angle = 2.0 * M_PI * k / kSides;
      text += fmt::format("v {} {} {}\n", 5.0 * std::cos(angle), 4 * end, 5.0 * std::sin(angle));
      rim[end] += fmt::format(" {}", end * kSides + (end ? kSides - k : k + 1));
    }
  for (int k = 1; k <= kSides; ++k) {
    const int next = k % kSides + 1;
    text += fmt::format("f {} {} {} {}\n", k, k + kSides, next + kSides, next);
  }
  write("cylinder.obj", text + "f" + rim[0] + "\nf" + rim[1] + "\n");
  const std::string view = "cylinder.obj --device cpu --resolution 512,512 --camera-orthographic ";
  good(view + "--camera-direction 0,-1,0 -o top.dxf");
  const test::Words circle = test::words_of(entities("top.dxf"));
  ASSERT_EQ(circle[0], "CIRCLE");
  const double tenth = 0.1 * std::stod(circle[circle.size() - 1]) / 512.0;  // of a pixel
  EXPECT_NEAR(std::stod(circle[6]), 5.0, tenth);
  EXPECT_NEAR(std::stod(circle[4]), 0.5 * std::stod(circle[circle.size() - 1]), tenth);
  // In other views rims are ellipses, of a few arcs each.
  good(view + "--camera-direction 1,-1,1 -o view.dxf");
  EXPECT_EQ(entities("view.dxf").find("CIRCLE"), std::string::npos);
  EXPECT_LE(entities("view.dxf").size(), 1500u);
}

TEST_F(DxfTest, OfPerspectiveSaysThatItHasNoScale) {
  const auto drawn = run("tri.obj --device cpu --resolution 64,64 -o lines.dxf");
  EXPECT_EQ(drawn.code, 0) << drawn.err;
  EXPECT_NE(drawn.err.find("'lines.dxf' shows a perspective view"), std::string::npos) << drawn.err;
  EXPECT_NE(drawn.err.find("--camera-orthographic"), std::string::npos);
  EXPECT_NE(entities("lines.dxf").find("visible"), std::string::npos);
  const auto beside =
      run("tri.obj --device cpu --resolution 64,64 --look cartoon --camera-orthographic -o a.png --drawing b.dxf");
  EXPECT_EQ(beside.code, 0) << beside.err;
  EXPECT_EQ(beside.err, "");
  EXPECT_NE(entities("b.dxf").find("LINE visible"), std::string::npos);
  good(
      "scene:solids?detail=2000 --device cpu --resolution 160,120 --look technical --set hidden.draw=on "
      "--camera-orthographic -o hidden.dxf");
  EXPECT_NE(entities("hidden.dxf").find(" hidden DASHED "), std::string::npos);
  write("p.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property float p\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 1\n1 0 0 2\n0 1 0 3\n3 0 1 2\n");
  const auto bar = run(
      "p.ply --device cpu --resolution 96,96 --look cartoon --color-by p --color-bar --camera-orthographic -o bar.dxf");
  EXPECT_EQ(bar.code, 0) << bar.err;
  EXPECT_NE(bar.err.find("'bar.dxf' leaves out the colours of 'color-bar'"), std::string::npos) << bar.err;
  EXPECT_NE(entities("bar.dxf").find("TEXT color-bar"), std::string::npos);
  bad("tri.obj --passes depth -o lines.dxf", 2, {"--passes", "'lines.dxf'"});
  bad("tri.obj --look studio -o lines.dxf", 2, {"'studio' draws no lines"});
}

}  // namespace
}  // namespace umbrage
