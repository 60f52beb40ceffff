// Models far from their file's origin, as georeferenced ones: the same pictures as near it, and all positions that
// users give or read are those of the file.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "archives.h"
#include "run_program.h"
#include "umbrage/umbrage.hpp"

namespace umbrage::test {
namespace {

using Point = std::array<double, 3>;

/// A wavy sheet of 24 x 24 vertices, 2 wide, as a model that is moved by `at`.
struct Sheet {
  static constexpr int kSide = 24;
  Point at;

  std::vector<Point> vertices() const {
    std::vector<Point> all;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const double u = 2.0 * x / (kSide - 1) - 1.0, v = 2.0 * y / (kSide - 1) - 1.0;
        all.push_back({at[0] + u, at[1] + 0.25 * std::sin(5.0 * u) * std::cos(4.0 * v), at[2] + v});
      }
    return all;
  }
  /// Returns the triangles, each text `format` with three indices that begin at `first`.
  std::string triangles(const std::string& format, int first) const {
    std::string text;
    for (int y = 0; y + 1 < kSide; ++y)
      for (int x = 0; x + 1 < kSide; ++x) {
        const int a = first + y * kSide + x;
        text += fmt::format(fmt::runtime(format), a, a + kSide, a + 1) +
                fmt::format(fmt::runtime(format), a + 1, a + kSide, a + kSide + 1);
      }
    return text;
  }
  std::string points(const std::string& format) const {
    std::string text;
    for (const Point& p : vertices()) text += fmt::format(fmt::runtime(format), p[0], p[1], p[2]);
    return text;
  }
  std::string as(const std::string& extension) const {
    if (extension == "xyz") return points("{} {} {}\n");
    if (extension == "obj") return points("v {} {} {}\n") + triangles("f {} {} {}\n", 1);
    if (extension == "ply")
      return fmt::format(
                 "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty "
                 "double z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
                 kSide * kSide, 2 * (kSide - 1) * (kSide - 1)) +
             points("{} {} {}\n") + triangles("3 {} {} {}\n", 0);
    return three_mf_of(object_3mf("<mesh><vertices>" + points("<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>") +
                                  "</vertices><triangles>" + triangles("<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"/>", 0) +
                                  "</triangles></mesh>"));
  }
};

constexpr Point kFar = {500000.0, 4200000.0, 100.0};
constexpr const char* kFormats[] = {"3mf", "ply", "obj", "xyz"};

class Georeferenced : public ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    for (const char* format : kFormats) {
      write(std::string("near.") + format, Sheet{{0, 0, 0}}.as(format));
      write(std::string("far.") + format, Sheet{kFar}.as(format));
    }
  }
  /// Expects that two pictures differ by at most one step of 8 bits.
  void expect_same(const std::string& first, const std::string& second) {
    const Image a = image(first), b = image(second);
    ASSERT_EQ(a.planes.size(), b.planes.size());
    float max = 0.0f;
    for (std::size_t k = 0; k < a.planes.size(); ++k)
      for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x) max = std::max(max, std::abs(a.planes[k].at(x, y) - b.planes[k].at(x, y)));
    EXPECT_LT(max, 1.5f / 255.0f) << first << " " << second;
  }
};

TEST_F(Georeferenced, PicturesAreThoseNearTheOrigin) {
  const std::string look = " --resolution 96 --up +Y -o ";
  for (const std::string format : kFormats) {
    SCOPED_TRACE(format);
    good("near." + format + look + "near.png");
    good("far." + format + look + "far.png");
    expect_same("near.png", "far.png");
    good("near." + format + look + "near.png --camera-position 1.5,2.25,3.125 --camera-focal-point 0.1,0.2,0");
    good("far." + format + look +
         "far.png --camera-position 500001.5,4200002.25,103.125 --camera-focal-point 500000.1,4200000.2,100");
    expect_same("near.png", "far.png");
    // Two models with different origins share one frame.
    write("near2." + format, Sheet{{3, 0, 0}}.as(format));
    write("far2." + format, Sheet{{kFar[0] + 3, kFar[1], kFar[2]}}.as(format));
    good(fmt::format("near.{0} near2.{0}{1}near.png", format, look));
    good(fmt::format("far.{0} far2.{0}{1}far.png", format, look));
    expect_same("near.png", "far.png");
  }
}

