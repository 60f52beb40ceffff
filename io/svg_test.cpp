// Lines as .svg files and as strokes. librsvg must draw them as they are in the picture.
#include "io/svg.h"

#include <sys/stat.h>

#include <map>
#include <regex>

#include "io/drawing_of_strokes.h"

#include "run_program.h"
#include "support.h"
#include "umbrage/umbrage.hpp"
#include "vulkan_support.h"
using namespace umb;  // the public interface; its names used here are not in umbrage, except for Stroke

namespace umbrage {
namespace {

namespace fs = std::filesystem;
using test::text_of;

class SvgTest : public test::ProgramTest {
 protected:
  /// Returns the coverage of the lines as librsvg draws them in black. Fails if the file is not valid SVG.
  Plane drawn(const std::string& svg) {
    const std::string png = svg + ".png";
    const std::string line = fmt::format("cd {} && rsvg-convert --background-color=white {} -o {}",
                                         test::quoted(folder_.string()), test::quoted(svg), test::quoted(png));
    EXPECT_EQ(std::system(line.c_str()), 0) << line << ": scripts/setup installs librsvg2-bin";
    return inverse(image(png).plane("color.g"));
  }

  static Plane inverse(Plane plane) {
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x) plane.at(x, y) = 1.0f - plane.at(x, y);
    return plane;
  }

  void write_cube() {
    write("cube.obj",
          "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1\n"
          "f 4 3 7 8\nf 3 2 6 7\nf 1 4 8 5\nf 2 1 5 6\nf 8 7 6 5\nf 1 2 3 4\n");
  }
};

double rmse(const Plane& a, const Plane& b) {
  if (a.width != b.width || a.height != b.height) return INFINITY;
  double sum = 0.0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) sum += std::pow(double(a.at(x, y)) - double(b.at(x, y)), 2.0);
  return std::sqrt(sum / (double(a.width) * a.height));
}

