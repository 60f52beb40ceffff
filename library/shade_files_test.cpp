// Files shaded by the library: bitwise the picture of the program, with facts, warnings and the camera.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>

#include "io/image_file.h"
#include "run_program.h"
#include "umbrage/umbrage.hpp"

namespace umbrage {
namespace {

class ShadeFiles : public test::ProgramTest {
 protected:
  /// Renders solids and writes them with depth, normals and albedo. Returns the file.
  std::string rendered() {
    umb::Picture picture;
    const auto outcome = umb::render({.model = "scene:solids?detail=2000",
                                      .look = "lit",
                                      .width = 64,
                                      .height = 48,
                                      .device = "cpu",
                                      .passes = {"beauty", "depth", "normal", "albedo", "object_id"}},
                                     picture);
    EXPECT_EQ(outcome.code, 0) << outcome.message;
    const std::string file = (folder_ / "rendered.exr").string();
    EXPECT_EQ(umb::save(picture, file).code, 0);
    return file;
  }

  /// Returns the picture that the program makes of a file, as floats.
  Image of_program(const std::string& words) {
    const auto to = folder_ / "program.pfm";
    const std::string command = fmt::format("'{}' shade {} --device cpu -o '{}'", test::kProgram, words, to.string());
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    auto image = read_image(to);
    EXPECT_TRUE(image) << image.error().message;
    return image ? std::move(*image) : Image();
  }
};

void expect_same(const umb::Picture& picture, const Image& program) {
  ASSERT_EQ(picture.width, program.width);
  ASSERT_EQ(picture.height, program.height);
  const char* names[] = {"color.r", "color.g", "color.b"};
  int differing = 0;
  for (int y = 0; y < program.height; ++y)
    for (int x = 0; x < program.width; ++x)
      for (int c = 0; c < 3; ++c) {
        const float of_library = picture.rgba[std::size_t(4 * (y * program.width + x) + c)];
        differing += std::memcmp(&of_library, program.plane(names[c]).row(y) + x, sizeof(float)) != 0;
      }
  EXPECT_EQ(differing, 0);
}

TEST_F(ShadeFiles, MakeThePictureOfTheProgram) {
  const std::string file = rendered();
  for (const char* look : {"", "ao", "studio", "cartoon"}) {
    SCOPED_TRACE(look);
    umb::ShadeRequest request;
    request.files.file = file;
    request.look = look;
    request.device = "cpu";
    umb::Picture picture;
    const auto outcome = umb::shade(request, picture);
    ASSERT_EQ(outcome.code, 0) << outcome.message;
    expect_same(picture, of_program(fmt::format("'{}' {}", file, *look ? fmt::format("--look {}", look) : "")));
  }
}

TEST_F(ShadeFiles, TakeSeparateFilesAndParameters) {
  const std::string file = rendered();
  umb::ShadeRequest request;
  request.files.depth_file = file + ":depth";
  request.files.parameters = {{"depth_scale", "2"}};
  request.files.fov_deg = 30.0f;
  request.look = "ao";
  request.device = "cpu";
  request.passes = {"depth"};
  umb::Picture picture;
  const auto outcome = umb::shade(request, picture);
  ASSERT_EQ(outcome.code, 0) << outcome.message;
  expect_same(picture, of_program(fmt::format("--depth '{}:depth' --depth-scale 2 --fov 30 --look ao", file)));
  const auto stored = read_image(file);
  ASSERT_TRUE(stored);
  ASSERT_EQ(picture.passes.size(), 1u);
  EXPECT_EQ(picture.passes[0].values[std::size_t(24 * 64 + 32)], 2.0f * stored->plane("depth").at(32, 24));
}

TEST_F(ShadeFiles, ReducePicturesAsTheProgram) {
  const std::string file = rendered();
  umb::ShadeRequest request;
  request.files.file = file;
  request.files.parameters = {{"reduction", "3"}};
  request.look = "ao";
  request.device = "cpu";
  request.passes = {"depth"};
  umb::Picture picture;
  const auto outcome = umb::shade(request, picture);
  ASSERT_EQ(outcome.code, 0) << outcome.message;
  EXPECT_EQ(picture.width, 64 / 3);
  EXPECT_EQ(picture.height, 48 / 3);
  expect_same(picture, of_program(fmt::format("'{}' --reduction 3 --look ao", file)));
  const auto stored = read_image(file);
  ASSERT_TRUE(stored);
  EXPECT_EQ(picture.passes[0].values[0], stored->plane("depth").at(1, 1));
  request.look = "cartoon";
  request.strokes = true;
  ASSERT_EQ(umb::shade(request, picture).code, 0);
  ASSERT_FALSE(picture.strokes.empty());
  for (const umb::Stroke& stroke : picture.strokes)
    for (const umb::StrokePoint& point : stroke.points) EXPECT_LT(point.x, 64.0f / 3 + point.width);
  request.files.parameters = {{"reduction", "8"}};
  EXPECT_EQ(umb::shade(request, picture).code, 0);
}

TEST_F(ShadeFiles, TellFactsLayersAndTheCamera) {
  const std::string file = rendered();
  const auto camera = read_camera(file);
  ASSERT_TRUE(camera && *camera);
  const umb::Device device("cpu");
  umb::Job job(device);
  job.set("file", file);
  ASSERT_EQ(job.prepare(), UMB_ERROR_NONE);
  const auto facts = job.facts(), layers = job.file_layers();
  EXPECT_FALSE(facts.empty());
  EXPECT_TRUE(std::any_of(layers.begin(), layers.end(),
                          [](const std::string& layer) { return layer.find("normal") != std::string::npos; }));
  UmbView view{};
  EXPECT_EQ(umbGetJobView(job.get(), &view), UMB_ERROR_USAGE);
  ASSERT_EQ(job.execute(), UMB_ERROR_NONE);
  EXPECT_EQ(job.facts(), facts);
  EXPECT_EQ(umbGetJobFact(job.get(), int(facts.size())), nullptr);
  EXPECT_EQ(umbGetJobFact(job.get(), -1), nullptr);
  ASSERT_EQ(umbGetJobView(job.get(), &view), UMB_ERROR_NONE);
  EXPECT_NEAR(view.right, (*camera)->right, 1e-5f);
  EXPECT_NEAR(view.top, (*camera)->top, 1e-5f);
}

// Memory of the library may be of any type.
TEST_F(ShadeFiles, WriteBytesIntoMemoryOfTheLibrary) {
  const std::string file = rendered();
  const umb::Device device("cpu");
  umb::Job job(device);
  job.set("file", file);
  job.set("look", "ao");
  UmbImage floats{}, bytes{}, made{};
  bytes.type = UMB_TYPE_UINT8;
  ASSERT_EQ(umbSetJobOutput(job.get(), "color", &floats), UMB_ERROR_NONE);
  ASSERT_EQ(job.execute(), UMB_ERROR_NONE);
  ASSERT_EQ(umbGetJobOutput(job.get(), "color", &made), UMB_ERROR_NONE);
  ASSERT_EQ(made.type, UMB_TYPE_FLOAT32);
  const std::size_t count = std::size_t(made.width) * std::size_t(made.height) * 4;
  const std::vector<float> values(static_cast<const float*>(made.data), static_cast<const float*>(made.data) + count);
  ASSERT_EQ(umbSetJobOutput(job.get(), "color", &bytes), UMB_ERROR_NONE);
  ASSERT_EQ(job.execute(), UMB_ERROR_NONE);
  ASSERT_EQ(umbGetJobOutput(job.get(), "color", &made), UMB_ERROR_NONE);
  ASSERT_EQ(made.type, UMB_TYPE_UINT8);
  for (std::size_t k = 0; k < count; ++k)
    ASSERT_EQ(int(static_cast<const std::uint8_t*>(made.data)[k]), int(values[k] * 255.0f + 0.5f)) << k;
  bytes.type = UMB_TYPE_UINT32;
  EXPECT_EQ(umbSetJobOutput(job.get(), "color", &bytes), UMB_ERROR_USAGE);
  bytes.type = 77;
  EXPECT_EQ(umbSetJobOutput(job.get(), "color", &bytes), UMB_ERROR_USAGE);
}

TEST_F(ShadeFiles, RefuseFilesThatCannotBeUsed) {
  umb::ShadeRequest request;
  request.device = "cpu";
  umb::Picture picture;
  request.files.file = (folder_ / "none.exr").string();
  auto outcome = umb::shade(request, picture);
  EXPECT_EQ(outcome.code, 3);
  EXPECT_NE(outcome.message.find("none.exr"), std::string::npos) << outcome.message;
  std::ofstream(folder_ / "text.exr") << "text";
  request.files.file = (folder_ / "text.exr").string();
  EXPECT_EQ(umb::shade(request, picture).code, 3);
  request.files.file = rendered();
  const float values[] = {1.0f};
  request.width = request.height = 1;
  request.arrays = {{"depth", values}};
  outcome = umb::shade(request, picture);
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.message.find("images or of files"), std::string::npos) << outcome.message;
  EXPECT_TRUE(picture.rgba.empty());
}

}  // namespace
}  // namespace umbrage