TEST_F(Georeferenced, InfoAndExrAreInTheCoordinatesOfTheFile) {
  const auto records = nlohmann::json::parse(good("info far.3mf --json").out);
  EXPECT_NEAR(records[0]["min_x"].get<double>(), 499999.0, 1e-5);
  EXPECT_NEAR(records[0]["max_x"].get<double>(), 500001.0, 1e-5);
  EXPECT_NEAR(records[0]["max_z"].get<double>(), 101.0, 1e-5);
  const std::string text = good("info far.3mf").out;
  EXPECT_NE(text.find("bounds     499999.000"), std::string::npos) << text;
  good(
      "far.3mf --resolution 16 --look ao -o far.exr --camera-position 500001.5,4200002.25,103.125 --camera-focal-point "
      "500000.1,4200000.2,100 --camera-orthographic");
  good(
      "near.3mf --resolution 16 --look ao -o near.exr --camera-position 1.5,2.25,3.125 --camera-focal-point 0.1,0.2,0 "
      "--camera-orthographic");
  const auto far = read_camera(folder_ / "far.exr"), near = read_camera(folder_ / "near.exr");
  ASSERT_TRUE(far && *far && near && *near);
  EXPECT_NEAR((*far)->eye().x, 500001.5f, 0.5f);
  EXPECT_NEAR((*far)->eye().y, 4200002.25f, 2.0f);
  EXPECT_NEAR((*far)->top, (*near)->top, 1e-5f) << "the window keeps its precision";
  EXPECT_NEAR((*far)->left, (*near)->left, 1e-5f);
}

TEST_F(Georeferenced, TheLibraryUsesTheCoordinatesOfTheFile) {
  const auto render = [&](const std::string& name, const Point& at) {
    umb::RenderRequest request;
    request.model = (folder_ / name).string();
    request.width = request.height = 48;
    request.device = "cpu";
    request.camera.position = {at[0] + 1.5, at[1] + 2.25, at[2] + 3.125};
    request.camera.focal_point = {at[0] + 0.1, at[1] + 0.2, at[2]};
    umb::Picture picture;
    const umb::Outcome outcome = umb::render(request, picture);
    EXPECT_EQ(outcome.code, 0) << outcome.message;
    return picture;
  };
  const umb::Picture near = render("near.3mf", {0, 0, 0}), far = render("far.3mf", kFar);
  ASSERT_EQ(near.rgba.size(), far.rgba.size());
  for (std::size_t k = 0; k < near.rgba.size(); ++k) ASSERT_NEAR(near.rgba[k], far.rgba[k], 1.5f / 255.0f) << k;
  ASSERT_TRUE(near.view && far.view);
  for (int row = 0; row < 3; ++row) {
    const double* m = &far.view->view_from_world[std::size_t(4 * row)];
    const double moved = m[0] * kFar[0] + m[1] * kFar[1] + m[2] * kFar[2] + m[3];
    EXPECT_NEAR(moved, near.view->view_from_world[std::size_t(4 * row + 3)], 1e-4);
  }

  umb::Device device("cpu", 1);
  umb::Scene scene(device);
  EXPECT_EQ(scene.load((folder_ / "far.3mf").string().c_str()), UMB_ERROR_NONE);
  EXPECT_EQ(scene.load((folder_ / "far.3mf").string().c_str()), UMB_ERROR_NONE);
  std::array<double, 3> lower{}, upper{};
  EXPECT_EQ(scene.bounds(lower, upper), UMB_ERROR_NONE);
  EXPECT_NEAR(lower[0], 499999.0, 1e-5);
  EXPECT_NEAR(upper[0], 500001.0, 1e-5);
}

}  // namespace
}  // namespace umbrage::test