/// Returns how often a part occurs in a text.
long count_of(const std::string& text, const std::string& part) {
  long count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

const std::string kSmall = "scene:solids?detail=2000 --device cpu --look cartoon --ao none --resolution 128x96 ";

TEST_F(SvgTest, MatchesThePicture) {
  write_cube();
  for (const std::string model : {"scene:solids", "cube.obj"})
    for (const int size : {256, 512})
      for (const int width : {1, 2, 8}) {
        const std::string line = fmt::format(
            "{} --device cpu --look cartoon --ao none --anti-aliasing 1 --resolution {},{} --set outline.width={} ",
            model, size, size, width);
        good(line + "--passes outline -o lines.pfm --svg lines.svg");
        // Lines as wide as a thirtieth of the picture's height overlap, and antialiased borders are blended twice
        // there.
        const bool lines_overlap = model == "scene:solids" && size == 256 && width == 8;
        EXPECT_LE(rmse(drawn("lines.svg"), image("lines.pfm").planes[0]), lines_overlap ? 0.03 : 0.02) << line;
      }
}

TEST_F(SvgTest, DoesNotDependOnTheCommand) {
  // High enough for strips that need less memory than the whole picture.
  const std::string high = "scene:solids?detail=2000 --device cpu --look cartoon --ao none --resolution 96x1600 ";
  const std::string strips = "--memory 64M ";
  good(high + "-o picture.png --svg beside.svg");
  good("scene:solids?detail=2000 --device cpu --resolution 96x1600 -o alone.svg");
  good(high + "--anti-aliasing 4 --threads 1 --no-background -o averaged.exr --svg averaged.svg");
  good(high + strips + "-o strips.svg");
  good(high + strips + "--anti-aliasing 2 -o strips.png --svg strips_beside.svg");
  for (const char* file : {"strips.svg", "strips.png"})
    EXPECT_NE(run(high + strips + "--verbose -o " + file).err.find("drawn in strips"), std::string::npos) << file;
  good(high + "-o turn.svg --turntable 2");
  const std::string lines = text_of(folder_ / "alone.svg");
  for (const char* kind : {"outline", "fold", "crease"})
    EXPECT_GE(count_of(lines, fmt::format("class=\"{}\" data-object=", kind)), 1) << kind;
  for (const char* name : {"beside.svg", "averaged.svg", "strips.svg", "strips_beside.svg", "turn_0000.svg"})
    EXPECT_EQ(text_of(folder_ / name), lines) << name;
  EXPECT_NE(text_of(folder_ / "turn_0001.svg"), lines);
  // Lines in the guard band are detected, but not written.
  good(high + "--guard-band 10% -o guard.svg");
  good(high + "--guard-band 10% --memory 100M " + "-o guard_strips.svg");
  EXPECT_EQ(text_of(folder_ / "guard_strips.svg"), text_of(folder_ / "guard.svg"));
  EXPECT_LE(rmse(drawn("guard.svg"), drawn("alone.svg")), 0.1);
}

TEST_F(SvgTest, IsTheSameOnVulkan) {
  UMBRAGE_NEEDS_VULKAN(vulkan_gpus());
  const std::string line = "scene:solids?detail=2000 --resolution 128x128 -o ";
  good(line + "cpu.svg --device cpu");
  good(line + "gpu.svg --device vulkan");
  EXPECT_EQ(text_of(folder_ / "gpu.svg"), text_of(folder_ / "cpu.svg"));
}

TEST_F(SvgTest, HasColorsAndNoLinesInEmptyViews) {
  write_cube();
  good(
      "cube.obj --device cpu --resolution 64x48 --background-color 1,0.5,0 --set outline.r=0.5 --set "
      "outline.opacity=0.25 -o cube.svg");
  const std::string cube = text_of(folder_ / "cube.svg");
  for (const char* part : {"width=\"64px\" height=\"48px\" viewBox=\"0 0 64 48\"", "<rect width=\"64\" height=\"48\" ",
                           "fill=\"#ff8000\"", "stroke=\"#bc0000\"", "opacity=\"0.25\"", "stroke-linecap=\"round\""})
    EXPECT_NE(cube.find(part), std::string::npos) << part;
  const auto empty_view =
      run("cube.obj --device cpu --resolution 64x48 --camera-position 0,0,9 --camera-direction 0,0,1 "
          "-o nothing.svg");
  EXPECT_EQ(empty_view.code, 0) << empty_view.err;
  EXPECT_NE(empty_view.err.find("nothing of cube.obj is in view"), std::string::npos) << empty_view.err;
  EXPECT_EQ(count_of(text_of(folder_ / "nothing.svg"), "<path"), 0);
  EXPECT_EQ(rmse(drawn("nothing.svg"), Plane(64, 48, 0.0f)), 0.0);
}

TEST_F(SvgTest, HasTheLinesOfEveryLookThatDrawsSome) {
  for (const std::string look : {"cartoon", "hatching", "technical"}) {
    good("scene:solids?detail=2000 --device cpu --resolution 160x120 --look " + look + " -o " + look + ".svg");
    const std::string text = text_of(folder_ / (look + ".svg"));
    EXPECT_GT(count_of(text, "<path"), 15) << look;
    EXPECT_GT(count_of(text, "stroke=\"#000000\""), 0) << look;
    EXPECT_EQ(count_of(text, "class=\"hatch\"") > 0, look == "hatching") << look;
    EXPECT_EQ(count_of(text, "class=\"cross-hatch\"") > 0, look == "hatching") << look;
  }
}

TEST_F(SvgTest, HasHiddenLinesAsDashes) {
  write_cube();
  const std::string command = "cube.obj --device cpu --resolution 512,512 --look technical";
  good(command + " --set hidden.draw=on -o hidden.svg");
  good(command + " --set hidden.draw=on -o both.png --svg both.svg");
  good(command + " -o visible.svg");
  // A path per edge, not per dash: three of twelve are hidden.
  const std::string text = text_of(folder_ / "hidden.svg"), visible = text_of(folder_ / "visible.svg");
  EXPECT_EQ(count_of(text, "class=\"hidden\""), 1);
  EXPECT_EQ(count_of(text, "<path"), 12);
  EXPECT_EQ(count_of(text, "stroke-dasharray"), 3);
  EXPECT_EQ(text, text_of(folder_ / "both.svg"));
  EXPECT_EQ(count_of(visible, "class=\"hidden\""), 0);
  EXPECT_EQ(count_of(visible, "<path"), 9);
  EXPECT_EQ(count_of(visible, "stroke-dasharray"), 0);
  // Dashes cover as much as in the picture; neither none nor solid lines do.
  write("solid.svg", std::regex_replace(text, std::regex(" stroke-dasharray=\"[^\"]*\""), ""));
  good(command + " --set hidden.draw=on --anti-aliasing 1 --passes outline -o lines.pfm");
  const auto covered = [](const Plane& plane) {
    double sum = 0.0;
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x) sum += plane.at(x, y);
    return sum;
  };
  const double none = covered(drawn("visible.svg")), whole = covered(drawn("solid.svg"));
  const double expected = (covered(image("lines.pfm").planes[0]) - none) / (whole - none);
  EXPECT_NEAR((covered(drawn("hidden.svg")) - none) / (whole - none), expected, 0.1);
  EXPECT_GT(expected, 0.4);
  EXPECT_LT(expected, 0.85);
}

TEST_F(SvgTest, ACubeHasNinePathsOfTwoPoints) {
  write_cube();
  for (const std::string how : {"--look cartoon", "--look technical --camera-orthographic", "--look technical"}) {
    good("cube.obj --device cpu --resolution 512,512 -o cube.svg " + how);
    const std::string text = text_of(folder_ / "cube.svg");
    EXPECT_EQ(count_of(text, "<path"), 9) << how;
    EXPECT_EQ(count_of(text, "<path stroke-width"), 9) << how;
    // Each corner is the same point in all edges that meet there.
    std::map<std::string, int> ends;
    const std::regex path("d=\"M([-0-9.]+ [-0-9.]+)L([-0-9.]+ [-0-9.]+)\"");
    for (std::sregex_iterator match(text.begin(), text.end(), path), end; match != end; ++match)
      ++ends[(*match)[1]], ++ends[(*match)[2]];
    EXPECT_EQ(ends.size(), 7u) << how << text;
  }
}

TEST_F(SvgTest, HoldsThePictureOfALookWithoutLines) {
  good("tri.obj --device cpu --resolution 32x24 --look studio -o studio.svg");
  const std::string text = text_of(folder_ / "studio.svg");
  EXPECT_EQ(count_of(text, "<image "), 1);
  EXPECT_EQ(count_of(text, "<path"), 0);
  good("tri.obj --device cpu --resolution 32x24 --look studio -o studio.png");
  EXPECT_LE(rmse(drawn("studio.svg"), inverse(image("studio.png").plane("color.g"))), 0.005);
}

TEST_F(SvgTest, HasFewPaths) {
  // Paths at 1024x1024. With one path per run of constant width the tank had 10913.
  good("scene:tank --device cpu -o tank.svg");
  EXPECT_LE(count_of(text_of(folder_ / "tank.svg"), "<path"), 1500);
  good("scene:solids --device cpu --look hatching -o hatching.svg");
  EXPECT_LE(count_of(text_of(folder_ / "hatching.svg"), "<path"), 3000);
}

TEST_F(SvgTest, RefusesWhatCannotBe) {
  // All errors are detected before the model is read.
  const std::string lines = "nothere.obj -o lines.svg ";
  bad(lines + "--bits 16", 2, {"--bits", ".svg"});
  bad(lines + "--half", 2, {"--half", ".svg"});
  bad(lines + "--passes depth", 2, {"--passes depth", "'lines.svg'", ".exr"});
  bad(lines + "--look cartoon-paper", 2, {"outline.mode=paper", "robust"});
  bad(lines + "--set outline.opacity=0", 2, {"outline.opacity=0"});
  bad(lines + "--look cartoonn", 2, {"'cartoonn'", "did you mean"});
  bad(lines + "--svg more.svg", 2, {"--svg 'more.svg'", "--output 'lines.svg'"});
  bad("nothere.obj -o out.png --svg lines.svg", 2, {"'studio' draws no lines", "cartoon", "technical"});
  bad("nothere.obj -o out.png --look cartoon --svg lines.png", 2, {"--svg", "'lines.png'", ".svg", ".dxf"});
  bad("nothere.obj -o - --look cartoon --svg -", 2, {"--svg", "'-'", ".svg"});
  bad("nothere.obj -o nothere/lines.svg", 3, {"'nothere/lines.svg'", "does not exist"});
  bad("nothere.obj -o out.png --look cartoon --svg nothere/lines.svg", 3, {"'nothere/lines.svg'"});
  ::symlink("/dev/full", (folder_ / "full.svg").c_str());
  bad("tri.obj --device cpu --resolution 32x32 -o full.svg", 3, {"'full.svg'", "No space left"});
}

TEST_F(SvgTest, LibraryStrokesMatchTheFile) {
  RenderRequest request = {.model = "scene:solids?detail=2000",
                           .look = "cartoon",
                           .occlusion = "none",
                           .width = 128,
                           .height = 96,
                           .device = "cpu",
                           .strokes = true};
  Picture picture;
  ASSERT_EQ(render(request, picture).code, 0);
  EXPECT_EQ(picture.stroke_opacity, 1.0f);
  ASSERT_EQ(save(picture, (folder_ / "library.svg").string()).code, 0);
  good(kSmall + "-o program.svg");
  EXPECT_EQ(text_of(folder_ / "library.svg"), text_of(folder_ / "program.svg"));
  FrameRenderer renderer;
  Picture frame;
  ASSERT_EQ(renderer.open(request).code, 0);
  for (int k = 0; k < 2; ++k) {
    ASSERT_EQ(renderer.draw({}, frame).code, 0);
    ASSERT_EQ(frame.strokes.size(), picture.strokes.size());
    for (std::size_t s = 0; s < frame.strokes.size(); ++s)
      ASSERT_EQ(frame.strokes[s].points.size(), picture.strokes[s].points.size());
  }
  // Without strokes there is nothing to write, and a look without lines has no strokes.
  request.strokes = false;
  ASSERT_EQ(render(request, frame).code, 0);
  EXPECT_TRUE(frame.strokes.empty());
  EXPECT_EQ(save(frame, (folder_ / "none.svg").string()).code, 2);
  EXPECT_EQ(render({.model = "nothere.obj", .strokes = true}, frame).code, 2);
  picture.strokes[0].points[0].x = NAN;
  EXPECT_EQ(save(picture, (folder_ / "none.svg").string()).code, 2);
  picture.strokes[0].points[0] = {3e38f, 0.0f, 1.0f};
  EXPECT_EQ(save(picture, (folder_ / "none.svg").string()).code, 2);
  EXPECT_FALSE(fs::exists(folder_ / "none.svg"));
}

TEST_F(SvgTest, ArraysHaveStrokesByEffectsAndByLooks) {
  // A square in front of the background; its outline is 64 pixels long.
  constexpr int kSize = 32;
  std::vector<float> depth(kSize * kSize, INFINITY);
  for (int y = 8; y < 24; ++y)
    for (int x = 8; x < 24; ++x) depth[std::size_t(y * kSize + x)] = 2.0f;
  ShadeRequest request;
  request.width = request.height = kSize;
  request.arrays = {{"depth", depth.data()}};
  request.device = "cpu";
  request.strokes = true;
  for (const bool effects : {true, false}) {
    request.look = effects ? "studio" : "cartoon";
    request.effects = effects ? std::vector<std::string>{"outline"} : std::vector<std::string>();
    Picture picture;
    const auto outcome = shade(request, picture);
    ASSERT_EQ(outcome.code, 0) << outcome.message;
    double length = 0.0;
    for (const umb::Stroke& stroke : picture.strokes) {
      EXPECT_EQ(stroke.kind, umb::StrokeKind::kOutline);
      for (std::size_t k = 1; k < stroke.points.size(); ++k)
        length += std::hypot(stroke.points[k].x - stroke.points[k - 1].x, stroke.points[k].y - stroke.points[k - 1].y);
    }
    EXPECT_NEAR(length, 64.0, 3.0) << effects;
  }
  request.effects = {"bitmask"};
  Picture picture;
  EXPECT_EQ(shade(request, picture).code, 2);
}

TEST_F(SvgTest, HostileArraysGiveAFileOrAnError) {
  constexpr float kOdd[] = {NAN, INFINITY, -INFINITY, -1.0f, 0.0f, 1e-30f, 1e30f, 2.0f, 3.0f, 3.0f};
  for (const auto& [width, height] : {std::pair(1, 1), {1, 40}, {57, 31}}) {
    const auto pixels = std::size_t(width) * std::size_t(height);
    std::vector<float> depth(pixels), normal(3 * pixels), id(pixels);
    for (std::size_t k = 0; k < pixels; ++k) {
      depth[k] = kOdd[test::hash(unsigned(k)) % std::size(kOdd)];
      id[k] = kOdd[test::hash(unsigned(k + 1000000)) % std::size(kOdd)];
      for (int c = 0; c < 3; ++c) normal[3 * k + c] = kOdd[test::hash(unsigned(3 * k + c + 2000000)) % std::size(kOdd)];
    }
    ShadeRequest request;
    request.width = width, request.height = height;
    request.arrays = {{"depth", depth.data()}, {"normal", normal.data()}, {"object_id", id.data()}};
    request.effects = {"outline"};
    request.settings = {"outline.width=16", "outline.ids=both"};
    request.device = "cpu";
    request.strokes = true;
    Picture picture;
    const auto outcome = shade(request, picture);
    ASSERT_EQ(outcome.code, 0) << outcome.message;
    const auto saved = save(picture, (folder_ / "hostile.svg").string());
    ASSERT_EQ(saved.code, 0) << saved.message;
    drawn("hostile.svg");
  }
}

TEST(Svg, WritesAPathPerLine) {
  Strokes lines{40,
                20,
                {{StrokeKind::kFold, 7, false, {{2, 5, 1}, {20, 5, 1.01f}, {38, 5, 1}}},
                 {StrokeKind::kOutline, 3, true, {{5, 5, 2}, {15, 5, 2}, {15, 15, 2}, {5, 5, 2}}},
                 {StrokeKind::kFold, 7, false, {{2, 10, 0}, {38, 10, 3}}},
                 {StrokeKind::kCrease, -1, false, {{4, 4, 1}}},
                 {StrokeKind::kCrease, -1, false, {}}}};
  const std::string text = *svg_text(*drawing_of(lines, {}));
  // The triangle has three sides, the line of varying width an outline with a round end.
  EXPECT_NE(text.find("<g id=\"outline-3\" class=\"outline\" data-object=\"3\">\n"
                      "<path stroke-width=\"2\" d=\"M5 5L15 5\"/>\n"
                      "<path stroke-width=\"2\" d=\"M15 5L15 15\"/>\n"
                      "<path stroke-width=\"2\" d=\"M15 15L5 5\"/>\n</g>\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("<path stroke-width=\"1.005\" d=\"M2 5L38 5\"/>"), std::string::npos) << text;
  EXPECT_NE(text.find("<path fill=\"#000000\" stroke=\"none\" d=\"M2 10L38 11.5A1.5 1.5 0 0 0 38 8.5L2 10Z\"/>"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("d=\"M4 4L4 4\"/>"), std::string::npos) << "a dot";
  EXPECT_EQ(count_of(text, "<path"), 6);
}

TEST(Svg, WritesTextsPicturesAndPhysicalSizes) {
  Drawing drawing{.width = 30.0f, .height = 20.0f, .mm_per_unit = 0.5f};
  DrawnLayer layer{.name = "legend \"1\" & <2>"};
  layer.shapes.emplace_back(
      DrawnText{.x = 3, .y = 4, .anchor = TextAnchor::kEnd, .upwards = true, .text = "p < 3 & q\x01"});
  layer.shapes.emplace_back(DrawnImage{1, 2, 3, 4, 2, 1, {255, 0, 0, 255, 0, 0, 255, 128}});
  drawing.layers = {layer, layer};
  const std::string text = *svg_text(drawing);
  EXPECT_NE(text.find("width=\"15mm\" height=\"10mm\" viewBox=\"0 0 30 20\""), std::string::npos) << text;
  EXPECT_NE(text.find("text-anchor=\"end\" fill=\"#000000\" stroke=\"none\" transform=\"rotate(-90 3 4)\">"
                      "p &lt; 3 &amp; q</text>"),
            std::string::npos)
      << text;
  EXPECT_EQ(count_of(text, "href=\"data:image/png;base64,iVBORw0KGgo"), 2);
  EXPECT_EQ(count_of(text, "id=\"legend &quot;1&quot; &amp; &lt;2>\""), 1) << "ids differ";
  layer.shapes.assign({DrawnPath{.x = NAN}});
  drawing.layers = {layer};
  EXPECT_FALSE(svg_text(drawing));
}

}  // namespace
}  // namespace umbrage
